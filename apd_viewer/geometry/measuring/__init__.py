"""Distances, angles, geodesics and sections of a surface."""
