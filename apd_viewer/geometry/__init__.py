"""Room 1: what is true of meshes. Depends on nothing else in the package."""

import os

# GNU's OpenMP, which runs the parallel kernels on Linux, would otherwise let idle threads spin: where
# another program, or the drawing of the view, wants a core too, a kernel of 50 us then takes 8 ms.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")
