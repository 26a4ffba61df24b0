"""Figures for print: curves and pictures of shapes, rendered without a display."""
