"""Texts, number formats, colour scales and reports of results; no Qt."""
