"""Mesh formats, a module each, and their shared parts."""
