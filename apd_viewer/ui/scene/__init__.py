"""Scene: surface, camera, shading and actors."""
