"""What keeping the area of calm parts costs, and what it keeps.

    python tests/benchmarks/calm_parts.py [STEP ...]

The character made by ``meshes.character`` with grids of these steps (0.06 and 0.03: 10,500 and 42,200
vertices), its lower body held, its head moved, with and without calm parts in turns on one core. Times are
those of the processor, the least of some runs: of an iteration, the work of the coarse levels included, and
from rest to the end.
"""

import os
import sys
import time
from pathlib import Path

os.environ.setdefault("NUMBA_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from meshes import character, rotation

from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.solver.deformation import Deformation

RUNS = 5
# Axis, degrees, pivot and shift of the head.
GESTURES = {
    "turned by 43°": ([0, 1, 0], 43, [0, 2.6, 0], [0, 0, 0]),
    "nodding by 40°": ([1, 0, 0], 40, [0, 2.6, 0], [0, 0, 0]),
    "bent by 43° about the waist": ([0, 0, 1], 43, [0, 0, 0], [0, 0, 0]),
    "pulled by 1.0": ([0, 1, 0], 0, [0, 0, 0], [0, 1.0, 0]),
}


def settle(solver: Deformation, targets: np.ndarray) -> tuple[int, float]:
    """Iterations and seconds from rest to the end."""
    solver.aim(targets, solver.rest.V)
    begun, iterations = time.process_time(), 0
    while not solver.settled:
        solver.iterate()
        iterations += 1
    return iterations, time.process_time() - begun


def main() -> None:
    """Print the table."""
    print("| vertices | head | calm parts | iterations | ms | s | ARAP energy | arms | legs |")
    print("|---|---|---|---|---|---|---|---|---|")
    for step in map(float, sys.argv[1:] or ["0.06", "0.03"]):
        V, F = character(step)
        base = np.flatnonzero((V[:, 1] > -0.3) & (V[:, 1] < 1.0) & (np.abs(V[:, 0]) < 0.62))
        head = np.flatnonzero(V[:, 1] > 2.75)
        fixed, rest = np.concatenate([base, head]), RestMesh(V, F)
        solvers = {
            calm: Deformation(V, F, fixed, handle=head, rest=rest, calm=calm) for calm in (False, True)
        }
        at_rest, middle = face_areas(V, F), V[F].mean(axis=1)
        limbs = (np.abs(middle[:, 0]) > 1.0) & (middle[:, 1] > 1.3), middle[:, 1] < -0.8
        for name, (axis, degrees, pivot, shift) in GESTURES.items():
            R = rotation(axis, np.radians(degrees))
            targets = np.vstack([V[base], (V[head] - pivot) @ R.T + pivot + np.array(shift)])
            runs = [{calm: settle(solver, targets) for calm, solver in solvers.items()} for _ in range(RUNS)]
            for calm, solver in solvers.items():
                U = solver.frame().U
                areas = face_areas(U, F)
                changes = [100 * (areas[part].sum() / at_rest[part].sum() - 1) for part in limbs]
                iterations, least = min((run[calm] for run in runs), key=lambda run: run[1])
                kept = " | ".join(f"{change:+.2f} %" for change in changes)
                said = f"{len(V):,} | {name} | {'kept' if calm else 'not kept'} | {iterations}"
                times = f"{1000 * least / iterations:.2f} | {least:.2f}"
                print(f"| {said} | {times} | {rest.energy(U):.4f} | {kept} |", flush=True)


if __name__ == "__main__":
    main()
