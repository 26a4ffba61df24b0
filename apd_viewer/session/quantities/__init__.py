"""Units, typed expressions and the mass of a wall."""
