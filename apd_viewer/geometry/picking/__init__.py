"""Ray casts, visibility and sets of vertices."""
