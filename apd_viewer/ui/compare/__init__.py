"""Side-by-side comparison of the methods."""
