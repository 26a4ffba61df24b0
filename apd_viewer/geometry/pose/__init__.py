"""Constraints, handle transforms and their falloff."""
