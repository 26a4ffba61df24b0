"""What contact costs on the way of a drag at several sizes, where nothing touches and in touch.

    python tests/benchmarks/contact_at_size.py record SIZE FILE
    python tests/benchmarks/contact_at_size.py replay [--before CHECKOUT] FILE ...
    python tests/benchmarks/contact_at_size.py solve SIZE ...
    python tests/benchmarks/contact_at_size.py twist EDGE ...

``record`` twists the sample bottle (13k), the same with every triangle cut in four (52k), or an ellipsoid
(164k, 655k) in steps of 2°, without contact, and keeps every shape. ``replay`` moves contact alone
through them, with the package of this checkout and of another in turns, and prints the milliseconds of the
processor a shape: what a solver adds is left out, so that noise of the machine shows less. ``solve`` has two
solvers do the drag, with contact and without, iterations in turns, and prints the ratio of their times.
``twist`` turns one end of the sample bottle, with edges so many times as long, by 240° in one motion, and
prints when it is there and how long it takes to come within 2 % of the energy that it ends with.
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
from meshes import rotation, sample_bottle, sphere

from apd_viewer.files.samples import open_sample
from apd_viewer.geometry.contact.contact import Contact
from apd_viewer.geometry.contact.near_pairs import NearPairs
from apd_viewer.geometry.contact.neighbour_bounds import NeighbourBounds
from apd_viewer.geometry.contact.pair_search import PairSearch
from apd_viewer.geometry.contact.patches import Patches
from apd_viewer.geometry.pose.constraints import FREE, HANDLE
from apd_viewer.geometry.solver.deformation import Deformation

STEP, EACH, LAST = 2.0, 4, 20.0  # degrees of a step of the drag, iterations between, and degrees at the end
SETTLING, TURNS = 20, 3  # iterations after the drag; runs of each checkout
THICKNESS = 1e-3  # of the diagonal
END, TWIST = 0.15, 240.0  # held part of the height at each end; degrees that one is turned by
PARTS = [
    (NearPairs, "_find_near_patches"),
    (Patches, "approach_bounds"),
    (PairSearch, "near_pairs"),
    (NeighbourBounds, "excess"),
]


def cut_in_four(V, F, labels):
    """Every triangle cut in four at the middles of its edges; a middle has a label if both ends do."""
    sides = np.sort(F[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    E, which = np.unique(sides, axis=0, return_inverse=True)
    m, (a, b, c) = len(V) + which.reshape(-1, 3), F.T
    corners = [[a, m[:, 0], m[:, 2]], [m[:, 0], b, m[:, 1]], [m[:, 2], m[:, 1], c], m.T]
    same = np.where(labels[E[:, 0]] == labels[E[:, 1]], labels[E[:, 0]], FREE)
    V, F = np.vstack([V, V[E].mean(axis=1)]), np.vstack([np.column_stack(x) for x in corners])
    return V, F, np.concatenate([labels, same])


def load(size):
    """Vertices, triangles, held vertices, and which of these are the handle."""
    if size in ("13k", "52k"):
        mesh, labels = open_sample("bottle")
        V, F = mesh.V, mesh.F
        if size == "52k":
            V, F, labels = cut_in_four(V, F, labels)
        fixed = np.flatnonzero(labels != FREE)
        return V, F, fixed, labels[fixed] >= HANDLE
    V, F = sphere(7 if size == "164k" else 8)
    V = V * [1.0, 2.0, 1.0]
    fixed = np.flatnonzero(np.abs(V[:, 1]) > 1.6)
    return V, F, fixed, V[fixed, 1] > 0.0


def twisted(V, fixed, handle, degrees):
    """Targets of the held vertices, the handle turned about the second axis."""
    X = V[fixed].copy()
    centre = X[handle].mean(axis=0)
    X[handle] = (X[handle] - centre) @ rotation([0.0, 1.0, 0.0], np.radians(degrees)).T + centre
    return X


def record(size, file):
    """Keep the shapes of a drag, and what an iteration took."""
    V, F, fixed, handle = load(size)
    solver, shapes, times = Deformation(V, F, fixed, handle=fixed[handle], contact=False), [], []
    solver.aim(twisted(V, fixed, handle, STEP))
    while not solver.ready:
        solver.iterate()
    for k in range(round(LAST / STEP)):
        solver.aim(twisted(V, fixed, handle, STEP * (k + 1)))
        for _ in range(EACH + (SETTLING if STEP * (k + 1) == LAST else 0)):
            begun = time.process_time()
            solver.iterate()
            times.append(1e3 * (time.process_time() - begun))
            shapes.append(solver.solver.progress.U.astype(np.float32))
    np.savez(file, V=V, F=F, shapes=shapes, times=times)


def timed(part, key, spent):
    """The method ``part``, with its calls and milliseconds added up."""

    def wrapped(self, *args):
        begun = time.process_time()
        found = part(self, *args)
        calls, total = spent.get(key, (0, 0.0))
        spent[key] = calls + 1, total + 1e3 * (time.process_time() - begun)
        return found

    return wrapped


def watched(spent):
    """Add up the time of the parts of contact."""
    for kind, name in PARTS:
        setattr(kind, name, timed(getattr(kind, name), f"{kind.__name__}.{name}", spent))


def replay(file):
    """Milliseconds of contact on the way through the shapes of a file."""
    kept, spent = np.load(file), {}
    V, F, shapes = kept["V"], kept["F"], kept["shapes"]
    thickness = THICKNESS * float(np.linalg.norm(np.ptp(V, axis=0)))
    contact = Contact(V, F, np.zeros(len(V), np.int64), 1.0, thickness)
    watched(spent)
    times, refused = [], 0
    for W in shapes.astype(float):
        begun = time.process_time()
        refused += not contact.move_to(W)
        times.append(1e3 * (time.process_time() - begun))
    drag = len(shapes) - SETTLING
    return {"drag": np.mean(times[:drag]), "rest": np.mean(times[drag:]), "refused": refused, "parts": spent}


def solve(size):
    """Print what an iteration with contact takes, relative to one without."""
    V, F, fixed, handle = load(size)
    thickness = THICKNESS * float(np.linalg.norm(np.ptp(V, axis=0)))
    named = {"fixed": fixed, "handle": fixed[handle]}
    solvers = [
        Deformation(V, F, **named, contact=False),
        Deformation(V, F, **named, contact=True, thickness=thickness),
    ]
    times = [[], []]
    for k in range(round(LAST / STEP)):
        for solver in solvers:
            solver.aim(twisted(V, fixed, handle, STEP * (k + 1)))
        for _ in range(EACH + (SETTLING if STEP * (k + 1) == LAST else 0)):
            for which, solver in enumerate(solvers):
                begun = time.perf_counter()
                solver.iterate()
                times[which].append(1e3 * (time.perf_counter() - begun))
    plain, touching = np.array(times)[:, EACH:]  # the first step compiles, and makes the factor
    for name, part in (("drag", slice(0, -SETTLING)), ("converging", slice(-SETTLING, None))):
        a, b = plain[part], touching[part]
        print(
            f"{size:5} {name:11} without {a.mean():7.1f} ms, with {b.mean():7.1f} ms: "
            f"means x {b.mean() / a.mean():.2f}, medians x {np.median(b) / np.median(a):.2f}",
            flush=True,
        )


def twist(edge):
    """Print when a bottle twisted by 240° arrives, and comes near the energy that it ends with."""
    V, F, _ = sample_bottle(edge)
    axis = int(np.argmax(np.ptp(V, axis=0)))
    height = (V[:, axis] - V[:, axis].min()) / np.ptp(V[:, axis])
    fixed = np.flatnonzero((height < END) | (height > 1.0 - END))
    handle = height[fixed] > 0.5
    X, centre = V[fixed].copy(), V[fixed[handle]].mean(axis=0)
    X[handle] = (X[handle] - centre) @ rotation(np.eye(3)[axis], np.radians(TWIST)).T + centre
    solver = Deformation(V, F, fixed, handle=fixed[handle], contact=True)
    begun, arrived, seen = time.perf_counter(), None, []
    solver.aim(X)
    now = time.perf_counter() - begun
    while not solver.settled:
        begun = time.perf_counter()
        solver.iterate()
        now += time.perf_counter() - begun  # without reading the energy
        if arrived is None and not solver.solver.is_on_its_way:
            arrived = now
        seen.append((now, solver.solver.energy))
    times, energies = np.array([(t, e) for t, e in seen if e is not None and t >= arrived]).T
    near = times[np.append(np.flatnonzero(energies > 1.02 * energies[-1]) + 1, 0).max()]
    print(
        f"{len(V):,} vertices: arrived after {arrived:.1f} s, within 2 % after {near:.1f} s, "
        f"settled after {times[-1]:.1f} s, {len(seen)} iterations, energy {energies[-1]:.4f}",
        flush=True,
    )


def main():
    """Record, or replay and print the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--before", type=Path)
    parser.add_argument("what", choices=["record", "replay", "one", "solve", "twist"])
    parser.add_argument("names", nargs="+")
    asked = parser.parse_args()
    if asked.what == "record":
        record(*asked.names)
        return
    if asked.what == "solve":
        for size in asked.names:
            solve(size)
        return
    if asked.what == "twist":
        for edge in asked.names:
            twist(float(edge))
        return
    if asked.what == "one":
        print(json.dumps(replay(asked.names[0])))
        return
    print("| shapes | checkout | drag, ms | converging, ms | refused | parts: calls, ms |")
    print("|---|---|---|---|---|---|")
    checkouts = {"before": asked.before, "now": Path(__file__).parents[2]}
    for file in asked.names:
        for _ in range(TURNS):
            for name, checkout in checkouts.items():
                if checkout:
                    at = {**os.environ, "PYTHONPATH": str(checkout), "NUMBA_NUM_THREADS": "1"}
                    command = [sys.executable, str(Path(__file__).resolve()), "one", file]
                    done = subprocess.run(command, env=at, check=True, capture_output=True, text=True)
                    found = json.loads(done.stdout.splitlines()[-1])
                    parts = ", ".join(f"{k} {n} {t:.0f}" for k, (n, t) in found["parts"].items())
                    print(
                        f"| {Path(file).stem} | {name} | {found['drag']:.1f} | {found['rest']:.1f} | "
                        f"{found['refused']} | {parts} |",
                        flush=True,
                    )


if __name__ == "__main__":
    main()
