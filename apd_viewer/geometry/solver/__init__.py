"""The solvers: descent under goals, multilevel, restarts, Li & Hui."""
