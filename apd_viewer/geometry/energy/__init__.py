"""Elastic energies and the mesh that the solver works on."""
