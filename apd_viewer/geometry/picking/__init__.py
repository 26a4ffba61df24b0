"""Ray casting, visibility, and sets of vertices."""
