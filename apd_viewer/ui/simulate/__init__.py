"""Motions in steps in the view: presses, and the timeline of all steps."""
