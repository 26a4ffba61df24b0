"""Readers and writers of mesh formats, one module each, and shared helpers."""
