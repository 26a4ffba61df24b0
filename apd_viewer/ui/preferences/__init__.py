"""Preferences, shortcuts and units."""
