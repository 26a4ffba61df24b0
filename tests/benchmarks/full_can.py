"""A can full of liquid, pressed along its axis with other dents each time: loads and places of its buckles.

    python tests/benchmarks/full_can.py [vertices around] [runs]

The can is that of Communications Physics, s42005-026-02589-5, 2026. By default five runs, seven minutes each
on one core.
"""

import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
import meshes

import apd_viewer
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.solver.linear_buckling import classical_load

_RADIUS, _HEIGHT, _THICKNESS, _POISSON = 26.5, 137.0, 0.1, 0.3  # mm
_DENTS, _GAP = 0.1 * _THICKNESS, 0.02
_STRAIN, _STEPS = 0.008, 16
_BUCKLE = 0.01  # of the radius: depth of the deepest place from which the can has buckled


def press_full_can(around: int, seed: int) -> None:
    """Press the can, and print load, depth and place of the deepest dent at each step."""
    V, F = meshes.can(around, _HEIGHT / _RADIUS)
    V = _RADIUS * V
    wall = np.flatnonzero(np.abs(np.hypot(V[:, 0], V[:, 1]) - _RADIUS) < 1e-6)
    classical = classical_load(Material(thickness=_THICKNESS, poisson=_POISSON))
    length = 0.5 * np.sqrt(np.linalg.norm(np.ptp(V, axis=0)) * _THICKNESS)
    dented = apd_viewer.dented_shape(V, F, _DENTS, length, seed)
    height, began = float(np.ptp(dented[:, 2])), time.perf_counter()
    pressed = apd_viewer.press(
        *(dented, F, (0.0, 0.0, 1.0), height - _STRAIN * _HEIGHT, _STEPS),
        method="wall",
        wall_thickness=_THICKNESS,
        poisson=_POISSON,
        volume=100.0,
        thickness=_GAP,
    )
    volumes = np.array([step.volume for step in pressed.steps])
    kept = np.abs(volumes / volumes[0] - 1.0).max()
    calm = sum(step.settled for step in pressed.steps)
    print(
        f"seed {seed}, {len(V)} vertices: {calm} of {len(volumes)} steps at rest, volume kept to {kept:.1e}, "
        f"{time.perf_counter() - began:.0f} s"
    )
    for step in pressed.steps:
        inwards = (_RADIUS - np.hypot(step.U[wall, 0], step.U[wall, 1])) / _RADIUS
        deepest = int(np.argmax(inwards))
        place = V[wall[deepest], 2] / _HEIGHT
        dent = f"{inwards[deepest]:.4f} of the radius deep at {place:.2f} of the height"
        strain, load = (height - step.distance) / _HEIGHT, step.load / classical
        said = dent if inwards[deepest] > _BUCKLE else "not buckled"
        print(f"  strain {strain:.5f}: {load:.3f} of the classical load, {said}", flush=True)


if __name__ == "__main__":
    around, runs = (*map(int, sys.argv[1:]), *(80, 5)[len(sys.argv) - 1 :])
    for seed in range(runs):
        press_full_can(around, seed)
