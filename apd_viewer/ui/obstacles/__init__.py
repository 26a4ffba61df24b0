"""Obstacles in the window: drawing, placing, picking, moving and listing."""
