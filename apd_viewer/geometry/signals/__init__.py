"""Handling of operating-system signals during kernels."""
