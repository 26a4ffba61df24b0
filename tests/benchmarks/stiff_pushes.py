"""Triangles that collapse where a stiff wall is pushed together.

    python tests/benchmarks/stiff_pushes.py [--stiffness 0.0001 0.001 0.01] [MESH ...]

Of meshes from files, or of the sample bottle with edges of a length, the lowest and the highest 8 % along
the longest axis are held, and the upper end is pushed by 30 % of the length. A triangle is flipped where its
normal opposes that at rest, turned by the rigid motion nearest to that of the two rings around; it has
collapsed below a fifth of its area. Those that are already so without stiffness are not counted again. One
core; seconds of the processor.
"""

import argparse
import os
import sys
import time
from pathlib import Path

os.environ.setdefault("NUMBA_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import scipy.sparse as sp

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from meshes import sample_bottle

from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.warmup import warm_up

HELD, PUSH, COLLAPSED = 0.08, 0.3, 0.2


def load(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of a bottle with edges of a length, or of a file."""
    try:
        return sample_bottle(float(name))[:2]
    except ValueError:
        mesh = open_mesh(name)
        return mesh.V, mesh.F


def pushed(V: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Held vertices, their targets, and the handle."""
    extent = np.ptp(V, axis=0)
    axis = int(np.argmax(extent))
    t = (V[:, axis] - V[:, axis].min()) / extent[axis]
    fixed = np.flatnonzero((t < HELD) | (t > 1.0 - HELD))
    targets, handle = V[fixed].copy(), t[fixed] > 0.5
    targets[handle, axis] -= PUSH * extent[axis]
    return fixed, targets, fixed[handle]


def flipped(V: np.ndarray, F: np.ndarray, U: np.ndarray) -> np.ndarray:
    """Triangles that have turned over among their neighbours, (m,) bool."""
    n, m = len(V), len(F)
    corners = sp.coo_array((np.ones(3 * m), (np.repeat(np.arange(m), 3), F.ravel())), shape=(m, n)).tocsr()
    rings = ((corners @ (corners.T @ corners)) > 0).astype(float)
    count = rings.sum(axis=1)
    products = (U[:, :, None] * V[:, None, :]).reshape(n, 9)
    means = (rings @ U) / count[:, None], (rings @ V) / count[:, None]
    outer = means[0][:, :, None] * means[1][:, None, :]
    S = (rings @ products).reshape(m, 3, 3) - count[:, None, None] * outer
    A, _, B = np.linalg.svd(S)
    A[:, :, 2] *= np.sign(np.linalg.det(A @ B))[:, None]
    before, after = (np.cross(X[F[:, 1]] - X[F[:, 0]], X[F[:, 2]] - X[F[:, 0]]) for X in (V, U))
    return ((A @ B @ before[:, :, None])[:, :, 0] * after).sum(axis=1) < 0.0


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("meshes", nargs="*", default=["1.0"])
    parser.add_argument("--stiffness", type=float, nargs="*", default=[1e-4, 1e-3, 1e-2])
    asked = parser.parse_args()
    warm_up()
    columns = "mesh, vertices", "stiffness", "flipped, collapsed", "not without", "iterations", "s", "energy"
    print("| " + " | ".join(columns) + " |")
    print("|---|---|---|---|---|---|---|")
    for name in asked.meshes:
        V, F = load(name)
        fixed, targets, handle = pushed(V)
        without = None
        for stiffness in [0.0, *asked.stiffness]:
            solver = Deformation(V, F, fixed, handle=handle, stiffness=stiffness)
            solver.aim(targets)
            begun, iterations = time.process_time(), 0
            while not solver.settled:
                solver.iterate()
                iterations += 1
            seconds, frame = time.process_time() - begun, solver.frame()
            U = frame.U
            bad = np.array([flipped(V, F, U), face_areas(U, F) < COLLAPSED * face_areas(V, F)])
            without = bad if without is None else without
            counts = " | ".join(f"{a}, {b}" for a, b in (bad.sum(axis=1), (bad & ~without).sum(axis=1)))
            said = f"{Path(name).name}, {len(V):,} | {stiffness:g} | {counts} | {iterations} | {seconds:.1f}"
            print(f"| {said} | {frame.energy:.6g} |", flush=True)


if __name__ == "__main__":
    main()
