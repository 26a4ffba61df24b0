"""Goals for areas and the volume, and the projection onto them."""
