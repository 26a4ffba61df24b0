"""Menu actions and their shortcuts."""
