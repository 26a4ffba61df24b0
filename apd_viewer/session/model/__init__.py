"""The document, its history and derived values."""
