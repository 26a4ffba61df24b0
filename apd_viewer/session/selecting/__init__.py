"""Selections computed from a part or from typed text."""
