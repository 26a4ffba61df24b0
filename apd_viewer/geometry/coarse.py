"""A coarse copy of an elastic surface, which shows the fine one the way.

Low frequencies take iterations by the hundred on a fine mesh, and next to nothing on a coarse one. What is
handed over are rotations: how far each place of the coarse surface has turned since the last time. The
global step of the fine surface then carries all frequencies at once, and its details turn with it.
"""

from __future__ import annotations

from collections.abc import Callable

import fast_simplification
import numpy as np
from numba import njit, prange
from scipy.spatial import KDTree

from apd_viewer.geometry.constrained import Constrained
from apd_viewer.geometry.cores import cores_for
from apd_viewer.geometry.elastic import Elastic
from apd_viewer.geometry.goals import Goal
from apd_viewer.geometry.measures import Patch
from apd_viewer.geometry.operators import vertex_normals
from apd_viewer.geometry.rest_shape import RestShape

# A coarse mesh has so many times fewer vertices, and no more than it can be solved with in a blink.
_RATIO = 2.5
_MOST = 40_000
# Below this the coarsest mesh would no longer tell where the fine one goes.
FEWEST = 500
# Coarse vertices that a fine one turns with.
_NEAREST = 4
# The two sides of a thin wall are as far apart as their normals say: so many coarse edges.
_ACROSS = 2.0
# A held vertex so many coarse edges away from any that the coarse mesh holds needs one of its own.
_UNHEARD = 1.5


class Coarse:
    """A coarse surface with the same material, held where the fine one is.

    Its vertices are some of the fine one's, so that what is held needs no interpolation.

    Parameters
    ----------
    elastic : Elastic
        The fine surface.
    goals : tuple of Goal
    iterations_of : callable
        How a coarse surface is to be iterated.

    Attributes
    ----------
    vertices : (c,) int array
        The vertices of the fine surface that it has.
    """

    def __init__(
        self,
        elastic: Elastic,
        goals: tuple[Goal, ...],
        iterations_of: Callable[[Elastic, tuple[Goal, ...]], Constrained],
    ) -> None:
        rest, fixed = elastic.rest, elastic.fixed
        vertices, F = _thinned(rest.V, rest.F, int(np.clip(len(rest.V) / _RATIO, FEWEST, _MOST)))
        edge = _edge_length(rest.V[vertices], F)
        self.vertices = _with_held(rest.V, vertices, fixed, edge)
        self.F = F
        self._shape = RestShape(rest.V[self.vertices], F)
        held = np.flatnonzero(np.isin(self.vertices, fixed))
        self._which = np.searchsorted(fixed, self.vertices[held])
        self._elastic = Elastic(self._shape, held, elastic.material)
        self._method = iterations_of(self._elastic, self._own(goals))
        self._reference = self._elastic.q.copy()
        self._near, self._weight = self._neighbourhoods(rest, edge)

    @property
    def settled(self) -> bool:
        """Whether the coarse surface has nothing more to show."""
        return self._method.stuck or self._method.exhausted

    @property
    def is_guided(self) -> bool:
        """Whether it follows one that is coarser yet."""
        return type(self._method) is not Constrained

    def keep(self, goals: tuple[Goal, ...]) -> None:
        """Meet these goals of the fine surface from now on, as far as a coarse one can tell."""
        self._method.keep(self._own(goals))

    def restart(self, U: np.ndarray) -> None:
        """Continue from the positions ``U`` (n, 3) of the fine surface."""
        self._method.restart(U[self.vertices])
        self._reference = self._elastic.q.copy()

    def aim(self, targets: np.ndarray) -> None:
        """Hold the held vertices at the ``targets`` (k, 3) of the fine surface."""
        self._method.aim(targets[self._which])

    def turns(self, iterations: int) -> np.ndarray:
        """Go on for some iterations; how each fine vertex should turn for it, (n, 4) quaternions."""
        with cores_for(len(self.vertices)):
            for _ in range(iterations):
                if self.settled:
                    break
                self._method.descend()
        turned = _difference(self._elastic.q, self._reference)
        self._reference = self._elastic.q.copy()
        return _blended(turned, self._near, self._weight)

    def _own(self, goals: tuple[Goal, ...]) -> tuple[Goal, ...]:
        """The same goals for the coarse surface: the same percentages of what it measures at rest."""
        own = []
        place = np.full(int(self.vertices.max()) + 1, -1)
        place[self.vertices] = np.arange(len(self.vertices))
        for goal in goals:
            inside = np.zeros(len(self.vertices), dtype=bool)
            measured = np.unique(goal.patch.F)
            measured = measured[measured < len(place)]
            inside[place[measured][place[measured] >= 0]] = True
            patch = Patch(self.F[inside[self.F].all(axis=1)], len(self.vertices))
            if len(patch.F) and (
                at_rest := Goal(goal.name, patch, goal.is_volume, 1.0, 1.0).value(self._shape.V)
            ):
                own.append(Goal(goal.name, patch, goal.is_volume, at_rest, at_rest * goal.target / goal.rest))
        return tuple(own)

    def _neighbourhoods(self, rest: RestShape, edge: float) -> tuple[np.ndarray, np.ndarray]:
        """For every fine vertex the coarse ones that it turns with, (n, 4), and their weights."""
        normals = np.empty_like(rest.V)
        vertex_normals(rest.V, rest.F, normals)
        place = np.hstack([rest.V, _ACROSS * edge * normals])
        distance, near = KDTree(place[self.vertices]).query(place, k=_NEAREST, workers=-1)
        weight = 1.0 / np.maximum(distance, 1e-3 * edge)
        weight[rest.piece[self.vertices[near]] != rest.piece[:, None]] = 0.0
        weight /= np.maximum(weight.sum(axis=1, keepdims=True), 1e-300)
        return near.astype(np.int32), weight


def _thinned(V: np.ndarray, F: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Some of the vertices, (c,) ids, and triangles (k, 3) between them, by their places among these."""
    proper = F[(F[:, 0] != F[:, 1]) & (F[:, 1] != F[:, 2]) & (F[:, 2] != F[:, 0])]
    origin = V[proper[:, 0]].mean(axis=0)
    points, triangles = fast_simplification.simplify(
        (V - origin).astype(np.float32), proper.astype(np.int32), target_count=2 * count
    )
    used, triangles = np.unique(triangles, return_inverse=True)
    nearest = KDTree(V - origin).query(points[used])[1]
    vertices, merged = np.unique(nearest, return_inverse=True)
    T = merged[triangles.reshape(-1, 3)]
    T = T[(T[:, 0] != T[:, 1]) & (T[:, 1] != T[:, 2]) & (T[:, 2] != T[:, 0])]
    kept, T = np.unique(T, return_inverse=True)
    return vertices[kept], T.reshape(-1, 3)


def _edge_length(V: np.ndarray, F: np.ndarray) -> float:
    return float(np.linalg.norm(V[F] - V[np.roll(F, -1, axis=1)], axis=2).mean())


def _with_held(V: np.ndarray, vertices: np.ndarray, fixed: np.ndarray, edge: float) -> np.ndarray:
    """The vertices, some replaced by held ones, so that no held part is unheard of."""
    vertices = vertices.copy()
    while True:
        heard = vertices[np.isin(vertices, fixed)]
        away = KDTree(V[heard]).query(V[fixed])[0] if len(heard) else np.full(len(fixed), np.inf)
        farthest = int(np.argmax(away))
        if away[farthest] <= _UNHEARD * edge or len(heard) == len(vertices):
            return vertices
        open_ = np.flatnonzero(~np.isin(vertices, fixed))
        nearest = open_[np.argmin(np.linalg.norm(V[vertices[open_]] - V[fixed[farthest]], axis=1))]
        vertices[nearest] = fixed[farthest]


def _difference(q: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """``q`` times the inverse of ``reference``, both (c, 4) unit quaternions."""
    w, x, y, z = q.T
    a, b, c, d = reference[:, 0], -reference[:, 1], -reference[:, 2], -reference[:, 3]
    return np.column_stack(
        [
            w * a - x * b - y * c - z * d,
            w * b + x * a + y * d - z * c,
            w * c - x * d + y * a + z * b,
            w * d + x * c - y * b + z * a,
        ]
    )


@njit(cache=True, nogil=True, parallel=True)
def _blended(q: np.ndarray, near: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """For each row of ``near`` and ``weight`` (n, 4) the weighted mean of the quaternions ``q`` (c, 4)."""
    out = np.empty((len(near), 4))
    for i in prange(len(near)):
        w = x = y = z = 0.0
        for k in range(near.shape[1]):
            j, share = near[i, k], weight[i, k]
            # q and -q are one rotation: that on the side of the first counts.
            f = near[i, 0]
            side = q[f, 0] * q[j, 0] + q[f, 1] * q[j, 1] + q[f, 2] * q[j, 2] + q[f, 3] * q[j, 3]
            share = share if side >= 0.0 else -share
            w += share * q[j, 0]
            x += share * q[j, 1]
            y += share * q[j, 2]
            z += share * q[j, 3]
        length = np.sqrt(w * w + x * x + y * y + z * z)
        if length > 0.0:
            out[i, 0], out[i, 1], out[i, 2], out[i, 3] = w / length, x / length, y / length, z / length
        else:
            out[i, 0], out[i, 1], out[i, 2], out[i, 3] = 1.0, 0.0, 0.0, 0.0
    return out
