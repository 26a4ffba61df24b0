"""Setup, iterations and the way to the end, against libigl and Open3D, in one run.

    python tests/benchmarks/speed.py [--largest]

The sample bottle, twisted by 120 degrees. Whatever is compared takes turns, so that whatever else the
machine does falls on all of it; the figures are medians. "solve" is the triangular solve within the arap
iterations. Open3D factors anew at every call, so its iterations are those of one call, the setup taken off;
it is left out where it is not installed.

The second table: how long it takes to an energy within 2 % of the best that any run here has found. That
best is searched for by runs that turn the handle in several steps, and from a dented bottle; shapes that
buckle have many minima.
"""

import argparse
import importlib
import sys
import time
from pathlib import Path

import igl
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from meshes import rotation, sample_bottle

from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.pose.constraints import constraints
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.warmup import warm_up

EDGES = {1.0: 12, 0.565: 8, 0.282: 5}  # length of the edges: turns
LARGEST = {0.141: 2}
WARM_UP = 1
OPEN3D_IN_A_ROW = 12
IN_A_ROW = 4  # as in use: taking turns after every iteration would be a test of the caches
ITERATIONS = (
    *("vertices", "setup, libigl", "setup", "libigl", "Open3D", "arap", "exact", "solve"),
    *("libigl / arap", "arap / solve", "exact / arap"),
)
TO_THE_END = (
    *("vertices", "method", "energies found", "ended", "within 2 % after"),
    *("plain iterations ended", "within 2 % after", "times faster to their end"),
)
TO_THE_END_AT = {1.0: 6, 0.358: 2}  # length of the edges: dented starts in the search for the best energy
STEPS = (2, 3)
TWIST = np.eye(4)
TWIST[:3, :3] = rotation([0, 1, 0], 2 * np.pi / 3)


def timed(work):
    """What work() returns, and how long it took in milliseconds."""
    started = time.perf_counter()
    value = work()
    return value, 1e3 * (time.perf_counter() - started)


class Libigl:
    """As-rigid-as-possible with the energy of Eq. 1."""

    def __init__(self, V, F, held):
        self.data = igl.ARAPData()
        self.data.energy = igl.ARAPEnergyType.ARAP_ENERGY_TYPE_SPOKES
        self.data.max_iter = 1
        igl.arap_precomputation(V, F, 3, held.fixed.astype(np.int64), self.data)
        self.U, self.targets = V.copy(), held.targets

    def iterate(self):
        self.U = igl.arap_solve(self.targets, self.data, self.U)


def ours(rest, held, method):
    solver = Deformation(
        rest.V, rest.F, held.fixed, method=method, handle=held.handles, plain=True, rest=rest
    )
    solver.aim(held.targets)
    return solver


def open3d_iteration(V, F, held):
    """One iteration of Open3D in milliseconds, or nan."""
    try:
        o3d = importlib.import_module("open3d")
    except ImportError:
        return np.nan
    mesh = o3d.geometry.TriangleMesh(o3d.utility.Vector3dVector(V), o3d.utility.Vector3iVector(F))
    ids, where = o3d.utility.IntVector(held.fixed.astype(np.int32)), o3d.utility.Vector3dVector(held.targets)
    spokes = o3d.geometry.DeformAsRigidAsPossibleEnergy.Spokes

    def shortest(count):
        deform = mesh.deform_as_rigid_as_possible
        return min(timed(lambda: deform(ids, where, count, spokes))[1] for _ in range(2))

    return (shortest(1 + OPEN3D_IN_A_ROW) - shortest(1)) / OPEN3D_IN_A_ROW


def iterations(edge, count):
    """One line of the first table."""
    V, F, labels = sample_bottle(edge)
    held = constraints(labels, V, [TWIST])
    theirs, their_setup = timed(lambda: Libigl(V, F, held))
    rest, at_rest = timed(lambda: RestMesh(V, F))
    arap, factor = timed(lambda: ours(rest, held, "arap"))
    exact = ours(rest, held, "exact")
    times = {"libigl": [], "arap": [], "exact": [], "solve": []}
    factor_of = arap.solver.surface.factor
    solve = factor_of.solve_refined

    def timed_solve(B):
        X, taken = timed(lambda: solve(B))
        times["solve"].append(taken)
        return X

    factor_of.solve_refined = timed_solve
    for _ in range(WARM_UP + count):
        for name, solver in (("libigl", theirs), ("arap", arap), ("exact", exact)):
            for _ in range(IN_A_ROW):
                times[name].append(timed(solver.iterate)[1])
    t = {name: float(np.median(taken[WARM_UP * IN_A_ROW :])) for name, taken in times.items()}
    t["Open3D"] = open3d_iteration(V, F, held)
    return (
        *(f"{len(V):,}", f"{their_setup:.0f}", f"{at_rest + factor:.0f}"),
        *(f"{t[name]:.2f}" for name in ("libigl", "Open3D", "arap", "exact", "solve")),
        *(f"{t['libigl'] / t['arap']:.1f}", f"{t['arap'] / t['solve']:.2f}", f"{t['exact'] / t['arap']:.2f}"),
    )


def energies(solver, seconds, most):
    """Energies and the seconds until each, aimed at the twist, to the end or for so long."""
    surface, started, course = solver.solver.surface, time.perf_counter(), []
    while len(course) < most and not (course and (solver.settled or course[-1][0] > seconds)):
        solver.iterate()
        course.append((time.perf_counter() - started, surface.energy))
    return np.array(course)


def dented(rest, fixed, count):
    """The rest pose with smooth dents of up to a few edges, ``count`` times; held vertices stay."""
    V, W, rng = rest.V, rest.solve_mesh.W, np.random.default_rng(0)
    degree = W.sum(axis=1)[:, None]
    edge = np.sqrt(rest.area / len(V))
    for _ in range(count):
        dents = rng.normal(size=V.shape)
        for _ in range(rng.integers(2, 30)):
            dents = (W @ dents) / degree
        U = V + rng.choice([0.5, 1.0, 2.0, 4.0]) * edge * dents / np.abs(dents).max()
        U[fixed] = V[fixed]
        yield U


def way_to_the_end(edge, method, dents, plain_seconds):
    """One line of the second table."""
    V, F, labels = sample_bottle(edge)
    held, rest = constraints(labels, V, [TWIST]), RestMesh(V, F)
    solver = Deformation(V, F, held.fixed, method=method, handle=held.handles, rest=rest)
    solver.aim(held.targets)
    fast = energies(solver, np.inf, 3000)
    ends = [fast[-1, 1]]
    for steps in STEPS:  # other ways to turn by 120 degrees, which may end in other folds
        solver.aim(V[held.fixed], U=V)
        for k in range(1, steps + 1):
            part = np.eye(4)
            part[:3, :3] = rotation([0, 1, 0], 2 * np.pi / 3 * k / steps)
            solver.aim(constraints(labels, V, [part]).targets)
            course = energies(solver, np.inf, 100 if k < steps else 3000)
        ends.append(course[-1, 1])
    for start in dented(rest, held.fixed, dents):
        solver.aim(held.targets, U=start)
        ends.append(energies(solver, np.inf, 3000)[-1, 1])
    best = min(ends)
    plain = energies(ours(rest, held, method), plain_seconds, 10**6)

    def when(course, energy):
        there = np.flatnonzero(course[:, 1] <= energy)
        return course[there[0], 0] if len(there) else np.inf

    same = when(fast, plain[-1, 1])
    return (
        *(f"{len(V):,}", method, f"{best:.4g} to {max(ends):.4g}"),
        *(f"{fast[-1, 1] / best - 1:+.1%} after {fast[-1, 0]:.1f} s", f"{when(fast, 1.02 * best):.2f} s"),
        *(f"{plain[-1, 1] / best - 1:+.0%} after {plain[-1, 0]:.0f} s", f"{when(plain, 1.02 * best):.3g} s"),
        f"{plain[-1, 0] / same:.0f}",
    )


def row(cells):
    """A line of a table in Markdown."""
    print("| " + " | ".join(cells) + " |", flush=True)


def main() -> None:
    """Print both tables as Markdown."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--largest", action="store_true", help="also at 655,000 vertices")
    parser.add_argument("--plain-seconds", type=float, default=60.0, help="how long plain iterations get")
    options = parser.parse_args()
    warm_up()
    print("Milliseconds.\n")
    row(ITERATIONS)
    row(["---"] * len(ITERATIONS))
    for edge, count in {**EDGES, **(LARGEST if options.largest else {})}.items():
        row(iterations(edge, count))
    print()
    row(TO_THE_END)
    row(["---"] * len(TO_THE_END))
    for edge, dents in TO_THE_END_AT.items():
        for method in ("arap", "exact"):
            row(way_to_the_end(edge, method, dents, options.plain_seconds))


if __name__ == "__main__":
    main()
