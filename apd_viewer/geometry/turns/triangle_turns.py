"""Rotations from triangle to triangle, without a jump.

A triangle turns about its neighbour by the change of the angle at their common edge, and in its plane by the
changes of its own angles. Each of these is less than a whole turn of either sense, so that their sum over a
way counts whole turns, however coarse or crumpled the surface is.
"""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from apd_viewer.geometry.mesh.adjacency import opposite_half_edges


class TriangleAxes(NamedTuple):
    """Frames of triangles: first edges, normals, and angles of edges, (m, 3) each."""

    first: np.ndarray
    normal: np.ndarray
    angles: np.ndarray

    @classmethod
    def from_positions(cls, X: np.ndarray, F: np.ndarray) -> TriangleAxes:
        """Frames at the positions ``X`` (n, 3)."""
        edges = X[np.roll(F, -1, axis=1)] - X[F]
        normal = _unit(np.cross(edges[:, 0], edges[:, 1]))
        first = _unit(edges[:, 0])
        across = np.cross(normal, first)
        angles = np.arctan2(_dots(edges, across[:, None]), _dots(edges, first[:, None]))
        return cls(first, normal, angles)

    @property
    def matrices(self) -> np.ndarray:
        """Their axes as columns, (m, 3, 3)."""
        return np.stack([self.first, np.cross(self.normal, self.first), self.normal], axis=2)

    def edge(self, t: np.ndarray, c: np.ndarray) -> np.ndarray:
        """Unit vectors along the edges ``c`` (k,) of triangles ``t`` (k,)."""
        angle = self.angles[t, c][:, None]
        return np.cos(angle) * self.first[t] + np.sin(angle) * np.cross(self.normal[t], self.first[t])


class TriangleTurns(NamedTuple):
    """Pairs of neighbouring triangles, with the rotations from one to the other.

    Attributes
    ----------
    q : (m, 4) float array
        Rotation of each triangle, as a unit quaternion.
    faces : (p, 2) int array
    end_labels : (p, 2) int array
        Labels of the ends of their common edges.
    intermediate_rotations : tuple of four (p, 4) float arrays
        Quaternions from that of the first triangle to that of the second, without a jump.
    has_jump : (p,) bool array
        Whether the last of them is the other one of the second triangle.
    """

    q: np.ndarray
    faces: np.ndarray
    end_labels: np.ndarray
    intermediate_rotations: tuple[np.ndarray, ...]
    has_jump: np.ndarray

    @classmethod
    def from_shapes(cls, V: np.ndarray, U: np.ndarray, F: np.ndarray, labels: np.ndarray) -> TriangleTurns:
        """Pairs between ``V`` (n, 3) and ``U`` (n, 3)."""
        rest, now = TriangleAxes.from_positions(V, F), TriangleAxes.from_positions(U, F)
        R = np.einsum("mij,mkj->mik", now.matrices, rest.matrices)
        q = np.roll(Rotation.from_matrix(R).as_quat(), 1, axis=1) if len(F) else np.zeros((0, 4))
        opposite = opposite_half_edges(F, len(V)).ravel()
        h = np.flatnonzero(opposite > np.arange(len(opposite)))
        (s, c), (t, d) = np.divmod(h, 3), np.divmod(opposite[h], 3)
        in_plane = now.angles - rest.angles
        way = [q[s]]
        way.append(_products(_turning(now.normal[s], in_plane[s, c]), way[-1]))
        same = F[s, c] == F[t, d]
        edge, bent = now.edge(s, c), _hinge(now, s, c, t, same) - _hinge(rest, s, c, t, same)
        way.append(_products(_turning(edge, bent), way[-1]))
        way.append(_products(_turning(now.normal[t], -in_plane[t, d]), way[-1]))
        ends = labels[np.column_stack([F[s, c], F[s, (c + 1) % 3]])]
        return cls(q, np.column_stack([s, t]), ends, tuple(way), _dots(way[-1], q[t]) < 0.0)

    def turns_about(self, axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Turn about ``axis`` (3,) in each pair, (p,), and its clearness 0 to 1, (p,)."""
        points = [(q[:, 0], q[:, 1:] @ axis) for q in self.intermediate_rotations]
        angles = [np.arctan2(along, w) for w, along in points]
        # A turn by less than a whole one is half as much of an ellipse: less than a half of it.
        steps = [_wrapped(after - before) for before, after in itertools.pairwise(angles)]
        clear = np.min([np.hypot(w, along) for w, along in points], axis=0)
        return 2.0 * np.sum(steps, axis=0), clear


def _hinge(frames: TriangleAxes, s: np.ndarray, c: np.ndarray, t: np.ndarray, same: np.ndarray) -> np.ndarray:
    """Angle at the edge ``c`` (k,) from triangle ``s`` to ``t``, turned round or not."""
    n, other = frames.normal[s], np.where(same[:, None], -1.0, 1.0) * frames.normal[t]
    angle: np.ndarray = np.arctan2(_dots(frames.edge(s, c), np.cross(n, other)), _dots(n, other))
    return angle


def shortest_turns(p: np.ndarray, q: np.ndarray, axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Turn about an axis by the shortest way from ``p`` (k, 4) to ``q``, and jumps."""
    jump = _dots(p, q) < 0.0
    q = np.where(jump[:, None], -q, q)
    before, after = (np.arctan2(each[:, 1:] @ axis, each[:, 0]) for each in (p, q))
    return 2.0 * _wrapped(after - before), jump


def triangle_quality(X: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Doubled area of the triangles over the sum of their squared edges, (m,)."""
    edges = X[np.roll(F, -1, axis=1)] - X[F]
    area, squares = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1), (edges**2).sum(axis=(1, 2))
    return np.divide(area, squares, out=np.zeros(len(F)), where=squares > 0.0)


def _turning(axis: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Unit quaternions (k, 4) of rotations about axes (k, 3)."""
    return np.column_stack([np.cos(angle / 2), np.sin(angle / 2)[:, None] * axis])


def _products(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Quaternions (k, 4) of the rotations ``q`` and after them ``p``."""
    w = p[:, 0] * q[:, 0] - _dots(p[:, 1:], q[:, 1:])
    return np.column_stack([w, p[:, :1] * q[:, 1:] + q[:, :1] * p[:, 1:] + np.cross(p[:, 1:], q[:, 1:])])


def quaternion_product(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Quaternion (4,) of the rotation ``q`` and after it ``p``."""
    found: np.ndarray = _products(p[None], q[None])[0]
    return found


def _wrapped(angle: np.ndarray) -> np.ndarray:
    """The angle from -pi to pi."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def _unit(X: np.ndarray) -> np.ndarray:
    return X / np.linalg.norm(X, axis=1)[:, None]


def _dots(X: np.ndarray, Y: np.ndarray) -> np.ndarray:
    found: np.ndarray = np.einsum("...i,...i->...", X, Y)
    return found
