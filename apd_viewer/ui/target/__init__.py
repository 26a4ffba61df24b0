"""Target shape: its section, and the comparison with it."""
