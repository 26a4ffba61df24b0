"""glTF: scenes read as one surface, and the same file with new coordinates."""
