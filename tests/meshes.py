"""Meshes made in code, and motions to try on them; shared by all rooms' tests."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np


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
    script = runpy.run_path(str(Path(__file__).parents[1] / "resources" / "make_samples.py"))
    sizes = script["bottle"].__globals__
    sizes["BOTTLE_EDGE"] *= edge
    sizes["NECK_EDGE"] *= edge
    V, F = script["bottle"]()
    return V, F, script["bottle_labels"](V)
