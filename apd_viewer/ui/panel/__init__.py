"""Side panel with its sections, and the status bar."""
