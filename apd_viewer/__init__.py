"""Area-preserving deformation of 3D objects."""
