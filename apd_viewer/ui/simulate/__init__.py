"""Simulations in the view: presses, and the timeline of their steps."""
