"""Defects, self-intersections and deviation from the rest shape."""
