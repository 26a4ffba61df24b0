"""Animations of a mesh: point caches, morph targets, ParaView series."""
