"""Preferences, shortcuts, units and up axes."""
