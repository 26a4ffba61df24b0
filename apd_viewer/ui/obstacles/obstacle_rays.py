"""Rays of the camera to obstacles as they are drawn."""

from __future__ import annotations

import numpy as np

from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind
from apd_viewer.ui.obstacles.obstacle_shapes import ShapeExtent, axes_along, drawing_anchor, plate_half_sides


def ray_distance(
    obstacle: NamedObstacle, shift: np.ndarray, extent: ShapeExtent, origin: np.ndarray, direction: np.ndarray
) -> float:
    """Distance along a ray from ``origin`` in a unit ``direction``; or infinite."""
    at = origin - drawing_anchor(obstacle, shift, extent)
    axes = axes_along(obstacle.axis)
    start, step = axes @ at, axes @ direction
    if obstacle.kind is ObstacleKind.PLATE:
        t = -start[2] / step[2] if step[2] else np.inf
        within = t > 0.0 and (np.abs(start + t * step)[:2] <= plate_half_sides(axes, extent)).all()
        return float(t) if within else np.inf
    half = 0.5 * obstacle.length if obstacle.kind is ObstacleKind.CYLINDER else 0.0
    return _to_capsule(start, step, half, obstacle.radius)


def _to_capsule(start: np.ndarray, step: np.ndarray, half: float, radius: float) -> float:
    """Distance of a ray to a capsule along z."""
    ends = [_to_sphere(start - [0.0, 0.0, z], step, radius) for z in (-half, half)]
    t = _smaller_root(step[:2] @ step[:2], start[:2] @ step[:2], start[:2] @ start[:2] - radius**2)
    side = t if t > 0.0 and abs(start[2] + t * step[2]) <= half else np.inf
    return min(*ends, side)


def _to_sphere(start: np.ndarray, step: np.ndarray, radius: float) -> float:
    t = _smaller_root(step @ step, start @ step, start @ start - radius**2)
    return t if t > 0.0 else np.inf


def _smaller_root(a: float, b: float, c: float) -> float:
    """Smaller root of a t² + 2 b t + c; infinite without one."""
    rest = b * b - a * c
    return float((-b - np.sqrt(rest)) / a) if a > 0.0 and rest >= 0.0 else np.inf
