"""Bounding boxes of a shape, and its compactness."""

from __future__ import annotations

import math

import numpy as np

# The search for the smallest box starts from this many orientations and refines the best of them.
_ORIENTATIONS, _BEST = 200, 4
_NEAR = 0.05  # radians
# Corners of the convex hull that are enough to tell one orientation from another.
_ENOUGH = 4000


def box_volume(points: np.ndarray) -> float:
    """Volume of the box along the axes around the ``points`` (k, 3)."""
    return float(np.prod(np.ptp(points, axis=0)))


def smallest_box(corners: np.ndarray) -> tuple[float, float, float]:
    """Sides of the smallest box found around ``corners`` (k, 3), shortest first.

    No algorithm for it is exact and quick. The search is the same every time, and never worse than the box
    along the axes.
    """
    # Imported here: few runs of the program come this way, and the first picture does not wait for scipy.
    from scipy.optimize import minimize
    from scipy.spatial.transform import Rotation

    corners = np.ascontiguousarray((corners - corners.mean(axis=0)).T)
    some = np.ascontiguousarray(corners[:, :: 1 + corners.shape[1] // _ENOUGH])

    def placed(turn: np.ndarray, what: np.ndarray) -> np.ndarray:
        return (Rotation.from_rotvec(turn).as_matrix() @ what).T

    def turned(turn: np.ndarray) -> float:
        return box_volume(placed(turn, some))

    spread = Rotation.random(_ORIENTATIONS, rng=0).as_rotvec()
    best = spread[np.argsort([turned(turn) for turn in spread])[:_BEST]]
    size, sides = box_volume(corners.T), np.ptp(corners, axis=1)
    for start in (np.zeros(3), _principal(corners), *best):
        around = np.vstack([start, start + _NEAR * np.eye(3)])
        options = {"initial_simplex": around, "xatol": 1e-7, "fatol": 1e-12 * size, "maxiter": 400}
        found = minimize(turned, start, method="Nelder-Mead", options=options).x
        sides = min(sides, np.ptp(placed(found, corners), axis=0), key=np.prod)
    a, b, c = np.sort(sides).tolist()
    return a, b, c


def _principal(corners: np.ndarray) -> np.ndarray:
    """Rotation vector from the principal axes of ``corners`` (3, k) to x, y, z."""
    # Imported here: scipy is slow to load, and few commands need it.
    from scipy.spatial.transform import Rotation

    axes = np.linalg.eigh(corners @ corners.T)[1].T
    return Rotation.from_matrix(axes * np.linalg.det(axes)).as_rotvec()


def compactness(volume: float, area: float) -> float:
    """Isoperimetric ratio ``36 pi V^2 / A^3``: 1 for a ball, else less."""
    return 36.0 * math.pi * volume**2 / area**3
