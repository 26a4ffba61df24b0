"""Decimation of a mesh, with a map from each vertex to coarse ones."""

from typing import NamedTuple

import fast_simplification
import numpy as np
from scipy.spatial import KDTree

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.mesh.arrays import used_vertices
from apd_viewer.geometry.mesh.edges_and_components import join, root
from apd_viewer.geometry.mesh.operators import face_areas

# Coarse neighbours per fine vertex in the prolongation.
_NEAREST = 4
# Weight of normals in distances, in edge lengths, to separate opposite sides of a thin wall.
_ACROSS = 2.0
# Held vertices farther than this from all held coarse vertices, in coarse edges, become coarse ones.
_UNHEARD = 1.5
# Twice the area of a triangle over the squares of its edges, up to which it is a line.
_FLAT = 1e-4
# Clusters per vertex of the decimated mesh, and fewest vertices per cluster for which clustering pays.
_CLUSTERS, _LEAST = 8, 2
# Grid cells that a surface meets, times the square of their side, over its area: mean over all directions.
_CELLS = 1.5


class Decimation(NamedTuple):
    """Decimated mesh, with the coarse neighbours and weights of each fine vertex.

    Attributes
    ----------
    vertices : (c,) int array
        Ids, ascending.
    F : (k, 3) int array
        Triangles, by the places of their corners among ``vertices``.
    coarse_neighbours : (n, 4) int32 array
        By their places among ``vertices``.
    weight : (n, 4) float array
        Rows sum to one, or to zero where the thinned mesh has nothing of the piece.
    edge_length : float
        Mean length of the edges.
    """

    vertices: np.ndarray
    F: np.ndarray
    coarse_neighbours: np.ndarray
    weight: np.ndarray
    edge_length: float

    @property
    def nearest(self) -> np.ndarray:
        """The nearest coarse vertex of each fine one, (n,); -1 if there is none."""
        best = self.weight.argmax(axis=1)[:, None]
        has_one = np.take_along_axis(self.weight, best, axis=1) > 0.0
        return np.where(has_one, np.take_along_axis(self.coarse_neighbours, best, axis=1), -1)[:, 0]


def decimated_mesh(V: np.ndarray, F: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Decimated mesh with about ``count`` of the vertices (n, 3).

    Returns
    -------
    vertices : (c,) int array
        Ids, ascending.
    triangles : (k, 3) int array
        By the places of their corners among ``vertices``.
    """
    proper = F[(F[:, 0] != F[:, 1]) & (F[:, 1] != F[:, 2]) & (F[:, 2] != F[:, 0])]
    if len(proper) <= 2 * count:  # few enough triangles already, or disconnected ones
        vertices, T = np.unique(proper, return_inverse=True)
        return vertices, T.reshape(-1, 3)
    own = None
    if len(proper) > 2 * _LEAST * _CLUSTERS * count:
        vertices, clusters = clustered_mesh(V, proper, _CLUSTERS * count)
        if len(clusters) > 2 * count:  # little is left of a small part beside large triangles
            own, proper, V = vertices, clusters, V[vertices]
    origin = V[proper[:, 0]].mean(axis=0)
    points, triangles = fast_simplification.simplify(
        (V - origin).astype(np.float32), proper.astype(np.int32), target_count=2 * count
    )
    used, triangles = np.unique(triangles, return_inverse=True)
    # Coarse vertices are snapped to mesh vertices, so that held ones need no interpolation.
    nearest = KDTree(V - origin).query(points[used])[1]
    vertices, merged = np.unique(nearest, return_inverse=True)
    T = merged[triangles.reshape(-1, 3)]
    T = T[(T[:, 0] != T[:, 1]) & (T[:, 1] != T[:, 2]) & (T[:, 2] != T[:, 0])]
    T = T[_have_area(V[vertices], T)]
    kept, T = np.unique(T, return_inverse=True)
    vertices = vertices[kept]
    return vertices if own is None else own[vertices], T.reshape(-1, 3)


def clustered_mesh(V: np.ndarray, F: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Mesh with a vertex for each part of the surface in a cell of a grid.

    It takes a fraction of the time of decimation, but the shapes of its triangles are poor. Two walls in a
    cell remain two, since a part is connected.

    Returns
    -------
    vertices : (c,) int array
        Ids, ascending; about ``count``, the nearest ones to the centre of each part.
    triangles : (k, 3) int array
        By the places of their corners among ``vertices``.
    """
    side = float(np.sqrt(_CELLS * face_areas(V, F).sum() / count))
    nearest = _cluster_centres(V, F, V[used_vertices(F)].min(axis=0), side)
    T = nearest[F]
    T = T[(T[:, 0] != T[:, 1]) & (T[:, 1] != T[:, 2]) & (T[:, 2] != T[:, 0])]
    vertices = used_vertices(T)
    number = np.empty(len(V), dtype=F.dtype)
    number[vertices] = np.arange(len(vertices))
    return vertices, number[T]


@njit(cache=True, nogil=True)
def _cluster_centres(V: np.ndarray, F: np.ndarray, lowest: np.ndarray, side: float) -> np.ndarray:
    """Central vertex of each vertex's part of the surface in its cell, (n,)."""
    n = V.shape[0]
    cell = np.floor((V - lowest) / side)
    part = np.arange(n)
    for t in range(F.shape[0]):
        for c in range(3):
            a, b = F[t, c], F[t, (c + 1) % 3]
            if cell[a, 0] == cell[b, 0] and cell[a, 1] == cell[b, 1] and cell[a, 2] == cell[b, 2]:
                join(part, a, b)
    centre, size = np.zeros((n, 3)), np.zeros(n)
    for v in range(n):
        part[v] = p = root(part, v)
        size[p] += 1.0
        for k in range(3):
            centre[p, k] += V[v, k]
    nearest, least = np.arange(n), np.full(n, np.inf)
    for v in range(n):
        p, square = part[v], 0.0
        for k in range(3):
            square += (V[v, k] - centre[p, k] / size[p]) ** 2
        if square < least[p]:
            nearest[p], least[p] = v, square
    for v in range(n):
        part[v] = nearest[part[v]]
    return part


def _have_area(X: np.ndarray, T: np.ndarray) -> np.ndarray:
    """Mask (k,) of the triangles ``T`` that are no lines.

    On a line cotangents have no bound, and a vertex turns without a cost: fine vertices would move with the
    rounding of such a coarse one, even at rest.
    """
    a, b, c = X[T].transpose(1, 0, 2)
    twice = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    squares = np.square([b - a, c - b, a - c]).sum(axis=(0, 2))
    return np.asarray(twice > _FLAT * squares)


def mean_edge_length(V: np.ndarray, F: np.ndarray) -> float:
    """Mean length of the edges of the triangles ``F`` (m, 3)."""
    return float(np.linalg.norm(V[F] - V[np.roll(F, -1, axis=1)], axis=2).mean())


def coarse_neighbours(
    V: np.ndarray, F: np.ndarray, component: np.ndarray, vertices: np.ndarray, edge_length: float
) -> tuple[np.ndarray, np.ndarray]:
    """Coarse neighbours of each vertex, on its own side of a thin wall.

    Parameters
    ----------
    V, F : (n, 3) float array, (m, 3) int array
    component : (n,) int array
        The connected piece of every vertex; there is no going with another one.
    vertices : (c,) int array
        Vertices of the decimated mesh.
    edge_length : float
        Mean length of its edges.

    Returns
    -------
    near : (n, 4) int32 array
        By their places among ``vertices``.
    weight : (n, 4) float array
        Rows sum to one, or to zero where the thinned mesh has nothing of the piece.
    """
    place = _places(V, F, _ACROSS * edge_length)
    distance, near = KDTree(place[vertices]).query(place, k=_NEAREST, workers=-1)
    weight = 1.0 / np.maximum(distance, 1e-3 * edge_length)
    weight[component[vertices[near]] != component[:, None]] = 0.0
    weight /= np.maximum(weight.sum(axis=1, keepdims=True), 1e-300)
    return near.astype(np.int32), weight


@njit(cache=True, nogil=True)
def _places(V: np.ndarray, F: np.ndarray, across: float) -> np.ndarray:
    """Positions, then unit normals times ``across``, (n, 6)."""
    place = np.zeros((len(V), 6))
    for t in range(len(F)):
        i, j, k = F[t, 0], F[t, 1], F[t, 2]
        ax, ay, az = V[j, 0] - V[i, 0], V[j, 1] - V[i, 1], V[j, 2] - V[i, 2]
        bx, by, bz = V[k, 0] - V[i, 0], V[k, 1] - V[i, 1], V[k, 2] - V[i, 2]
        x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        for v in (i, j, k):
            place[v, 3] += x
            place[v, 4] += y
            place[v, 5] += z
    for v in range(len(V)):
        length = np.sqrt(place[v, 3] ** 2 + place[v, 4] ** 2 + place[v, 5] ** 2)
        for axis in range(3):
            place[v, axis] = V[v, axis]
            if length > 0.0:
                place[v, 3 + axis] = across * (place[v, 3 + axis] / length)
    return place


def with_held_vertices(
    V: np.ndarray, component: np.ndarray, decimation: Decimation, is_held: np.ndarray
) -> np.ndarray:
    """Vertices of a decimated mesh, some of them replaced by nearby held vertices.

    Every held part thus has a vertex in the decimated mesh.

    Parameters
    ----------
    V : (n, 3) float array
    component : (n,) int array
        The connected piece of every vertex.
    decimation : Decimation
    is_held : (n,) bool array
    """
    vertices, fixed = decimation.vertices.copy(), np.flatnonzero(is_held)
    heard = vertices[is_held[vertices]]
    away = KDTree(V[heard]).query(V[fixed], workers=-1)[0] if len(heard) else np.full(len(fixed), np.inf)
    while len(fixed):
        same = np.isin(component[fixed], component[vertices[~is_held[vertices]]])
        farthest = int(np.argmax(np.where(same, away, 0.0)))
        if not same.any() or away[farthest] <= _UNHEARD * decimation.edge_length:
            break
        lonely = fixed[farthest]
        others = np.flatnonzero(~is_held[vertices] & (component[vertices] == component[lonely]))
        vertices[others[np.argmin(np.linalg.norm(V[vertices[others]] - V[lonely], axis=1))]] = lonely
        away = np.minimum(away, np.linalg.norm(V[fixed] - V[lonely], axis=1))
    return vertices
