"""Live charts of the gesture and the deformed shape."""
