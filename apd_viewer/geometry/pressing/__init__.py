"""Pressing: surfaces between moving obstacles, and what that takes."""
