"""Atomic file writes, file locks, archives and validated reads."""
