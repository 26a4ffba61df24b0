"""What contact costs on the sample bottle, and where twists and pushes end with it.

    python tests/benchmarks/contact.py [--refined | --edge=LENGTH] [CASE ...]

A case is ``twist:DEGREES`` or ``push:SHARE`` (of the height), whose every frame is checked by ipctk, or what
steps of 2° cost with and without contact in turns, ``free`` (up to 50°, where nothing touches) and
``touching`` (from 120° to 160°). With ``--refined`` every triangle is cut in four; with ``--edge`` the bottle
is made anew with edges so many times as long, such as 0.281 for 165,000 vertices. Times are those of the
processor on one core, without the checks, and those of the clock where NUMBA_NUM_THREADS is 2.
"""

import os
import sys
import time

os.environ.setdefault("NUMBA_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import ipctk
import numpy as np
from contact_at_size import cut_in_four
from meshes import sample_bottle

from apd_viewer.files.samples import open_sample
from apd_viewer.geometry.linalg.threads import cores_for
from apd_viewer.geometry.pose.constraints import FREE, HANDLE
from apd_viewer.geometry.solver.deformation import Deformation

CASES = ["free", "touching", "twist:60", "twist:120", "twist:180", "push:0.3", "push:0.5"]
HEADER = """| | reached | iterations | crossed frames | area error | energy | volume | ms | median | p95 |
|---|---|---|---|---|---|---|---|---|---|"""
MOST = 3000
MOST_BEFORE = 900  # iterations before a drag in touch: a large bottle settles after thousands
RUNS = 3
STEP, EACH = 2, 4  # degrees of a drag, and iterations between
QUARTER = 90.0  # degrees; a turn goes in such steps, each to its end but the last frames


class Bottle:
    """The sample with its paint, refined or not, or made anew, twisted or pushed."""

    def __init__(self, is_refined: bool = False, edge: float | None = None) -> None:
        mesh, labels = open_sample("bottle")
        self.V, self.F = mesh.V, mesh.F
        if edge is not None:
            self.V, self.F, labels = sample_bottle(edge)
        elif is_refined:
            self.V, self.F, labels = cut_in_four(self.V, self.F, labels)
        self.fixed = np.flatnonzero(labels != FREE)
        self.handle = np.flatnonzero(labels >= HANDLE)
        self.rows = labels[self.fixed] >= HANDLE
        self.height = float(np.ptp(self.V[:, 1]))

    def solver(self, **options: object) -> Deformation:
        return Deformation(self.V, self.F, self.fixed, handle=self.handle, **options)

    def twisted(self, degrees: float) -> np.ndarray:
        """Targets with the handle turned about the axis of the bottle."""
        a, X = np.radians(degrees), self.V[self.fixed].copy()
        x, z = X[self.rows, 0].copy(), X[self.rows, 2].copy()
        X[self.rows, 0], X[self.rows, 2] = np.cos(a) * x + np.sin(a) * z, np.cos(a) * z - np.sin(a) * x
        return X

    def pushed(self, share: float) -> np.ndarray:
        """Targets with the handle lowered by a share of the height."""
        X = self.V[self.fixed].copy()
        X[self.rows, 1] -= share * self.height
        return X

    def way(self, case: str) -> list[np.ndarray]:
        """Targets one after another."""
        kind, amount = case.split(":")[0], float(case.split(":")[1])
        if kind == "push":
            return [self.pushed(amount)]
        steps = int(np.ceil(amount / QUARTER))
        return [self.twisted(amount * (k + 1) / steps) for k in range(steps)]


def timed(solver: Deformation) -> float:
    """Milliseconds that an iteration takes, of the processor where there is one thread."""
    clock = time.process_time if os.environ["NUMBA_NUM_THREADS"] == "1" else time.perf_counter
    begun = clock()
    solver.iterate()
    return 1e3 * (clock() - begun)


def end_of(bottle: Bottle, case: str) -> str:
    """Row of the table of ends."""
    F = np.asfortranarray(bottle.F, dtype=np.int32)
    checked = ipctk.CollisionMesh(np.asfortranarray(bottle.V), ipctk.edges(F), F)
    solver, times, crossed, worst = bottle.solver(contact=True), [], 0, 0.0
    for targets in (way := bottle.way(case)):
        solver.aim(targets)
        while not solver.settled and len(times) < MOST:
            times.append(timed(solver))
            frame = solver.frame()
            crossed += ipctk.has_intersections(checked, np.asfortranarray(frame.U))
            worst = max(worst, abs(frame.area_error))
            if targets is not way[-1] and not solver.is_on_its_way:
                break
    late = "" if solver.settled else ", not settled"
    return (
        f"| {case} | {100 * frame.share_reached:.0f} % | {len(times)}{late} | {crossed} | {worst:.0e} | "
        f"{frame.energy:.4f} | {frame.volume:.2f} | {np.mean(times):.1f} | {np.median(times):.1f} | "
        f"{np.percentile(times, 95):.0f} |"
    )


def print_cost(bottle: Bottle, first: int, last: int) -> None:
    """Print what contact costs in a drag from ``first`` to ``last`` degrees, and while it converges then."""
    print(f"\n| from {first}° to {last}° | drag, ms | p95 | converging, ms | p95 |\n|---|---|---|---|---|")
    for _ in range(RUNS):
        for contact in (False, True):
            solver = bottle.solver(contact=contact)
            solver.aim(bottle.twisted(first))
            solver.iterate()
            before = 1
            while first > STEP and not solver.settled and before < MOST_BEFORE:
                solver.iterate()
                before += 1
            drag = []
            for degrees in range(first, last + 1, STEP):
                solver.aim(bottle.twisted(degrees + STEP))
                drag += [timed(solver) for _ in range(EACH)]
            converging: list[float] = []
            while solver.is_on_its_way:
                drag.append(timed(solver))
            while not solver.settled and len(converging) < 300:
                converging.append(timed(solver))
            name = "with contact" if contact else "without"
            figures = [f(x) for x in (drag, converging) for f in (np.mean, lambda x: np.percentile(x, 95))]
            print(f"| {name} | {' | '.join(f'{x:.2f}' for x in figures)} |", flush=True)


def main() -> None:
    """Print the tables."""
    edges = [float(word.partition("=")[2]) for word in sys.argv if word.startswith("--edge=")]
    bottle = Bottle("--refined" in sys.argv, *edges)
    cases = [case for case in sys.argv[1:] if not case.startswith("--")] or CASES
    ends = [case for case in cases if ":" in case]
    with cores_for(len(bottle.V)):
        if ends:
            print(HEADER)
        for case in ends:
            print(end_of(bottle, case), flush=True)
        if "free" in cases:
            print_cost(bottle, STEP, 50)
        if "touching" in cases:
            print_cost(bottle, 120, 160)


if __name__ == "__main__":
    main()
