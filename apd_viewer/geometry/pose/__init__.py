"""Constraints, handle motions and their falloff."""
