"""Signals, and the kernels that they meet."""
