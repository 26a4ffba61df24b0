"""Turn of a surface from its base to a handle, counted with whole turns.

A triangle turns about its neighbour by the change of the angle at their common edge, and in its plane by the
changes of its own angles. Each of these is less than a whole turn of either sense, so that their sum along a
path counts whole turns, however coarse or crumpled the surface is.

The position of a handle does not distinguish a turn by 400 degrees from one by 40, but the surface does.
After passing through itself, it holds fewer whole turns than requested.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components, dijkstra
from scipy.spatial.transform import Rotation

from apd_viewer.geometry.mesh.edges_and_components import opposite_half_edges
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.geometry.pose.held_turn import LEAST_TURN, HeldTurn
from apd_viewer.geometry.pose.transforms import fitted_rotation, quaternion
from apd_viewer.geometry.pose.waypoint_path import (
    nearest_rotation,
    rotation_pose,
    rotation_vector,
    signed_angle_about,
)

# Doubled area over squared edges, below which a triangle has no normal.
_NO_AREA = 1e-9
# Cost of an edge without rotation, squared radians: keeps paths short where the surface is flat.
_EDGE = 1e-4
# Turns have a single axis if, for the tilt of their axis, 1 - cos(tilt / 2) is below this rounding level.
_ONE_AXIS = 1e-6
# Radians from half a turn within which both senses of rotation are equivalent.
_EITHER_WAY = 1e-6
# Radians: a handle farther from its requested rotation has been stopped by contact.
_THERE = math.radians(5.0)
_AT_REST = np.array([1.0, 0.0, 0.0, 0.0])


class RequestedTurn(NamedTuple):
    """Requested turn of a handle along its path, including whole turns.

    Attributes
    ----------
    axis : (3,) float array
    angle : float
        Radians, not negative.
    lifted : (4,) float array
        Unit quaternion that follows the poses without a jump of sign; its negative is one turn away.
    has_one_axis : bool
        Whether all its rotations have the same axis.
    """

    axis: np.ndarray
    angle: float
    lifted: np.ndarray
    has_one_axis: bool

    @classmethod
    def from_poses(cls, poses: Sequence[np.ndarray]) -> RequestedTurn:
        """Turn along poses (4, 4), from one to the next by the shortest rotation."""
        vector = rotation_vector(poses[:-1], poses[-1]) if poses else np.zeros(3)
        angle = float(np.linalg.norm(vector))
        axis, q, clear = vector / (angle or 1.0), _AT_REST, 1.0
        rotations = [np.eye(3), *(nearest_rotation(pose) for pose in poses)]
        for before, after in itertools.pairwise(rotations):
            q = quaternion_product(quaternion(after @ before.T), q)
            clear = min(clear, math.hypot(q[0], q[1:] @ axis))
        return cls(axis, angle, q, clear > 1.0 - _ONE_AXIS)


class SurfaceTurns:
    """Rotations of a shape's triangles relative to the base.

    The angle of a rotation about an axis is determined up to whole turns, unless the rotation reverses the
    axis (swing and twist). So the sum along a path does not depend on the path, as long as no triangle on it
    reverses the axis.

    Parameters
    ----------
    V, U : (n, 3) float array
        Positions before the turns, and the shape.
    F : (m, 3) int array
    labels : (n,) int array of BASE, FREE, and HANDLE + k
    """

    def __init__(self, V: np.ndarray, U: np.ndarray, F: np.ndarray, labels: np.ndarray) -> None:
        F = F[(triangle_quality(V, F) > _NO_AREA) & (triangle_quality(U, F) > _NO_AREA)].astype(np.int64)
        self._held = labels[F]
        used = np.bincount(F.ravel(), minlength=len(V)) > 0
        parts = {k: np.flatnonzero(used & (labels == k)) for k in (BASE, *range(HANDLE, labels.max() + 1))}
        self._rotations = {k: fitted_rotation(V[part], U[part]) for k, part in parts.items()}
        if (base := self._rotations[BASE]) is None:
            return
        self._pairs = TriangleTurns.from_shapes(V, U @ base, F, labels)
        inside = self._is_inside(BASE)
        for k in range(HANDLE, labels.max() + 1):
            inside |= self._is_inside(k)
        i, j = self._pairs.faces.T
        outside = ~(inside[i] | inside[j])
        arms = sp.csr_array((outside[outside], (i[outside], j[outside])), shape=2 * (len(F),))
        self._arm = np.where(inside, -1, connected_components(arms, directed=False)[1])

    def _is_inside(self, label: int) -> np.ndarray:
        return (self._held == label).all(axis=1)

    def _end_triangles(self, label: int) -> np.ndarray:
        """Triangles ending the paths to a part: all within it, or else the nearest."""
        corners = (self._held == label).sum(axis=1)
        return np.flatnonzero((corners > 0) & (corners == corners.max(initial=0)))

    def turn(self, k: int, requested: RequestedTurn) -> float | None:
        """Turn of handle ``k`` about its requested axis, radians; None if unknown."""
        base, end = self._rotations[BASE], self._rotations.get(HANDLE + k)
        if base is None or end is None:
            return None
        last = quaternion(base.T @ end)
        made, jumps, arm = self._path_turns(HANDLE + k, requested.axis, last)
        held = [
            self._arm_turn(requested, made[arm == each], jumps[arm == each], last) for each in np.unique(arm)
        ]
        known = [each for each in held if each is not None]
        return max(known, key=lambda each: abs(each - requested.angle), default=None)

    def _arm_turn(
        self, requested: RequestedTurn, made: np.ndarray, jumps: np.ndarray, last: np.ndarray
    ) -> float | None:
        """Turn held by an arm, from the sums (a,) of turns and of sign jumps along it."""
        if requested.has_one_axis:
            held = float(np.median(made))
            return abs(held) if abs(requested.angle - math.pi) < _EITHER_WAY else held
        # About varying axes two whole turns amount to none [the belt trick], and one is a sign jump.
        likeness = float(last @ requested.lifted) * (-1.0 if np.median(jumps % 2) else 1.0)
        if abs(likeness) < math.cos(_THERE / 2.0):
            return None
        return requested.angle if likeness > 0.0 else requested.angle - 2.0 * math.pi

    def _path_turns(
        self, label: int, axis: np.ndarray, last: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Turns and sign jumps (a,) along the cheapest paths to a part, and their arms."""
        pairs, start, ends = self._pairs, self._end_triangles(BASE), self._end_triangles(label)
        own = self._is_inside(label)
        step, clear = pairs.turns_about(axis)
        i, j = pairs.faces.T
        # Arms that meet only along a row of the part's vertices are separate.
        goes = ~((pairs.end_labels == label).all(axis=1) & ~own[i] & ~own[j])
        cost = ((step**2 + _EDGE) / np.maximum(clear, _EDGE) ** 2)[goes]
        i, j, step, jump = i[goes], j[goes], step[goes], pairs.has_jump[goes]
        closed = np.zeros(len(self._held), dtype=bool)
        closed[ends] = True
        rows, columns, costs = np.concatenate([i, j]), np.concatenate([j, i]), np.concatenate([cost, cost])
        leaves = ~closed[rows]
        graph = sp.csr_array((costs[leaves], (rows[leaves], columns[leaves])), shape=2 * (len(closed),))
        _, before, _ = dijkstra(graph, indices=start, min_only=True, return_predecessors=True)
        values = np.zeros((len(closed), 2))
        for a, b, sign in ((i, j, 1.0), (j, i, -1.0)):
            follows = before[b] == a
            values[b[follows]] = np.column_stack([sign * step, jump])[follows]
        first = shortest_turns(np.broadcast_to(_AT_REST, (len(start), 4)), pairs.q[start], axis)
        values[start] = np.column_stack(first)
        reached = ends[before[ends] >= 0]
        made, jumps = _ancestor_sums(values, before)[reached].T
        more, jumped = shortest_turns(pairs.q[reached], np.broadcast_to(last, (len(reached), 4)), axis)
        arm = np.where(self._arm[reached] < 0, self._arm[before[reached]], self._arm[reached])
        return made + more, jumps + jumped, arm


def _ancestor_sums(values: np.ndarray, before: np.ndarray) -> np.ndarray:
    """Sums of the values (n, k) of each tree node and all its ancestors."""
    n = len(values)
    sums = np.vstack([values, np.zeros(values.shape[1])])
    last = np.append(np.where(before >= 0, before, n), n)
    while (last < n).any():  # pointer jumping: twice as far in each round
        sums += sums[last]
        last = last[last]
    return sums[:n]


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
        """Axes of the frames as columns, (m, 3, 3)."""
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
        True where the last of them is the negative of the quaternion of the second triangle.
    """

    q: np.ndarray
    faces: np.ndarray
    end_labels: np.ndarray
    intermediate_rotations: tuple[np.ndarray, ...]
    has_jump: np.ndarray

    @classmethod
    def from_shapes(cls, V: np.ndarray, U: np.ndarray, F: np.ndarray, labels: np.ndarray) -> TriangleTurns:
        """Pairs of triangles, with their turns from ``V`` (n, 3) to ``U`` (n, 3)."""
        rest, now = TriangleAxes.from_positions(V, F), TriangleAxes.from_positions(U, F)
        R = np.einsum("mij,mkj->mik", now.matrices, rest.matrices)
        q = np.roll(Rotation.from_matrix(R).as_quat(), 1, axis=1) if len(F) else np.zeros((0, 4))
        opposite = opposite_half_edges(F, len(V)).ravel()
        h = np.flatnonzero(opposite > np.arange(len(opposite)))
        (s, c), (t, d) = np.divmod(h, 3), np.divmod(opposite[h], 3)
        in_plane = now.angles - rest.angles
        way = [q[s]]
        way.append(_quaternion_products(_rotation_quaternions(now.normal[s], in_plane[s, c]), way[-1]))
        same = F[s, c] == F[t, d]
        edge, bent = (
            now.edge(s, c),
            _dihedral_angle(now, s, c, t, same) - _dihedral_angle(rest, s, c, t, same),
        )
        way.append(_quaternion_products(_rotation_quaternions(edge, bent), way[-1]))
        way.append(_quaternion_products(_rotation_quaternions(now.normal[t], -in_plane[t, d]), way[-1]))
        ends = labels[np.column_stack([F[s, c], F[s, (c + 1) % 3]])]
        return cls(q, np.column_stack([s, t]), ends, tuple(way), _dots(way[-1], q[t]) < 0.0)

    def turns_about(self, axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Turn (p,) about ``axis`` (3,) across each triangle pair, and how definite it is.

        The second array (p,) is 1 for turns about the axis itself, and 0 for half turns about a perpendicular
        axis, where the turn is undefined.
        """
        points = [(q[:, 0], q[:, 1:] @ axis) for q in self.intermediate_rotations]
        angles = [np.arctan2(along, w) for w, along in points]
        # The half-angle follows the ellipse of (w, component along the axis): it changes by less than 180
        # degrees for a turn below 360 degrees.
        steps = [_wrapped_angle(after - before) for before, after in itertools.pairwise(angles)]
        clear = np.min([np.hypot(w, along) for w, along in points], axis=0)
        return 2.0 * np.sum(steps, axis=0), clear


def _dihedral_angle(
    frames: TriangleAxes, s: np.ndarray, c: np.ndarray, t: np.ndarray, same: np.ndarray
) -> np.ndarray:
    """Dihedral angle at edge ``c`` (k,) from ``s`` to ``t``, flipped where ``same``."""
    n, other = frames.normal[s], np.where(same[:, None], -1.0, 1.0) * frames.normal[t]
    angle: np.ndarray = np.arctan2(_dots(frames.edge(s, c), np.cross(n, other)), _dots(n, other))
    return angle


def shortest_turns(p: np.ndarray, q: np.ndarray, axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Shortest turns (k,) about an axis from quaternions ``p`` to ``q``; sign changes."""
    jump = _dots(p, q) < 0.0
    q = np.where(jump[:, None], -q, q)
    before, after = (np.arctan2(each[:, 1:] @ axis, each[:, 0]) for each in (p, q))
    return 2.0 * _wrapped_angle(after - before), jump


def triangle_quality(X: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Doubled area of the triangles over the sum of their squared edges, (m,)."""
    edges = X[np.roll(F, -1, axis=1)] - X[F]
    area, squares = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1), (edges**2).sum(axis=(1, 2))
    return np.divide(area, squares, out=np.zeros(len(F)), where=squares > 0.0)


def _rotation_quaternions(axis: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Unit quaternions (k, 4) of rotations about axes (k, 3)."""
    return np.column_stack([np.cos(angle / 2), np.sin(angle / 2)[:, None] * axis])


def _quaternion_products(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Quaternions (k, 4) of the rotations ``q`` followed by ``p``."""
    w = p[:, 0] * q[:, 0] - _dots(p[:, 1:], q[:, 1:])
    return np.column_stack([w, p[:, :1] * q[:, 1:] + q[:, :1] * p[:, 1:] + np.cross(p[:, 1:], q[:, 1:])])


def quaternion_product(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Quaternion (4,) of the rotation ``q`` followed by ``p``."""
    found: np.ndarray = _quaternion_products(p[None], q[None])[0]
    return found


def _wrapped_angle(angle: np.ndarray) -> np.ndarray:
    """Angle wrapped to the range from -pi to pi."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def _unit(X: np.ndarray) -> np.ndarray:
    return X / np.linalg.norm(X, axis=1)[:, None]


def _dots(X: np.ndarray, Y: np.ndarray) -> np.ndarray:
    found: np.ndarray = np.einsum("...i,...i->...", X, Y)
    return found


# Relative to the coordinates: closer centres define no line.
_APART = 1e-9


def held_turns(
    V: np.ndarray, U: np.ndarray, F: np.ndarray, labels: np.ndarray, paths: Sequence[Sequence[np.ndarray]]
) -> tuple[HeldTurn, ...]:
    """Turn of each handle in the shape ``U``.

    Where several arms of free surface lead to a handle, that counts which holds least of what was asked.

    Parameters
    ----------
    V, U : (n, 3) float array
        Positions before the turns, and the shape; of vertices at one place only one is named by ``F``.
    F : (m, 3) int array
    labels : (n,) int array of BASE, FREE, and HANDLE + k
    paths : sequence of sequences of (4, 4) float arrays
        Of each handle: its poses against the base, one after another, and from one to the next by the
        shortest rotation; none where it is not known.
    """
    requested = [RequestedTurn.from_poses(poses) for poses in paths]
    turned = any(way.angle >= LEAST_TURN for way in requested)
    looks = turned and (labels == BASE).any() and np.isfinite(U).all()
    surface = SurfaceTurns(V, U, F, labels) if looks else None
    turns = []
    for k, way in enumerate(requested):
        held = surface.turn(k, way) if surface and way.angle >= LEAST_TURN else None
        sign = math.copysign(1.0, signed_angle_about(way.axis, _base_to_handle(V, labels, k))[0])
        turns.append(HeldTurn(sign * way.angle, None if held is None else sign * held))
    return tuple(turns)


def relative_paths(X: np.ndarray, positions: np.ndarray, labels: np.ndarray) -> list[list[np.ndarray]]:
    """Path of each handle relative to the base, as rotations (4, 4); empty if unknown.

    Parameters
    ----------
    X : (k, 3) float array
        Places of what is held.
    positions : (s, k, 3) float array
        Positions along the path, in order.
    labels : (k,) int array of BASE, and HANDLE + k
    """
    base = _rotations(X, positions, labels == BASE)
    handles = [_rotations(X, positions, labels == k) for k in range(HANDLE, labels.max(initial=BASE) + 1)]
    return [[rotation_pose(b.T @ h) for b, h in zip(base, rotations, strict=False)] for rotations in handles]


def _rotations(X: np.ndarray, positions: np.ndarray, mask: np.ndarray) -> list[np.ndarray]:
    """Rotation of a part at each stop; none if its points determine no rotation."""
    found = [fitted_rotation(X[mask], there[mask]) for there in positions]
    return [R for R in found if R is not None]


def _base_to_handle(V: np.ndarray, labels: np.ndarray, k: int) -> np.ndarray:
    """Vector (3,) from the centre of the base to handle ``k``; zero if undefined."""
    base, handle = labels == BASE, labels == HANDLE + k
    if not (base.any() and handle.any()):
        return np.zeros(3)
    line: np.ndarray = V[handle].mean(axis=0) - V[base].mean(axis=0)
    return line if np.abs(line).max() > _APART * np.abs(V).max() else np.zeros(3)
