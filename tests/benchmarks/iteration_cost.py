"""What an iteration of each method costs, against one of ARAP on the same mesh in the same run.

    python tests/benchmarks/iteration_cost.py

The methods take turns, so that whatever else the machine does falls on all of them; each with ten iterations
in a row, as in use, so that it finds in the caches what it left there. Readings of the shape are included, as
of every frame that is shown. The figures are medians of the turns, which are timed as a whole.
"""

import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from meshes import rotation, sample_bottle

from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.pose.constraints import constraints
from apd_viewer.geometry.solver.deformation import Deformation

EDGES = {1.13: 60, 0.565: 20, 0.282: 10}  # length of the edges: turns
METHODS = {
    "arap": {"method": "arap"},
    "exact": {"method": "exact"},
    "exact, stiff": {"method": "exact", "stiffness": 1e-3},
    "local": {"method": "local"},
    "paper": {"method": "paper"},
}
IN_A_ROW = 10


def main() -> None:
    """Print the medians and their ratios to ARAP's."""
    print(f"{'vertices':>9}  " + "  ".join(f"{name:>20}" for name in METHODS))
    twist = np.eye(4)
    twist[:3, :3] = rotation([0, 1, 0], np.pi / 3)
    for edge, turns in EDGES.items():
        V, F, labels = sample_bottle(edge)
        held, rest = constraints(labels, V, [twist]), RestMesh(V, F)
        solvers = {}
        for name, options in METHODS.items():
            given = {"handle": held.handles, "rest": rest, "plain": True, **options}
            solvers[name] = Deformation(V, F, held.fixed, **given)
            solvers[name].aim(held.targets)
        times = {name: [] for name in METHODS}
        for _ in range(1 + turns):
            for name, solver in solvers.items():
                started = time.perf_counter()
                for _ in range(IN_A_ROW):
                    solver.step()
                times[name].append((time.perf_counter() - started) / IN_A_ROW)
        median = {name: np.median(taken[1:]) for name, taken in times.items()}
        cells = [f"{1e3 * t:8.2f} ms x {t / median['arap']:6.3f}" for t in median.values()]
        print(f"{len(V):9,}  " + "  ".join(f"{cell:>20}" for cell in cells), flush=True)


if __name__ == "__main__":
    main()
