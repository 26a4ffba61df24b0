"""Shapes of obstacles for drawing and picking: finite plates, spheres, capsules."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from apd_viewer.geometry.mesh.arrays import checked_direction
from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind

# Plates are infinite: the drawn part covers the projection of the mesh, with this margin in its diagonals.
_MARGIN = 0.08
_CORNER = 0.06  # corner radius, relative to the mesh diagonal
_MARK = 0.055  # arrow length at the sides, relative to the mesh diagonal
_ROUND = 48  # points per circle
_DASHES = 2  # every other segment of an outline is left out


@dataclass(frozen=True, eq=False)
class ShapeExtent:
    """Bounding box of a mesh; determines the size of drawn plates.

    Attributes
    ----------
    middle, half : (3,) float array
        Its centre, and half of its sides, mesh units.
    """

    middle: np.ndarray
    half: np.ndarray

    @classmethod
    def from_points(cls, points: np.ndarray) -> ShapeExtent:
        """Bounding box of points (k, 3)."""
        low, high = points.min(axis=0), points.max(axis=0)
        return cls(0.5 * (low + high), 0.5 * (high - low))

    @property
    def diagonal(self) -> float:
        """Length of the bounding box diagonal."""
        return 2.0 * float(np.linalg.norm(self.half))


@dataclass(frozen=True, eq=False)
class ObstacleShape:
    """Surface and outline of an obstacle, relative to its :func:`drawing_anchor`.

    Attributes
    ----------
    V, F, normals : (n, 3), (m, 3) and (n, 3) arrays
    outline : (k, 2, 3) float array
        Lines.
    marks : (k, 3, 3) float array
        Triangles: tips of the arrows along the normal of a plate.
    """

    V: np.ndarray
    F: np.ndarray
    normals: np.ndarray
    outline: np.ndarray
    marks: np.ndarray

    @property
    def dashes(self) -> np.ndarray:
        """Every other segment of the outline, for a dashed line."""
        return self.outline[::_DASHES]


def drawing_anchor(obstacle: NamedObstacle, shift: np.ndarray, extent: ShapeExtent) -> np.ndarray:
    """Centre (3,) of the drawing; for a plate, its point nearest to the mesh."""
    at = obstacle.place + shift
    if obstacle.kind is not ObstacleKind.PLATE:
        return at
    foot: np.ndarray = extent.middle + float((at - extent.middle) @ obstacle.axis) * obstacle.axis
    return foot


def axes_along(axis: np.ndarray) -> np.ndarray:
    """Unit axes as rows (3, 3), right-handed; the last is along ``axis``."""
    normal = checked_direction(axis)
    first = np.eye(3)[np.argmin(np.abs(normal) - [2e-9, 1e-9, 0.0])]  # ties go to the lowest index
    across = checked_direction(first - (first @ normal) * normal)
    return np.array([across, np.cross(normal, across), normal])


def plate_half_sides(axes: np.ndarray, extent: ShapeExtent) -> np.ndarray:
    """Half side lengths (2,) of the drawn part of a plate with these axes."""
    sides: np.ndarray = np.abs(axes[:2]) @ extent.half + _MARGIN * extent.diagonal
    return sides


def obstacle_shape(obstacle: NamedObstacle, extent: ShapeExtent) -> ObstacleShape:
    """Surface and outline of an obstacle, for drawing."""
    if obstacle.kind is ObstacleKind.PLATE:
        return _plate(obstacle, extent)
    half = 0.5 * obstacle.length if obstacle.kind is ObstacleKind.CYLINDER else 0.0
    return _capsule(axes_along(obstacle.axis), half, obstacle.radius)


def _plate(obstacle: NamedObstacle, extent: ShapeExtent) -> ObstacleShape:
    axes = axes_along(obstacle.axis)
    a, b = plate_half_sides(axes, extent)
    size = extent.diagonal
    rim = _rounded_rectangle(a, b, _CORNER * size) @ axes[:2]
    V = np.vstack([np.zeros((1, 3)), rim])
    ring = 1 + np.arange(len(rim))
    F = np.column_stack([np.zeros(len(rim), int), ring, np.roll(ring, -1)])
    normal = axes[2]
    feet = np.array([[a, 0.0], [-a, 0.0], [0.0, b], [0.0, -b]]) @ axes[:2]
    tips = feet + _MARK * size * normal
    shafts = np.stack([feet, feet + 0.7 * _MARK * size * normal], axis=1)
    outline = np.concatenate([np.stack([rim, np.roll(rim, -1, axis=0)], axis=1), shafts])
    return ObstacleShape(V, F, np.tile(normal, (len(V), 1)), outline, _cones(tips, axes, 0.4 * _MARK * size))


def _rounded_rectangle(a: float, b: float, corner: float) -> np.ndarray:
    """Outline (k, 2) of a rectangle with rounded corners, in short segments."""
    r = min(corner, a, b)
    turn = np.linspace(0.0, 0.5 * np.pi, 7)
    arc = r * np.column_stack([np.cos(turn), np.sin(turn)])
    points = []
    for k, (x, y) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        c, s = np.cos(0.5 * np.pi * k), np.sin(0.5 * np.pi * k)
        points.append(arc @ np.array([[c, s], [-s, c]]) + [x * (a - r), y * (b - r)])
    corners = np.vstack(points)
    after = np.roll(corners, -1, axis=0)
    # Long sides are split into segments for a dashed outline.
    return np.vstack(
        [
            p + np.linspace(0.0, 1.0, _pieces(p, q, a + b))[:-1, None] * (q - p)
            for p, q in zip(corners, after, strict=True)
        ]
    )


def _pieces(p: np.ndarray, q: np.ndarray, size: float) -> int:
    return max(2, int(np.ceil(40.0 * float(np.linalg.norm(q - p)) / size)))


def _cones(tips: np.ndarray, axes: np.ndarray, length: float) -> np.ndarray:
    """Triangles (k, 3, 3) of a slender cone at each tip, pointing along the last axis."""
    turn = np.linspace(0.0, 2.0 * np.pi, 13)
    rim = 0.35 * length * np.column_stack([np.cos(turn), np.sin(turn)]) @ axes[:2] - length * axes[2]
    sides = np.stack([np.zeros((12, 3)), rim[:-1], rim[1:]], axis=1)
    lids = np.stack([np.tile(-length * axes[2], (12, 1)), rim[1:], rim[:-1]], axis=1)
    cone = np.concatenate([sides, lids])
    return (tips[:, None, None] + cone).reshape(-1, 3, 3)


def _capsule(axes: np.ndarray, half: float, radius: float) -> ObstacleShape:
    """Sphere stretched by ``half`` in both directions along its last axis."""
    turn = np.linspace(0.0, 2.0 * np.pi, _ROUND + 1)[:-1]
    lift = np.linspace(-0.5 * np.pi, 0.5 * np.pi, _ROUND // 2 + 1)
    lift = np.insert(lift, len(lift) // 2, 0.0)  # doubled equator, split by the cylinder's length
    up = np.where(np.arange(len(lift)) < len(lift) // 2, -1.0, 1.0)
    flat, high = np.cos(lift), np.sin(lift)
    N = np.stack(
        [np.outer(flat, np.cos(turn)), np.outer(flat, np.sin(turn)), np.tile(high[:, None], _ROUND)], axis=2
    ).reshape(-1, 3)
    V = radius * N + np.repeat(up * half, _ROUND)[:, None] * [0.0, 0.0, 1.0]
    return ObstacleShape(
        V @ axes, _grid(len(lift)), N @ axes, _profile(axes, half, radius), np.empty((0, 3, 3))
    )


def _grid(rows: int) -> np.ndarray:
    """Triangles between the rows of a grid, closed around the axis."""
    k, j = np.meshgrid(np.arange(rows - 1), np.arange(_ROUND), indexing="ij")
    a, b = k * _ROUND + j, k * _ROUND + (j + 1) % _ROUND
    c, d = a + _ROUND, b + _ROUND
    quads = np.stack([np.stack([a, b, d], axis=2), np.stack([a, d, c], axis=2)], axis=2)
    return quads.reshape(-1, 3)


def _profile(axes: np.ndarray, half: float, radius: float) -> np.ndarray:
    """Segments (k, 2, 3) of circles around both ends and of two axial sections."""
    turn = np.linspace(0.0, 2.0 * np.pi, 2 * _ROUND + 1)
    c, s, nil = radius * np.cos(turn), radius * np.sin(turn), np.zeros(len(turn))
    along = s + half * np.where(np.sin(turn) >= 0.0, 1.0, -1.0)
    rings = [np.column_stack([c, s, nil + z]) for z in sorted({-half, half})]
    rings += [np.column_stack([c, nil, along]), np.column_stack([nil, c, along])]
    return np.concatenate([np.stack([ring[:-1], ring[1:]], axis=1) for ring in rings]) @ axes
