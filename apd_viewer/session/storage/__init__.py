"""Session files, recovery and autosave."""
