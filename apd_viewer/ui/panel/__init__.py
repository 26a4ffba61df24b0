"""The side panel, its sections and the status bar."""
