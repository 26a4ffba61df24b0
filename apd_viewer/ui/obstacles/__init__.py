"""Obstacles in the window: drawn, placed, pressed, moved and listed."""
