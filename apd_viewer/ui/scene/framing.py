"""Smallest camera move to show part of a mesh."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from PySide6.QtCore import QRectF

from apd_viewer.ui.scene.camera import Camera

# Vertices of a part that are tested for visibility.
_SAMPLES = 32
# Shares of what the best view shows: enough to stay, and to go no further than.
_ENOUGH, _BEST = 0.4, 0.9
# Candidate views: azimuths, and elevations in radians.
_WAYS = 12
_HEIGHTS = np.deg2rad([0.0, 30.0, -30.0, 60.0, -60.0])
# Share of a part that may be covered.
_UNSEEN = 0.2
# Share of the mesh shown around a part.
_AROUND = 0.08

# Origins and directions of rays, (k, 3), to the distances at which they meet the surface, (k,).
RayDistances = Callable[[np.ndarray, np.ndarray], np.ndarray]


def unobstructed_camera(
    camera: Camera, points: np.ndarray, normals: np.ndarray, size: float, rays: RayDistances
) -> Camera:
    """Camera orbited until the surface does not hide the points.

    It stays where it is if it sees enough of what could be seen.

    Parameters
    ----------
    camera : Camera
    points, normals : (k, 3) float array
        Normals are of length one, or zero where there is no surface.
    size : float
        Of the mesh.
    rays : callable
    """
    every = 1 + len(points) // _SAMPLES
    points, normals = points[::every], normals[::every]
    here = -camera.axes[2]
    now = _seen(points, normals, here, size, rays)
    if now >= _ENOUGH:
        return camera  # no view shows more than all
    stands = _around(camera.up_axis.frame @ here) @ camera.up_axis.frame
    seen = np.array([_seen(points, normals, stand, size, rays) for stand in stands])
    if now >= _ENOUGH * seen.max():
        return camera
    stand = stands[np.flatnonzero(seen >= _BEST * seen.max())[0]]
    return camera.seen_from(stand)


def _around(here: np.ndarray) -> np.ndarray:
    """Candidate directions (k, 3) with +Y up: level and near ones first."""
    turn, height = np.meshgrid(np.arange(_WAYS) * 2.0 * np.pi / _WAYS, _HEIGHTS)
    level = np.cos(height)
    stands = np.stack([level * np.sin(turn), np.sin(height), level * np.cos(turn)], axis=-1).reshape(-1, 3)
    return stands[np.argsort(np.abs(stands[:, 1]) - stands @ here, kind="stable")]


def _seen(
    points: np.ndarray, normals: np.ndarray, stand: np.ndarray, size: float, rays: RayDistances
) -> float:
    """Share of the surface at the points visible from ``stand``."""
    away = 2.0 * size
    met = rays(points + away * stand, np.tile(-stand, (len(points), 1)))
    faces = np.where(normals.any(axis=1), np.abs(normals @ stand), 1.0)
    return float((faces * (met > away - 1e-3 * size)).mean())


def is_in_view(camera: Camera, points: np.ndarray, covered: QRectF) -> bool:
    """True if all points are in view and most of them uncovered."""
    if (camera.depth(points) <= 0.0).any():
        return False
    x, y = camera.project(points).T
    across = (x > covered.left()) & (x < covered.right())
    under = across & (y > covered.top()) & (y < covered.bottom())
    inside = (x >= 0) & (x <= camera.width) & (y >= 0) & (y <= camera.height)
    return bool(inside.all() and under.mean() <= _UNSEEN)


def surrounding_box(points: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Corners (8, 3) of a box around the points and some of the mesh."""
    pad = _AROUND * float(np.linalg.norm(high - low))
    near, far = points.min(axis=0), points.max(axis=0)
    ends = np.array([np.maximum(near - pad, low), np.minimum(far + pad, high)])
    return np.array([[ends[i, 0], ends[j, 1], ends[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])


def uncovering_shift(camera: Camera, covered: QRectF) -> tuple[float, float]:
    """Pixel shift to the left or up into the uncovered part of the picture.

    ``covered`` is a part at the lower right; as many pixels must be free around what is shown.
    """
    wide, tall = max(0.0, camera.width - covered.left()), max(0.0, camera.height - covered.top())
    beside, above = (camera.width - wide) * camera.height, (camera.height - tall) * camera.width
    return (-wide / 2, 0.0) if beside > above else (0.0, -tall / 2)
