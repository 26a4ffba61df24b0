"""The view: surface, camera, shading and what stands in the scene."""
