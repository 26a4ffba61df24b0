"""Selections and transforms on disk, a module a format."""
