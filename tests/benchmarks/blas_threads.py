"""A factor of 3 x 3 blocks by one thread of BLAS and by two, in turns.

    python tests/benchmarks/blas_threads.py [PROCESSES]

The Hessian of the sample bottle by ``local``. So many PROCESSES keep the machine busy meanwhile.
"""

import subprocess
import sys
import time
from contextlib import nullcontext
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from meshes import sample_bottle

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.linalg import block_cholesky
from apd_viewer.geometry.solver.methods import METHODS, method_material

EDGE, TURNS = 1.13, 3
BUSY = "while True: pass"


def main() -> None:
    """Print seconds of the processor and of the clock, and their ratio."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 0
    V, F, _ = sample_bottle(EDGE)
    surface = ElasticSurface(SolveMesh(V, F), np.arange(0), method_material(METHODS["local"], 0.0, 20.0, 0.1))
    limits = {"one": block_cholesky.one_blas_thread, "two": nullcontext}
    surface.hessian.factor_at(V)
    others = [subprocess.Popen([sys.executable, "-c", BUSY]) for _ in range(count)]
    times = {name: [] for name in limits}
    try:
        for _ in range(TURNS):
            for name, limit in limits.items():
                block_cholesky.one_blas_thread = limit
                with threadpool_limits(2, user_api="blas"):
                    begun = time.process_time(), time.perf_counter()
                    surface.hessian.factor_at(V)
                times[name].append((time.process_time() - begun[0], time.perf_counter() - begun[1]))
    finally:
        for other in others:
            other.kill()
    one, two = (np.median(taken, axis=0) for taken in times.values())
    print(f"{len(V):,} vertices, {count} other processes")
    for k, clock in enumerate(("processor", "clock")):
        print(f"{clock:>9}: one {one[k]:6.2f} s, two {two[k]:6.2f} s, ratio {two[k] / one[k]:5.1f}")


if __name__ == "__main__":
    main()
