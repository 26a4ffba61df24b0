"""Studies: plans of many deformations, run by many processes into one folder."""
