"""Shortest paths over a surface.

The shortest path along edges, and across them to the opposite corners, is straightened by flips of edges
until it is a geodesic of the polyhedron: exact up to rounding, with no error from the size of the triangles.
It is the shortest path among those homotopic to the first one.

Sharp & Crane, You can find geodesic paths in triangle meshes by just flipping edges, 2020.
"""

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from apd_viewer.errors import InputError
from apd_viewer.geometry.measuring.surface_point import SurfacePoint, point_positions
from apd_viewer.geometry.mesh.arrays import mesh_arrays
from apd_viewer.geometry.mesh.edges_and_components import opposite_half_edges, vertex_components
from apd_viewer.geometry.mesh.weld import Weld
from apd_viewer.language import tr

# Barycentric distance at which a point counts as a corner: slivers around it would spoil the angles.
_CORNER = 1e-6
_FEWEST_FLIPS = 1000  # limit of flips, beyond the number of triangles
_ROOM = 1e-9  # rounding tolerance relative to the length of the first path


def geodesic_path(
    V: np.ndarray, F: np.ndarray, start: SurfacePoint | int, end: SurfacePoint | int
) -> np.ndarray:
    """Shortest path over a surface between two of its points.

    Parameters
    ----------
    V : (n, 3) float array
        Positions.
    F : (m, 3) int array
        Triangles. The path may cross an edge of exactly two of them.
    start, end : SurfacePoint or int
        Points of triangles, or the numbers of vertices.

    Returns
    -------
    (k, 3) float array
        Corners of the path, ``start`` and ``end`` included; its length is that of the polyline.

    Raises
    ------
    InputError
        If no path joins the points, the surface is not orientable, or no triangle has the point.

    Examples
    --------
    >>> import apd_viewer
    >>> import numpy as np
    >>> V = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
    >>> path = apd_viewer.geodesic_path(V, np.array([[0, 1, 3], [1, 2, 3]]), 0, 2)
    >>> f"{np.linalg.norm(np.diff(path, axis=0), axis=1).sum():.4f}"
    '1.4142'
    """
    V, F = mesh_arrays(V, F)
    places = [p if isinstance(p, SurfacePoint) else SurfacePoint.at_vertex(F, p) for p in (start, end)]
    for point in places:
        point.check(F)
    F = Weld.from_positions(V, F).representative[F]  # coincident vertices are one place
    ends = point_positions(places, V, F)
    faces = [place.face for place in places]
    if faces[0] == faces[1] or np.array_equal(*ends):
        return ends
    V, F, corners = _mesh_with_points(V, F, places, ends)
    ids = [int(F[face, corner]) for face, corner in corners]
    first = _first_path(V, F, *ids)
    kept = _reachable_triangles(V, F, ends, path_length(V[first]))
    new = np.cumsum(kept) - 1
    G, old = manifold_pieces(F[kept], len(V))
    ids = [int(G[new[face], corner]) for face, corner in corners]
    return _straightened_path(V[old], G, old, first, ids)


def path_length(path: np.ndarray) -> float:
    """Length of a polyline (k, 3)."""
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())


def _mesh_with_points(
    V: np.ndarray, F: np.ndarray, places: Sequence[SurfacePoint], ends: np.ndarray
) -> tuple[np.ndarray, np.ndarray, list[tuple[int, int]]]:
    """Mesh with the points inserted as vertices, and a face and corner of each."""
    corners = []
    for place, end in zip(places, ends, strict=True):
        weights = np.array(place.weights)
        if weights.max() > 1.0 - _CORNER:
            corners.append((place.face, int(weights.argmax())))
            continue
        a, b, c = F[place.face]
        new = len(V)
        V, F = np.vstack([V, end]), np.vstack([F, [[b, c, new], [c, a, new]]])
        F[place.face] = a, b, new
        corners.append((place.face, 2))
    return V, F, corners


def _first_path(V: np.ndarray, F: np.ndarray, start: int, end: int) -> np.ndarray:
    """Vertices of the shortest path along edges and across pairs of triangles."""
    i, j = F.ravel(), np.roll(F, -1, axis=1).ravel()
    opposite = opposite_half_edges(F, len(V)).ravel()
    pairs = np.flatnonzero(opposite > np.arange(len(opposite)))
    p, q = (np.roll(F, -2, axis=1).ravel()[h] for h in (pairs, opposite[pairs]))
    across = _unfolded_distances(V[i[pairs]], V[j[pairs]], V[p], V[q])
    ends = np.sort(np.column_stack([np.append(i, p), np.append(j, q)]), axis=1)
    lengths = np.append(np.linalg.norm(V[i] - V[j], axis=1), across)
    usable = np.isfinite(lengths) & (ends[:, 0] != ends[:, 1])
    # Both triangles of an edge give the same pair, and csr_array would add up the two lengths.
    key = ends[:, 0] * len(V) + ends[:, 1]
    order = np.lexsort((lengths, key))
    order = order[usable[order]]
    order = order[np.diff(key[order], prepend=-1) != 0]
    graph = csr_array((lengths[order], (ends[order, 0], ends[order, 1])), shape=(len(V), len(V)))
    away, before = dijkstra(graph, directed=False, indices=start, return_predecessors=True)
    if not np.isfinite(away[end]):
        raise InputError(tr("The points are on separate parts of the surface; pick both on the same part."))
    path = [end]
    while path[-1] != start:
        path.append(int(before[path[-1]]))
    return np.array(path[::-1])


def _unfolded_distances(A: np.ndarray, B: np.ndarray, P: np.ndarray, Q: np.ndarray) -> np.ndarray:
    """Distances from P to Q across edges AB, unfolded; infinite if beside an edge."""
    edge = B - A
    long = np.linalg.norm(edge, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        along_p, along_q = (np.einsum("ij,ij->i", X - A, edge) / long for X in (P, Q))
        high_p, high_q = (
            np.linalg.norm(X - A - (along / long)[:, None] * edge, axis=1)
            for X, along in ((P, along_p), (Q, along_q))
        )
        meets = along_p + (along_q - along_p) * high_p / (high_p + high_q)
        crosses = (meets >= 0.0) & (meets <= long)
    return np.where(crosses, np.hypot(along_q - along_p, high_p + high_q), np.inf)


def _reachable_triangles(V: np.ndarray, F: np.ndarray, ends: np.ndarray, most: float) -> np.ndarray:
    """Mask (m,) of triangles within reach of a path of length ``most`` between ends."""
    detour = sum(np.linalg.norm(V - end, axis=1) for end in ends)
    T = V[F]
    longest = np.linalg.norm(T - np.roll(T, -1, axis=1), axis=2).max(axis=1)
    near: np.ndarray = detour[F].min(axis=1) - 2.0 * longest <= most * (1.0 + _ROOM)
    return near


def _straightened_path(
    V: np.ndarray, F: np.ndarray, old: np.ndarray, first: np.ndarray, ids: Sequence[int]
) -> np.ndarray:
    """Geodesic homotopic to the path through the vertices ``first``."""
    import potpourri3d  # Imported here: few runs of the program need it.

    # Vertices duplicated by a cut are left out: the path may pass them on either piece.
    copies = np.bincount(old, minlength=int(old.max()) + 1)
    inner = [v for v in first[1:-1] if copies[v] == 1]
    at = {int(v): k for k, v in enumerate(old)}
    through = [ids[0], *(at[int(v)] for v in inner), ids[1]]
    try:
        solver = potpourri3d.EdgeFlipGeodesicSolver(V, oriented_triangles(F, len(V)))
        # Where lengths round, some flips undo each other for ever. Others need about sqrt(m) of them.
        path: np.ndarray = solver.find_geodesic_path_poly(through, max_iterations=len(F) + _FEWEST_FLIPS)
    except RuntimeError:
        raise InputError(tr("No path over the surface joins the points; pick others.")) from None
    return path


def manifold_pieces(F: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Cut a surface along edges of three or more triangles, and at bow ties.

    Parameters
    ----------
    F : (m, 3) int array
    n : int
        Number of vertices.

    Returns
    -------
    G : (m, 3) int array
        The same triangles, corner by corner, with vertices of their own on each side of a cut.
    old : (k,) int array
        The vertex of ``F`` that each vertex of ``G`` was.
    """
    h, o, alike = _inner_edges(F, n)
    ahead_h, ahead_o = (each - each % 3 + (each + 1) % 3 for each in (h, o))
    joined = np.vstack(
        [
            np.column_stack([h, np.where(alike, o, ahead_o)]),
            np.column_stack([ahead_h, np.where(alike, ahead_o, o)]),
        ]
    )
    fan = vertex_components(joined[:, [0, 1, 1]], F.size)
    old = np.empty(int(fan.max()) + 1, dtype=np.int64)
    old[fan] = F.ravel()
    return fan.reshape(-1, 3), old


def oriented_triangles(F: np.ndarray, n: int) -> np.ndarray:
    """Flip triangles (m, 3) so that neighbours face the same side, if possible."""
    m, (h, o, alike) = len(F), _inner_edges(F, n)
    # Graph of each triangle and its flipped copy: connected nodes face the same side.
    s, t = h // 3, o // 3
    joined = np.vstack(
        [np.column_stack([s, np.where(alike, t + m, t)]), np.column_stack([s + m, np.where(alike, t, t + m)])]
    )
    side = vertex_components(joined[:, [0, 1, 1]], 2 * m)
    turned = side[:m] > side[m:]
    return np.where(turned[:, None], F[:, ::-1], F)


def _inner_edges(F: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Both half-edges of each inner edge, (e,) each, and whether they run in parallel."""
    opposite = opposite_half_edges(F, n).ravel().astype(np.int64)
    h = np.flatnonzero(opposite > np.arange(len(opposite)))
    o = opposite[h]
    return h, o, F.ravel()[h] == F.ravel()[o]
