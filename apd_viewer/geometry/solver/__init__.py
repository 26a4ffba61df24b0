"""The solvers: constrained descent, multilevel, restarts, Li & Hui."""
