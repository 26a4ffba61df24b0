"""Settings page: the table of preferences, its dialog and its effects."""
