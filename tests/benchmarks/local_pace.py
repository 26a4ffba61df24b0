"""How soon "local" settles, against "exact" and against another checkout of this project.

    python tests/benchmarks/local_pace.py [--before CHECKOUT] [--edges 1.0 0.565] [--starts 1] [MESH ...]

The sample bottle with edges of these lengths (13,000 and 41,000 vertices), and meshes from files, of which
the lowest and the highest 8 % along the longest axis are held. Every run is a process of its own on one core,
and the checkouts take turns. Times are those of the processor; an iteration that took longest is what a user
would wait for a frame. With more than one start each is repeated with vertices moved by 1e-10 of the
diagonal: where a wall buckles, rounding chooses the fold, and only the spread of the energies says what a
difference is worth.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from meshes import rotation, sample_bottle

from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.warmup import warm_up

MOTIONS = {"twist": 120.0, "push": 30.0}
HERE = Path(__file__).parents[2]


def load(name: str):
    """Vertices and triangles of a bottle with edges of a length, or of a file."""
    try:
        return sample_bottle(float(name))[:2]
    except ValueError:
        mesh = open_mesh(name)
        return mesh.V, mesh.F


def run(name: str, motion: str, method: str, options: dict, start: int) -> dict:
    """Time, iterations and energy to the end, and what was kept on the way."""
    warm_up()
    V, F = load(name)
    if start:
        moved = np.random.default_rng(start).normal(size=V.shape)
        V = V + 1e-10 * np.linalg.norm(np.ptp(V, axis=0)) * moved
    extent = np.ptp(V, axis=0)
    axis = int(np.argmax(extent))
    t = (V[:, axis] - V[:, axis].min()) / extent[axis]
    fixed, up = np.flatnonzero((t < 0.08) | (t > 0.92)), np.eye(3)[axis]
    handle = t[fixed] > 0.5
    targets, centre = V[fixed].copy(), V[fixed[handle]].mean(axis=0)
    if motion == "twist":
        targets[handle] = (targets[handle] - centre) @ rotation(up, np.radians(MOTIONS[motion])).T + centre
    else:
        targets[handle] -= MOTIONS[motion] / 100 * extent[axis] * up
    solver = Deformation(V, F, fixed, method=method, handle=fixed[handle], **options)
    solver.aim(targets)
    begun, longest, worst, iterations = time.process_time(), 0.0, 0.0, 0
    while not solver.settled:
        before = time.process_time()
        solver.iterate()
        longest, iterations = max(longest, time.process_time() - before), iterations + 1
    seconds = time.process_time() - begun
    frame = solver.frame()
    if solver.target("the area"):
        worst = abs(frame.area_error)
    held = bool(np.array_equal(frame.U[fixed], targets))
    found = {"n": len(V), "seconds": seconds, "iterations": iterations, "energy": frame.energy}
    return {**found, "longest": longest, "area": worst, "held": held}


def in_process(checkout: Path, *task: str) -> dict:
    """The same with the package of a checkout, in a process of its own."""
    threads = {"NUMBA_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    environment = {**os.environ, **threads, "PYTHONPATH": str(checkout)}
    command = [sys.executable, str(Path(__file__).resolve()), "--one", *task]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True, cwd=checkout)
    return json.loads(done.stdout)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("meshes", nargs="*")
    parser.add_argument("--edges", nargs="*", default=["1.0", "0.565"])
    parser.add_argument("--motions", nargs="*", default=list(MOTIONS))
    parser.add_argument("--before", type=Path)
    parser.add_argument("--options", default="{}", help="more arguments of Deformation for local, as JSON")
    parser.add_argument("--starts", type=int, default=1)
    parser.add_argument("--one", nargs=5)
    asked = parser.parse_args()
    if asked.one:
        name, motion, method, options, start = asked.one
        print(json.dumps(run(name, motion, method, json.loads(options), int(start))))
        return
    print("| vertices | motion | | iterations | s | of exact | of before | energy | longest s | held |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for name in [*asked.edges, *(str(Path(mesh).resolve()) for mesh in asked.meshes)]:
        for motion in asked.motions:
            compare(name, motion, asked)


def compare(name: str, motion: str, asked: argparse.Namespace) -> None:
    """Rows of every start of a motion, in turns, and the spread of the energies where there are several."""
    tasks = {"exact": (HERE, name, motion, "exact", "{}")}
    if asked.before:
        before = asked.before.resolve()
        tasks["exact before"] = (before, name, motion, "exact", "{}")
        tasks["before"] = (before, name, motion, "local", asked.options)
    tasks["local"] = (HERE, name, motion, "local", asked.options)
    found: dict[str, list[dict]] = {what: [] for what in tasks}
    for start in range(asked.starts):
        for what, task in tasks.items():
            r = in_process(*task, str(start))
            found[what].append(r)
            others = [
                r["seconds"] / found[w][-1]["seconds"] if found.get(w) else np.nan
                for w in ("exact", "before")
            ]
            ratios = " | ".join(f"{ratio:.2f}" for ratio in others)
            steps = f"{r['n']:,} | {motion} | {what} | {r['iterations']:,} | {r['seconds']:.1f}"
            print(
                f"| {steps} | {ratios} | {r['energy']:.6g} | {r['longest']:.2f} | {r['held']} |", flush=True
            )
    if asked.starts > 1:
        for what, runs in found.items():
            energies, seconds = ([r[key] for r in runs] for key in ("energy", "seconds"))
            mean, deviation = np.mean(energies), np.std(energies, ddof=1)
            spread = f"{mean:.6g} ± {deviation:.2g}, {min(energies):.6g} to {max(energies):.6g}"
            print(f"{what}: energy {spread}; median {np.median(seconds):.1f} s", flush=True)


if __name__ == "__main__":
    main()
