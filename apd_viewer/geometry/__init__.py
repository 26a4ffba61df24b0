"""Meshes: operators, energies, solvers and analysis."""

import os

from apd_viewer.geometry.processor import compile_for_level

# GNU's OpenMP, which runs the parallel kernels on Linux, would otherwise let idle threads spin for as long as
# they like: where another program, or the drawing of the view, wants a core too, a kernel of 50 us then takes
# 8 ms. Not to spin at all costs speed where nobody else does.
os.environ.setdefault("GOMP_SPINCOUNT", "1000")

# Before the first module with a kernel imports numba, which then asks the environment.
compile_for_level()
