"""Session with document, history, files and solver; no Qt."""
