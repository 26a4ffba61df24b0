"""Appearance of drawn surfaces: shading, arrays, antialiasing."""
