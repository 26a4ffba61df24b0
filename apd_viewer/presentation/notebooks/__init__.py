"""Deformations in scripts and notebooks: progress, pictures and readings."""
