"""Press the sample bottle, or a tube, between two plates: load, energy and time of each step.

    python tests/benchmarks/pressing.py [--edge 1.0] [--tube AROUND] [--axis 0] [--to 0.2] [--steps 16]
                                        [--iterations 3000] [--stiffness 0.001] [--yield-radius R]
                                        [--jitter 0] [--check] [--slope] [--fist]

Edges of 1.0 and 0.565 make bottles of 13,000 and 41,000 vertices. The tube is three radii long. With a yield
radius the plates open again in the end. ``--check`` counts, by another library, the frames in which anything
crosses. ``--slope`` goes back a little after each step and comes to rest there, too: from the step on, where
a fold may have snapped on the way, back on the same branch. It prints the load over the slope of
the energy between the two, and at how many edges the two triangles lie on each other. ``--fist`` closes four
fingers and a thumb on the bottle instead of plates, with that load over the slope, too. Times are those of
the processor, on one core.
"""

import argparse
import os
import sys
import time
from collections.abc import Callable
from itertools import chain
from pathlib import Path
from typing import NamedTuple

os.environ.setdefault("NUMBA_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from crossing_check import CrossingCheck
from meshes import sample_bottle

from apd_viewer.geometry.contact.contact_obstacles import capsule
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.plate_press import PlatePress
from apd_viewer.geometry.solver.pressed_mesh import pressed_mesh

# Shares of a step between the two shapes whose energies are compared: the next one where a fold has snapped
# between them, that is, where something has moved so many times as far as the plates.
_NEAR = 0.02
_NEARER, _SNAPPED = (_NEAR, 0.1 * _NEAR, 0.01 * _NEAR), 20.0
# Radius of a finger in widths of the bottle, and steps of a fist.
_FINGER, _CLOSINGS = 0.15, 10


def tube(around: int, length: float = 3.0) -> tuple[np.ndarray, np.ndarray]:
    """Open tube of radius 1 of nearly equilateral triangles."""
    step = 2.0 * np.pi / around
    rows = round(length / (step * np.sqrt(3.0) / 2.0))
    i, j = np.meshgrid(np.arange(around), np.arange(rows + 1))
    angle = step * (i + 0.5 * (j % 2))
    V = np.column_stack([np.cos(angle).ravel(), np.sin(angle).ravel(), (j * length / rows).ravel()])
    i, j = i[:-1], j[:-1]
    p, q = j * around + i, j * around + (i + 1) % around
    odd = (j % 2 == 1)[..., None]
    first = np.where(odd, np.stack([p, q, q + around], -1), np.stack([p, q, p + around], -1))
    second = np.where(
        odd, np.stack([p, q + around, p + around], -1), np.stack([q, q + around, p + around], -1)
    )
    return V, np.concatenate([first.reshape(-1, 3), second.reshape(-1, 3)])


def steps_with_slopes(plates: PlatePress, count: int, look: Callable[[float], None]) -> None:
    """Press in ``count`` steps, with a row for each."""
    solver, F, began = plates.solver, plates.solver.rest.F, time.process_time()
    columns = (
        "share",
        "load below",
        "above",
        "slope",
        "load / slope",
        "energy",
        "flipped",
        "iterations",
        "s",
        "rest",
    )
    print(f"| {' | '.join(columns)} |\n{'|---' * len(columns)}|")
    for k in range(1, count + 1):
        for nearer in _NEARER:
            end, near = (come_to_rest(plates, (k - back) / count, look) for back in (0.0, nearer))
            if np.abs(end.U - near.U).max() <= _SNAPPED * (end.share - near.share) * plates.travel.length:
                break
        way = (end.share - near.share) * plates.travel.length
        slope = (end.energy - near.energy) / way
        mean = 0.25 * (near.low - near.high + end.low - end.high)
        loads = f"{end.low:.4f} | {-end.high:.4f} | {slope:.4f} | {mean / slope:.4f} | {end.energy:.5g}"
        distance = (
            plates.travel.first_distance - end.share * plates.travel.length
        ) / plates.travel.first_distance
        spent = f"{end.iterations} + {near.iterations} | {time.process_time() - began:.0f}"
        rest = f"{end.rests} {near.rests}"
        print(f"| {distance:.3f} | {loads} | {flipped(solver.frame().U, F)} | {spent} | {rest} |", flush=True)
        assert abs(solver.frame().area_error) <= 1e-9


class Rest(NamedTuple):
    """Readings of a shape between plates."""

    U: np.ndarray
    share: float
    low: float
    high: float
    energy: float
    iterations: int
    rests: bool


def come_to_rest(plates: PlatePress, share: float, look: Callable[[float], None]) -> Rest:
    """Readings at a share of the way."""
    plates.settle_at(share, look)
    frame, contact = plates.solver.frame(), plates.solver.contact
    assert contact is not None
    low, high = frame.loads @ plates.travel.axis
    energy = contact.energy_in_contact
    return Rest(frame.U, plates.travel_fraction, -low, -high, energy, frame.iteration, frame.settled)


def flipped(U: np.ndarray, F: np.ndarray) -> int:
    """Number of edges whose two triangles are turned against each other by more than 150°."""
    normals = np.cross(U[F[:, 1]] - U[F[:, 0]], U[F[:, 2]] - U[F[:, 0]])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    edges = np.sort(F[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    order = np.lexsort(edges.T)
    edges, faces = edges[order], np.repeat(np.arange(len(F)), 3)[order]
    twins = np.flatnonzero((edges[1:] == edges[:-1]).all(axis=1))
    cosine = np.einsum("ij,ij->i", normals[faces[twins]], normals[faces[twins + 1]])
    return int((cosine < np.cos(np.radians(150.0))).sum())


def fist(V: np.ndarray, F: np.ndarray, settings: dict[str, float], most: int) -> None:
    """Close four fingers and a thumb on the bottle, each by a fifth of its width; a row for each step."""
    rest, check, crossed, began = RestMesh(V, F), CrossingCheck(V, F), [0, 0], time.process_time()
    width, middle = float(np.ptp(V[:, 2])), float(np.median(V[:, 1]))
    away = _FINGER * width + 2e-3 * rest.diagonal
    places = [(middle + k * 0.36 * width, -1.0) for k in (-1.5, -0.5, 0.5, 1.5)] + [(middle, 1.0)]
    fingers, shifts = [], []
    for height, side in places:
        off = V[:, 1] - height
        near = np.abs(off) < away
        # As near as it can be without touching.
        z = side * float((side * V[near, 2] + np.sqrt(away**2 - off[near] ** 2)).max())
        fingers.append(capsule([-width, height, z], [width, height, z], _FINGER * width))
        shifts.append([0.0, 0.0, -side * width / 5.0])
    solver = Deformation(V, F, [], obstacles=fingers, contact=True, calm=False, **settings)
    contact, ways = solver.contact, np.array(shifts)
    assert contact is not None
    columns = (
        "gone in | loads | load / slope | together | energy | volume | area error | iterations | s | rest"
    )
    print(f"{len(V):,} vertices\n\n| {columns} |\n{'|---' * 10}|")
    for k in range(1, _CLOSINGS + 1):
        ends = []
        for share in (k / _CLOSINGS, (k - _NEAR) / _CLOSINGS):
            solver.aim(np.zeros((0, 3)), shifts=share * ways)
            frame = solver.step()
            while not frame.settled and frame.iteration < most and not contact.is_stopped:
                frame = solver.step()
                crossed[0] += 1
                crossed[1] += check.crosses(frame.U)
            load, gone = -float((frame.loads * ways).sum()), float(np.abs(frame.shifts / ways)[:, 2].mean())
            ends.append((gone, contact.energy_in_contact, load, frame.loads, frame.settled))
        (now, end, last, loads, rests), (before, energy, load, _, _) = ends
        slope, error = (end - energy) / (now - before), frame.area_error
        said = ", ".join(f"{np.linalg.norm(load):.3f}" for load in loads)
        spent = f"{frame.iteration} | {time.process_time() - began:.0f} | {rests}"
        together = f"{contact.load_imbalance:.0e} | {end:.5g} | {frame.volume:.1f} | {error:.0e}"
        ratio = f"{0.5 * (load + last) / slope:.4f}"
        print(f"| {now * 0.2:.3f} | {said} | {ratio} | {together} | {spent} |", flush=True)
        assert abs(error) <= 1e-9
    print(f"frames: {crossed[0]}, crossed: {crossed[1]}")


def main() -> None:
    """Print a row for each step, and the readings of the curve."""
    parser = argparse.ArgumentParser()
    for option, default in (("--edge", 1.0), ("--to", 0.2), ("--stiffness", 1e-3), ("--jitter", 0.0)):
        parser.add_argument(option, type=float, default=default)
    for option, default in (("--tube", 0), ("--axis", 0), ("--steps", 16), ("--iterations", 3000)):
        parser.add_argument(option, type=int, default=default)
    parser.add_argument("--yield-radius", type=float)
    for option in ("--check", "--slope", "--fist"):
        parser.add_argument(option, action="store_true")
    asked = parser.parse_args()
    V, F = tube(asked.tube) if asked.tube else sample_bottle(asked.edge)[:2]
    V = V + asked.jitter * np.linalg.norm(np.ptp(V, axis=0)) * np.random.default_rng(0).normal(size=V.shape)
    rest, extent = RestMesh(V, F), float(np.ptp(V[:, asked.axis]))
    axis, settings = np.eye(3)[asked.axis], {"stiffness": asked.stiffness, "yield_radius": asked.yield_radius}
    if asked.fist:
        fist(V, F, settings, asked.iterations)
        return
    plates = PlatePress(rest, axis, asked.to * extent, asked.steps, asked.iterations, **settings)
    check, crossed, steps, begun = CrossingCheck(V, F), [0, 0], [], time.process_time()

    def look(_: float) -> None:
        if asked.check:
            crossed[0] += 1
            crossed[1] += check.crosses(plates.solver.frame().U)

    if asked.slope:
        print(f"{len(V):,} vertices\n")
        steps_with_slopes(plates, asked.steps, look)
        print(f"frames: {crossed[0]}, crossed: {crossed[1]}")
        return
    columns = "distance", "load below", "above", "energy", "volume", "iterations", "s", "settled"
    print(f"{len(V):,} vertices\n\n| {' | '.join(columns)} |\n{'|---' * len(columns)}|")
    opening = plates.release(look) if asked.yield_radius else ()
    for step in chain(plates.steps(look), opening):
        steps.append(step)
        loads = f"{step.load_low:.4f} | {step.load_high:.4f} | {step.energy:.5g}"
        volume = "" if step.volume is None else f"{step.volume:.1f}"
        spent = f"{step.iterations} | {time.process_time() - begun:.0f} | {step.settled}"
        print(f"| {step.distance / extent:.3f} | {loads} | {volume} | {spent} |", flush=True)
        assert abs(step.area_error) <= 1e-9
    print(f"\n{pressed_mesh(steps[: asked.steps + 1], (), plates.is_stopped, None).curve}")
    if asked.check:
        print(f"frames: {crossed[0]}, crossed: {crossed[1]}")


if __name__ == "__main__":
    main()
