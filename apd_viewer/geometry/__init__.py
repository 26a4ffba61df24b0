"""Room 1: what is true of meshes. numpy, scipy, numba and cholespy; no files, no threads, no window."""
