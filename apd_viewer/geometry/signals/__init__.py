"""Signals during kernels."""
