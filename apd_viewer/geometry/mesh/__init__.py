"""The triangle mesh: its operators, its topology and its measures."""
