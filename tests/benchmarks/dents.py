"""Roughness of every frame in which a large smooth surface is pulled, and the forecast of the time left.

    python tests/benchmarks/dents.py [SUBDIVISIONS ...]

A prolate ellipsoid from an icosphere (7 and 8 subdivisions: 163,842 and 655,362 vertices), the lowest and
the highest 8 % held, stiffness 0.001, the upper end pulled by 1 % of the height. The matrix is factored by
another process, as in the window. The roughness is the largest ratio, over the edges, of the angle between
the normals of the two triangles to that at rest. The last columns are the gap to convergence and the seconds
left that the status bar would say.
"""

import os
import sys
import time
from pathlib import Path

os.environ.setdefault("NUMBA_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from meshes import sphere

from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.multilevel import compute_decimations
from apd_viewer.geometry.warmup import warm_up
from apd_viewer.presentation.time_left import TimeLeftEstimate
from apd_viewer.session.processes.remote_factor import RemoteFactor

HELD, PULL, STIFFNESS = 0.08, 0.01, 0.001


class Roughness:
    """Angles between neighbouring normals, in multiples of those at rest."""

    def __init__(self, V: np.ndarray, F: np.ndarray) -> None:
        self._F = F
        edge = np.sort(F[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        order = np.argsort(edge[:, 0] * len(V) + edge[:, 1], kind="stable")
        self._pairs = order.reshape(-1, 2).T // 3
        self._rest = self._angles(V)

    def _angles(self, U: np.ndarray) -> np.ndarray:
        X = U[self._F]
        N = np.cross(X[:, 1] - X[:, 0], X[:, 2] - X[:, 0])
        N /= np.linalg.norm(N, axis=1, keepdims=True)
        a, b = self._pairs
        return 2.0 * np.arcsin(np.minimum(np.linalg.norm(N[a] - N[b], axis=1) / 2.0, 1.0))

    def of(self, U: np.ndarray) -> float:
        """The largest at ``U`` (n, 3)."""
        return float((self._angles(U) / self._rest).max())


def pull(subdivisions: int) -> None:
    """Print every frame of the pull, and the forecast."""
    ball, F = sphere(subdivisions)
    V = ball * [1.0, 1.0, 2.0]
    t = V[:, 2] / 4.0 + 0.5
    fixed = np.flatnonzero((t < HELD) | (t > 1.0 - HELD))
    targets, above = V[fixed].copy(), t[fixed] > 0.5
    targets[above, 2] += PULL * 4.0
    rest, roughness, factors = RestMesh(V, F), Roughness(V, F), []
    compute_decimations(rest)

    def factored(matrix):
        factors.append(RemoteFactor(matrix))
        return factors[-1]

    solver = Deformation(V, F, fixed, handle=fixed[above], stiffness=STIFFNESS, rest=rest, factored=factored)
    solver.aim(targets)
    measuring, begun = 0.0, time.monotonic()
    forecast = TimeLeftEstimate(0.0)
    while True:
        while not solver.ready:
            time.sleep(0.001)
        solver.iterate()
        now = time.monotonic() - begun - measuring
        frame, hides = solver.frame(), solver.solver.progress.is_iterate_hidden
        forecast.add_sample(now, frame.gap, frame.seconds_left)
        measured = time.monotonic()
        rough = roughness.of(frame.U)
        held = float(np.abs(frame.U[fixed] - targets).max())
        preview = "yes" if hides else ""
        said = f"{len(V):,} | {frame.iteration} | {now:.1f} | {preview} | {rough:.3f} | {held:.1g}"
        print(f"| {said} | {frame.area_error:.1g} | {frame.gap} | {forecast.seconds_left(now)} |", flush=True)
        for factor in factors:
            factor.begin()
        measuring += time.monotonic() - measured
        if solver.settled:
            break
    for factor in factors:
        factor.close()


if __name__ == "__main__":
    warm_up()
    print("| vertices | iteration | s | preview | roughness | held | area | gap | left |")
    print("|---|---|---|---|---|---|---|---|---|")
    for subdivisions in map(int, sys.argv[1:] or ["7"]):
        pull(subdivisions)
