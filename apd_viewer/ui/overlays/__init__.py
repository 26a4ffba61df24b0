"""Overlays on the view: legend, cards, notices."""
