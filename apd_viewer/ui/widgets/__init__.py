"""General-purpose widgets and the colour theme."""
