"""Turns that a surface holds between its base and its handles."""
