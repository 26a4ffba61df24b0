"""Cans pressed along their axis with other dents each time: their yields over the classical load.

    python tests/benchmarks/top_loads.py [radius over thickness] [vertices around] [runs]

Without numbers, ten runs of three thicknesses; the thinnest takes half an hour. The lids are of the same
wall, the plates without friction, dents a tenth of the wall deep, and steps a tenth of the classical
shortening.
"""

import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
import meshes

import apd_viewer
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.solver.linear_buckling import classical_load, knock_down_factor

_HEIGHT, _POISSON, _DENTS = 2.0, 0.3, 0.1
_WAY, _STEPS = 1.3, 13  # in classical shortenings
_CANS = (10.0, 48, 10), (30.0, 72, 10), (100.0, 130, 10)


def press_can(slenderness: float, around: int, runs: int) -> None:
    """Press a can of radius 1 with other dents each time, and print its yields."""
    V, F = meshes.can(around, _HEIGHT)
    thickness = 1.0 / slenderness
    wall = Material(thickness=thickness, poisson=_POISSON)
    classical = classical_load(wall)
    shortening = classical / (2.0 * np.pi * wall.tensile_stiffness) * _HEIGHT
    length = 0.5 * np.sqrt(np.linalg.norm(np.ptp(V, axis=0)) * thickness)
    presses = []
    for seed in range(runs):
        began = time.perf_counter()
        dented = apd_viewer.dented_shape(V, F, _DENTS * thickness, length, seed)
        end = float(np.ptp(dented[:, 2])) - _WAY * shortening
        presses.append(
            apd_viewer.press(
                *(dented, F, (0.0, 0.0, 1.0), end, _STEPS),
                method="wall",
                wall_thickness=thickness,
                poisson=_POISSON,
            )
        )
        deflection, load = apd_viewer.PressBand(tuple(presses)).yields[-1]
        steps = presses[-1].steps
        calm = f"{sum(step.settled for step in steps)} of {len(steps)}"
        print(
            f"  seed {seed}: yields at {load / classical:.3f} of the classical load, "
            f"{deflection / shortening:.2f} of its shortening; {calm} steps at rest, "
            f"{steps[-1].crossings} crossings, {time.perf_counter() - began:.0f} s",
            flush=True,
        )
    shares = apd_viewer.PressBand(tuple(presses)).yields[:, 1] / classical
    print(
        f"R/t {slenderness:g}, {len(V)} vertices: {np.nanmin(shares):.2f} to {np.nanmax(shares):.2f}, mean "
        f"{np.nanmean(shares):.2f} of the classical load; NASA SP-8007: {knock_down_factor(slenderness):.2f}",
        flush=True,
    )


if __name__ == "__main__":
    numbers = [float(word) for word in sys.argv[1:]]
    for slenderness, around, runs in [(numbers[0], *map(int, numbers[1:]))] if numbers else _CANS:
        press_can(slenderness, around, runs)
