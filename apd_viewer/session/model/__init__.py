"""The document, its history and what is derived from it."""
