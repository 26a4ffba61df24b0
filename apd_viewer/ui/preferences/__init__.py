"""Preferences, shortcuts and units that the user chose."""
