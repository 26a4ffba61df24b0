"""Elastic energies and the mesh of the solve."""
