"""Linear algebra: factorizations, parallel kernels and their threads."""
