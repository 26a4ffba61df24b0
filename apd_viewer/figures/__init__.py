"""Figures on paper: curves and pictures of shapes, drawn without a display."""
