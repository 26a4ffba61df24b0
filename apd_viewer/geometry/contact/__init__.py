"""Contact: near pairs of a surface, their gap energy, and collision-free steps."""
