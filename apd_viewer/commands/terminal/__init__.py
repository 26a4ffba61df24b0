"""Parser, progress and plain numbers of all commands."""
