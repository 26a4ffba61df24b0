"""An iteration of ARAP on one core and two, compiled for levels of processors, beside libigl.

    python tests/benchmarks/across_processors.py [turns]

Each row is a process of its own, and the rows take turns. What an iteration moves is counted from its arrays,
each as often as it is passed: the graph in the local step and on the right-hand side, positions, rotations,
and the factor forwards and backwards. The copy rate is that of an array of 256 MiB in the same process, read
and written; a share above one means that the caches of the processor hold what is moved.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

# Those that the processor has; "native" has its name and features.
NEEDED = {"x86-64-v3": "avx2", "x86-64-v4": "avx512f", "native": "avx2"}
EDGES = (1.0, 0.282)  # of the sample bottle: 13,010 and 164,036 vertices
IN_A_ROW, SECONDS = 10, 4.0


def copy_rate() -> float:
    """Bytes a second that a parallel copy reads and writes."""
    from numba import njit, prange

    @njit(parallel=True)
    def copy(a, b):
        for i in prange(len(a)):
            b[i] = a[i]

    a, b = np.zeros(1 << 25), np.zeros(1 << 25)
    copy(a, b)
    best = np.inf
    for _ in range(5):
        began = time.perf_counter()
        copy(a, b)
        best = min(best, time.perf_counter() - began)
    return 2.0 * a.nbytes / best


def moved_bytes(surface) -> int:
    """Bytes that an iteration passes, from the sizes of its arrays."""
    n = len(surface.U)
    graph = sum(array.nbytes for array in surface.rest.graph)
    rotations, positions = 32 * n, 24 * n
    local_step = graph + 2 * positions + rotations
    right_hand_side = graph + positions + rotations + positions
    factor = surface.factor.factor
    solve = 2 * (factor._panels.nbytes + factor._order.nbytes + 12 * n) + 2 * positions
    return local_step + right_hand_side + solve


def rows() -> None:
    """Print what this process measures as JSON."""
    sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
    from meshes import rotation, sample_bottle

    from apd_viewer.geometry.energy.rest_mesh import RestMesh
    from apd_viewer.geometry.pose.constraints import constraints
    from apd_viewer.geometry.solver.deformation import Deformation

    twist = np.eye(4)
    twist[:3, :3] = rotation([0, 1, 0], np.pi / 3)
    found = []
    for edge in EDGES:
        V, F, labels = sample_bottle(edge)
        held = constraints(labels, V, [twist])
        solver = Deformation(
            V, F, held.fixed, method="arap", handle=held.handles, rest=RestMesh(V, F), plain=True
        )
        solver.aim(held.targets)
        taken, end = [], time.perf_counter() + SECONDS
        while time.perf_counter() < end or len(taken) < 3:
            began = time.perf_counter()
            for _ in range(IN_A_ROW):
                solver.step()
            taken.append((time.perf_counter() - began) / IN_A_ROW)
        surface = solver.solver.surface
        found.append((len(V), float(np.median(taken[1:])), moved_bytes(surface), libigl(V, F, held)))
    print(json.dumps({"rows": found, "copy": copy_rate()}))


def libigl(V: np.ndarray, F: np.ndarray, held) -> float:
    """Seconds of an iteration of libigl, which uses one core."""
    import igl

    data = igl.ARAPData()
    data.max_iter = 1
    data.energy = igl.ARAPEnergyType.ARAP_ENERGY_TYPE_SPOKES
    igl.arap_precomputation(V, F.astype(np.int64), 3, held.fixed.astype(np.int64), data)
    U, taken = V.copy(), []
    for _ in range(6):
        began = time.perf_counter()
        U = igl.arap_solve(held.targets, data, U)
        taken.append(time.perf_counter() - began)
    return float(np.median(taken[1:]))


def main(turns: int = 3) -> None:
    """Print the medians of the turns."""
    from llvmlite import binding

    there = binding.get_host_cpu_features()
    kinds = [(level, cores) for level, needed in NEEDED.items() if there[needed] for cores in (1, 2)]
    results = {kind: [] for kind in kinds}
    with tempfile.TemporaryDirectory() as kernels:
        for turn in range(1 + turns):  # the first one compiles
            for level, cores in kinds:
                own = {"NUMBA_CPU_NAME": level, "NUMBA_CPU_FEATURES": "", "NUMBA_NUM_THREADS": str(cores)}
                if level == "native":
                    own |= {
                        "NUMBA_CPU_NAME": binding.get_host_cpu_name(),
                        "NUMBA_CPU_FEATURES": there.flatten(),
                    }
                own["NUMBA_CACHE_DIR"] = str(Path(kernels, level))
                done = subprocess.run(
                    [sys.executable, __file__, "rows"],
                    env=os.environ | own,
                    stdout=subprocess.PIPE,
                    text=True,
                    check=True,
                )
                if turn:
                    results[level, cores].append(json.loads(done.stdout.splitlines()[-1]))
    print("level      cores  vertices       ms  MB moved   GB/s  copy GB/s  share  libigl ms  libigl / here")
    for (level, cores), runs in results.items():
        copy = np.median([run["copy"] for run in runs])
        for k in range(len(EDGES)):
            n, _, moved, _ = runs[0]["rows"][k]
            took, other = np.median([run["rows"][k][1::2] for run in runs], axis=0)
            cells = f"{1e3 * took:8.2f} {moved / 1e6:9.1f} {moved / took / 1e9:6.1f} {copy / 1e9:10.1f}"
            beside = f"{moved / took / copy:6.2f} {1e3 * other:10.2f} {other / took:14.1f}"
            print(f"{level:10} {cores:5} {n:9,} {cells} {beside}", flush=True)


if __name__ == "__main__":
    if sys.argv[1:] == ["rows"]:
        rows()
    else:
        main(*map(int, sys.argv[1:]))
