"""How soon "local" settles, against "exact" and against another checkout of this project.

    python tests/benchmarks/local_pace.py [--before CHECKOUT] [--edges 1.0 0.565] [MESH ...]

The sample bottle with edges of these lengths (13,000 and 41,000 vertices), and meshes from files, of which
the lowest and the highest 8 % along the longest axis are held. Every run is a process of its own on one core,
and the checkouts take turns. Times are those of the processor; an iteration that took longest is what a user
would wait for a frame.
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


def run(name: str, motion: str, method: str, options: dict) -> dict:
    """Time, iterations and energy to the end, and what was kept on the way."""
    warm_up()
    V, F = load(name)
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
    parser.add_argument("--one", nargs=4)
    asked = parser.parse_args()
    if asked.one:
        name, motion, method, options = asked.one
        print(json.dumps(run(name, motion, method, json.loads(options))))
        return
    print("| vertices | motion | | iterations | s | of exact | of before | energy | longest s | held |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for name in [*asked.edges, *(str(Path(mesh).resolve()) for mesh in asked.meshes)]:
        for motion in asked.motions:
            tasks = {"exact": (HERE, name, motion, "exact", "{}")}
            if asked.before:
                tasks["before"] = (asked.before.resolve(), name, motion, "local", asked.options)
            tasks["local"] = (HERE, name, motion, "local", asked.options)
            found = {}
            for what, task in tasks.items():
                found[what] = r = in_process(*task)
                of_exact = r["seconds"] / found["exact"]["seconds"]
                of_before = r["seconds"] / found["before"]["seconds"] if "before" in found else np.nan
                ratios = (
                    f"{of_exact:.2f} | {of_before:.2f} | {r['energy']:.6g} | {r['longest']:.2f} | {r['held']}"
                )
                steps = f"{r['n']:,} | {motion} | {what} | {r['iterations']:,} | {r['seconds']:.1f}"
                print(f"| {steps} | {ratios} |", flush=True)


if __name__ == "__main__":
    main()
