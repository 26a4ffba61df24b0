"""Measure tool: picking, drawing and list of measurements."""
