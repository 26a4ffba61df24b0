"""Sizes of the units of length, by their symbols."""

# Whole numbers: each ratio of two is rounded once, so that 25mm are exactly 2.5cm.
MICROMETRES = {"mm": 1e3, "cm": 1e4, "m": 1e6, "in": 25_400.0, "ft": 304_800.0}
METRES = {symbol: size / 1e6 for symbol, size in MICROMETRES.items()}
