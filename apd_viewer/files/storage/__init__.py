"""Whole, atomic and locked access to files."""
