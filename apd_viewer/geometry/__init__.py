"""Geometry of meshes: operators, energies, solvers and analysis."""

import os

from apd_viewer.geometry.processor import compile_for_level

# GNU OpenMP, which runs the parallel kernels on Linux, lets idle threads spin without limit by default: if
# another program or the renderer also needs a core, a kernel of 50 us then takes 8 ms. No spinning at all
# would slow the kernels down on an otherwise idle machine.
os.environ.setdefault("GOMP_SPINCOUNT", "1000")

# Set before the first kernel module imports numba, which then reads the environment.
compile_for_level()
