"""glTF: scenes read as one surface, and rewritten with new coordinates."""
