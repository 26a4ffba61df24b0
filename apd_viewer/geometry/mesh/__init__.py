"""The triangle mesh: operators, topology and measures."""
