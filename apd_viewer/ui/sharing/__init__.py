"""Reports and pictures of the deformed shape."""
