"""Menu actions and their keys."""
