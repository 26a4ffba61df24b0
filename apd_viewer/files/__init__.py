"""Meshes, selections and transforms on disk."""
