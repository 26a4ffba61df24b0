"""The tool Measure: picking, drawing and the list of measurements."""
