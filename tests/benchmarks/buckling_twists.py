"""Energies at which twists that buckle come to rest, against another checkout of this project.

    python tests/benchmarks/buckling_twists.py [--before CHECKOUT] [--stiffness 0 0.001]

The sample bottle (13,000 vertices), its labelled handle twisted by 16 angles from 60 to 150 degrees by
`exact`. Every angle starts at rest, each checkout in a process of its own on one core. All shapes are
measured by the energy of this checkout. Where that of the other differs, what it found is no minimum here, so
it is also followed to a minimum, which shows whether a fold was missed.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

os.environ.setdefault("NUMBA_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from meshes import rotation, sample_bottle

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.warmup import warm_up

ANGLES = np.linspace(60.0, 150.0, 16)
HERE = Path(__file__).parents[2]


def twisted(angle: float) -> tuple[np.ndarray, np.ndarray]:
    """Held vertices of the bottle and where they are asked to be."""
    V, _, labels = sample_bottle()
    fixed = np.flatnonzero(labels != 1)
    targets, handle = V[fixed].copy(), labels[fixed] == 2
    centre = targets[handle].mean(axis=0)
    axis = np.eye(3)[int(np.argmax(np.ptp(V, axis=0)))]
    targets[handle] = (targets[handle] - centre) @ rotation(axis, np.radians(angle)).T + centre
    return fixed, targets


def settle(solver: Deformation) -> int:
    """Iterations to the end."""
    iterations = 0
    while not solver.settled:
        solver.iterate()
        iterations += 1
    return iterations


def run(stiffness: float, path: str) -> None:
    """Write shapes, iterations and seconds for all angles."""
    warm_up()
    V, F, labels = sample_bottle()
    rest, found = RestMesh(V, F), []
    fixed = np.flatnonzero(labels != 1)
    solver = Deformation(V, F, fixed, handle=np.flatnonzero(labels == 2), stiffness=stiffness, rest=rest)
    for angle in ANGLES:
        solver.aim(twisted(angle)[1], V)
        begun = time.process_time()
        iterations = settle(solver)
        found.append((solver.frame().U, iterations, time.process_time() - begun))
    U, iterations, seconds = zip(*found, strict=True)
    np.savez(path, U=U, iterations=iterations, seconds=seconds)


def in_process(checkout: Path, stiffness: float) -> dict[str, np.ndarray]:
    """The same by the package of a checkout, in a process of its own."""
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder) / "found.npz")
        task = [sys.executable, str(Path(__file__).resolve()), "--one", str(stiffness), path]
        environment = {**os.environ, "PYTHONPATH": str(checkout)}
        subprocess.run(task, env=environment, check=True, cwd=checkout)
        with np.load(path) as found:
            return dict(found)


def print_table(stiffness: float, before: Path | None) -> None:
    """Print one row for each angle, and the means."""
    V, F, labels = sample_bottle()
    rest, fixed = RestMesh(V, F), np.flatnonzero(labels != 1)
    surface = ElasticSurface(rest.solve_mesh, fixed, Material(bending=stiffness))

    def energy(U: np.ndarray) -> float:
        surface.restart(rest.solve_mesh.V)
        surface.restart(U)
        return surface.energy

    solver = Deformation(V, F, fixed, handle=np.flatnonzero(labels == 2), stiffness=stiffness, rest=rest)
    runs = [in_process(checkout, stiffness) for checkout in (before, HERE) if checkout]
    rows = []
    for k, angle in enumerate(ANGLES):
        row = [value for r in runs for value in (energy(r["U"][k]), r["iterations"][k], r["seconds"][k])]
        if before and stiffness:
            solver.aim(twisted(angle)[1], runs[0]["U"][k])
            settle(solver)
            row.append(energy(solver.frame().U))
        rows.append(row)
        print(f"| {stiffness:g} | {angle:.0f}° | " + " | ".join(f"{x:.5g}" for x in row) + " |", flush=True)
    means = np.mean(rows, axis=0)
    print(f"| {stiffness:g} | mean | " + " | ".join(f"{x:.5g}" for x in means) + " |", flush=True)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--before", type=Path)
    parser.add_argument("--stiffness", type=float, nargs="*", default=[0.0, 0.001])
    parser.add_argument("--one", nargs=2)
    asked = parser.parse_args()
    if asked.one:
        run(float(asked.one[0]), asked.one[1])
        return
    sides = ["before: energy", "iterations", "s"] if asked.before else []
    sides += ["energy", "iterations", "s"]
    for stiffness in asked.stiffness:
        followed = ["before, followed to a minimum"] if asked.before and stiffness else []
        columns = ["stiffness", "twist", *sides, *followed]
        print("\n| " + " | ".join(columns) + " |\n" + "|---" * len(columns) + "|")
        print_table(stiffness, asked.before and asked.before.resolve())


if __name__ == "__main__":
    main()
