"""Elastic energies, and the mesh they are solved on."""
