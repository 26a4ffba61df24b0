"""Meshes made in code, and motions to try on them; shared by all rooms' tests."""

from __future__ import annotations

import runpy
from functools import cache
from pathlib import Path

import numpy as np
import pyvista


def grid(nx: int = 8, ny: int = 8, dx: float = 1.0, dy: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Flat open rectangle of nx by ny cells in the plane z = 0, facing +z."""
    x, y = np.meshgrid(np.arange(nx + 1) * dx, np.arange(ny + 1) * dy, indexing="ij")
    V = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    i, j = (k.ravel() for k in np.meshgrid(np.arange(nx), np.arange(ny), indexing="ij"))
    a = i * (ny + 1) + j
    b, c, d = a + ny + 1, a + ny + 2, a + 1
    return V, np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def box(nx: int = 2, ny: int = 2, nz: int = 6) -> tuple[np.ndarray, np.ndarray]:
    """Closed surface of the box [0, nx] x [0, ny] x [0, nz], unit cells, facing outwards."""
    V, F = [], []
    sizes = np.array([nx, ny, nz])
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        flat, faces = grid(sizes[u], sizes[v])
        for side, oriented in ((0, faces[:, ::-1]), (sizes[axis], faces)):
            X = np.empty_like(flat)
            X[:, axis], X[:, u], X[:, v] = side, flat[:, 0], flat[:, 1]
            F.append(oriented + sum(map(len, V)))
            V.append(X)
    V, inverse = np.unique(np.vstack(V), axis=0, return_inverse=True)
    return V, inverse.ravel()[np.vstack(F)]


def box_with_openings() -> tuple[np.ndarray, np.ndarray]:
    """Box [0, 4] x [0, 5] x [0, 10] with a hole at x = 0 from z = 3, and one at x = 4 from z = 6."""
    V, F = box(4, 5, 10)
    y, z = np.floor(V[F].mean(axis=1)[:, 1:]).T
    is_hole = (y == 2) & ((V[F, 0] == 0).all(axis=1) & (z == 3) | (V[F, 0] == 4).all(axis=1) & (z == 6))
    return V, F[~is_hole]


def sphere(subdivisions: int = 2) -> tuple[np.ndarray, np.ndarray]:
    """Unit icosphere, closed, facing outwards; all angles are acute."""
    g = (1 + 5**0.5) / 2
    V = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g)]
    V += [(0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    F = "0 11 5 0 5 1 0 1 7 0 7 10 0 10 11 1 5 9 5 11 4 11 10 2 10 7 6 7 1 8"
    F += " 3 9 4 3 4 2 3 2 6 3 6 8 3 8 9 4 9 5 2 4 11 6 2 10 8 6 7 9 8 1"
    V, F = np.array(V) / np.hypot(1, g), np.array(F.split(), dtype=np.int64).reshape(-1, 3)
    for _ in range(subdivisions):
        edges, inverse = np.unique(
            np.sort(F[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)), axis=0, return_inverse=True
        )
        m = len(V) + inverse.reshape(-1, 3)
        V = np.vstack([V, V[edges].mean(axis=1)])
        V /= np.linalg.norm(V, axis=1, keepdims=True)
        a, b, c = F.T
        F = np.vstack(
            [
                np.column_stack(t)
                for t in ((a, *m[:, [0, 2]].T), (m[:, 0], b, m[:, 1]), (m[:, 2], m[:, 1], c), m.T)
            ]
        )
    return V, F


def tube(around: int = 12, along: int = 16, *, height: float | None = None, shear: float = 0.0):
    """Open tube of radius 1 about the z axis, facing outwards.

    Rings are staggered and, unless a ``height`` is given, so far apart that the triangles are
    equilateral (all angles acute). ``shear`` turns each ring further against the one below, in
    units of the edge length: at 0.8 the triangles are obtuse.
    """
    edge = 2 * np.sin(np.pi / around)
    # A staggered neighbour is half a step around: its chord fills part of the edge.
    rise = np.sqrt(edge**2 - (2 * np.sin(np.pi / around / 2)) ** 2) if height is None else height / along
    ring, k = (x.ravel() for x in np.meshgrid(np.arange(along + 1), np.arange(around), indexing="ij"))
    angle = 2 * np.pi / around * (k + (0.5 + shear) * ring)
    V = np.column_stack([np.cos(angle), np.sin(angle), rise * ring])
    below = ring < along
    i, k = ring[below], k[below]
    a, b = i * around + k, i * around + (k + 1) % around
    c, d = a + around, b + around
    return V, np.vstack([np.column_stack([a, b, c]), np.column_stack([b, d, c])])


def can(around: int = 48, height: float = 2.0) -> tuple[np.ndarray, np.ndarray]:
    """Closed cylinder of radius 1 along z, with rings of triangles in its flat ends."""
    rows = max(2, round(height * around / (2.0 * np.pi)))
    rings = max(2, around // 6)
    inner = np.arange(1, rings) / rings
    radius = np.concatenate([inner, np.ones(rows + 1), inner[::-1]])
    level = np.concatenate(
        [np.zeros(rings - 1), np.linspace(0.0, height, rows + 1), np.full(rings - 1, height)]
    )
    turn = 2.0 * np.pi * (np.arange(around) + 0.5 * (np.arange(len(radius)) % 2)[:, None]) / around
    V = np.stack(
        [radius[:, None] * np.cos(turn), radius[:, None] * np.sin(turn), 0 * turn + level[:, None]], axis=2
    )
    V = np.vstack([V.reshape(-1, 3), [[0.0, 0.0, 0.0], [0.0, 0.0, height]]])
    F, n = [], len(radius)
    for k in range(n - 1):
        for i in range(around):
            a, b = k * around + i, k * around + (i + 1) % around
            c, d = a + around, b + around
            F += [(a, b, d), (a, d, c)] if k % 2 else [(a, b, c), (b, d, c)]
    for i in range(around):
        j = (i + 1) % around
        F += [(n * around, j, i), (n * around + 1, (n - 1) * around + i, (n - 1) * around + j)]
    return V, np.array(F)


def rabbit(subdivisions: int = 3) -> tuple[np.ndarray, np.ndarray]:
    """Ball with two ears, a dent and two holes, one in front and one below: no side is like another."""
    V, F = sphere(subdivisions)
    size = np.ones(len(V))
    for height, *at in ((0.7, 0.45, 0.85, -0.1), (0.6, -0.5, 0.8, 0.2), (-0.25, 0.7, 0.0, 0.7)):
        size += height * np.exp(-9.0 * ((V - at / np.linalg.norm(at)) ** 2).sum(axis=1))
    middle = V[F].mean(axis=1)
    open_at = np.array([[-0.5, -0.3, 0.8], [0.3, -0.95, 0.1]])
    open_at /= np.linalg.norm(open_at, axis=1, keepdims=True)
    F = F[(middle @ open_at.T < [0.96, 0.93]).all(axis=1)]
    kept, F = np.unique(F, return_inverse=True)
    return (V * size[:, None] * [1.0, 0.9, 0.8])[kept], F.reshape(-1, 3)


def cup(around: int = 32, wall: float = 0.05) -> tuple[np.ndarray, np.ndarray]:
    """Closed surface of a cup about the y axis with a thin wall, of radius 1 and height 1.5."""
    side, inner = np.linspace(0.0, 1.5, 10), 1.0 - wall
    out = [(r, 0.0) for r in (0.4, 0.7)] + [(1.0, y) for y in side]
    into = [(inner, y) for y in np.linspace(1.5, wall, 10)] + [(r, wall) for r in (0.7, 0.4)]
    turn = 2 * np.pi / around * np.arange(around)
    rings = [np.column_stack([r * np.sin(turn), np.full(around, y), r * np.cos(turn)]) for r, y in out + into]
    V = np.vstack([*rings, [[0.0, 0.0, 0.0], [0.0, wall, 0.0]]])
    k, after = np.arange(around), (np.arange(around) + 1) % around
    F = [np.column_stack([np.full(around, len(V) - 2), after, k])]
    for i in range(0, around * (len(rings) - 1), around):
        F += [np.column_stack([i + k, i + after, i + around + after])]
        F += [np.column_stack([i + k, i + around + after, i + around + k])]
    last = around * (len(rings) - 1)
    return V, np.vstack([*F, np.column_stack([last + k, last + after, np.full(around, len(V) - 1)])])


def character(step: float = 0.12) -> tuple[np.ndarray, np.ndarray]:
    """Closed body along y with a head on top, two arms along x and two legs, 6 high."""
    limbs = (
        ((0.0, 0.0, 0.0), (0.0, 2.0, 0.0), 0.55),
        ((0.0, 2.5, 0.0), (0.0, 3.2, 0.0), 0.5),
        *(((0.5 * side, 1.9, 0.0), (2.8 * side, 1.9, 0.0), 0.24) for side in (1, -1)),
        *(((0.3 * side, -0.2, 0.0), (0.45 * side, -2.2, 0.0), 0.28) for side in (1, -1)),
    )
    low, high = np.array([-3.3, -2.8, -0.9]), np.array([3.3, 4.0, 0.9])
    volume = pyvista.ImageData(
        dimensions=np.ceil((high - low) / step).astype(int) + 1, spacing=(step,) * 3, origin=low
    )
    points, near = np.asarray(volume.points), 0.0
    for start, end, radius in limbs:
        a, way = np.array(start), np.subtract(end, start)
        t = np.clip((points - a) @ way / (way @ way), 0.0, 1.0)
        near = near + np.exp(-12.0 * (np.linalg.norm(points - a - t[:, None] * way, axis=1) - radius))
    volume["outside"] = -np.log(near)
    surface = volume.contour([0.0], scalars="outside").clean().smooth_taubin(n_iter=20, pass_band=0.1)
    return np.array(surface.points, dtype=float), np.array(surface.regular_faces)[:, ::-1]


def soup(V: np.ndarray, F: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same surface with three vertices of its own for every triangle, as in an STL file."""
    return V[F].reshape(-1, 3), np.arange(F.size).reshape(-1, 3)


def ends(V: np.ndarray, axis: int = 2) -> tuple[np.ndarray, np.ndarray]:
    """Base and handle: the vertices at the lower and at the upper end of an axis."""
    x = V[:, axis]
    margin = 1e-9 * np.ptp(x)
    return np.flatnonzero(x <= x.min() + margin), np.flatnonzero(x >= x.max() - margin)


def rotation(axis, angle: float) -> np.ndarray:
    """Rotation matrix about ``axis`` by ``angle`` radians [Rodrigues]."""
    x, y, z = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def moved(X: np.ndarray, R=None, shift=(0.0, 0.0, 0.0)) -> np.ndarray:
    """Points turned by ``R`` about their centroid, then shifted."""
    centre = X.mean(axis=0)
    return (X - centre) @ (np.eye(3) if R is None else R).T + centre + np.asarray(shift)


def sample_bottle(edge: float = 1.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The sample bottle with edges so many times as long, and its labels."""
    V, F, labels = _made_bottle(edge)
    return V.copy(), F.copy(), labels.copy()


@cache
def _made_bottle(edge: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    script = runpy.run_path(str(Path(__file__).parents[2] / "resources" / "make_samples.py"))
    sizes = script["bottle"].__globals__
    sizes["BOTTLE_EDGE"] *= edge
    sizes["NECK_EDGE"] *= edge
    V, F = script["bottle"]()
    return V, F, script["bottle_labels"](V)
