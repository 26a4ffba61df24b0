"""Settings page: the preferences, their dialog and their effects."""
