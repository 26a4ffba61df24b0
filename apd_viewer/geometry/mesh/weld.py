"""Welding: the map between file vertices and solve vertices."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from apd_viewer.geometry.mesh.arrays import frozen, mesh_size

# Boundary vertices closer than this, in bounding-box diagonals, are welded.
WELD_TOLERANCE = 1e-7

# Tolerance for welding seams on request: exporters round to four or five digits.
SEAM_TOLERANCE = 1e-4

# Rounding tolerance for held vertices, in bounding-box diagonals.
_IN_PLACE = 1e-9

# Largest gap to weld, as a fraction of the shorter boundary edge there; keeps neighbours separate.
MOST_EDGE_SHARE = 0.5


@dataclass(frozen=True, eq=False)
class Weld:
    """Map from coincident file vertices to one vertex of the welded solve mesh.

    Files repeat vertices at texture seams, and STL repeats all of them: without welding such a mesh falls
    apart into loose triangles. Equal positions are joined; at borders, where rounding leaves cracks, also
    those within a tolerance of each other, and within half of the shorter boundary edge there. The solve has
    them at the place of the first; in the file they keep their offsets from it, which do not turn.

    Attributes
    ----------
    first : (k,) int array
        First file vertex at the position of each solve vertex.
    inverse : (n,) int array
        Solve vertex of each file vertex.
    V : (n, 3) float array or None
        Positions of the file; None if every vertex lies where it is joined.
    """

    first: np.ndarray
    inverse: np.ndarray
    V: np.ndarray | None = None

    @classmethod
    def from_positions(
        cls, V: np.ndarray, F: np.ndarray | None = None, tolerance: float = WELD_TOLERANCE
    ) -> Weld:
        """Weld positions ``V`` (n, 3) in file order, with the borders of ``F`` (m, 3).

        The ``tolerance`` is that of borders, in bounding-box diagonals.
        """
        representative = _representatives_of_positions(V)
        if F is not None:
            # Imported here, as numba takes long to load.
            from apd_viewer.geometry.mesh.edges_and_components import opposite_half_edges

            corners = representative[F]
            opposite = opposite_half_edges(corners, len(V))
            onto = _representatives_across_cracks(V, corners, opposite, tolerance)
            if onto is not None:
                return cls.from_representatives(V, onto[representative])
        return cls(*_maps(representative))

    @classmethod
    def from_representatives(cls, V: np.ndarray, representative: np.ndarray) -> Weld:
        """Weld each of the positions ``V`` (n, 3) to its representative."""
        return cls.from_maps(V, *_maps(representative))

    def with_seams(self, V: np.ndarray, F: np.ndarray, opposite: np.ndarray) -> Weld:
        """The weld, also joining boundaries within :data:`SEAM_TOLERANCE`.

        ``opposite`` (m, 3) are the :func:`.opposite_half_edges` of the welded triangles.
        """
        corners = self.representative[F]
        onto = _representatives_across_cracks(V, corners, opposite, SEAM_TOLERANCE)
        return self if onto is None else Weld.from_representatives(V, onto[self.representative])

    @classmethod
    def from_maps(cls, V: np.ndarray, first: np.ndarray, inverse: np.ndarray) -> Weld:
        """Weld of the positions ``V`` (n, 3) from both index maps."""
        first, inverse = frozen(first), frozen(inverse)
        if len(first) == len(inverse):
            return cls(first, inverse)
        return cls(first, inverse, V if (V[first[inverse]] != V).any() else None)

    @property
    def representative(self) -> np.ndarray:
        """Representative of each file vertex, the first vertex welded to it, (n,)."""
        return self.first[self.inverse]

    @cached_property
    def offset(self) -> np.ndarray | None:
        """Offset of each file vertex from its welded position, (n, 3); None if all are 0."""
        return None if self.V is None else frozen(self.V - self.V[self.representative])

    @cached_property
    def target_tolerance(self) -> float:
        """Tolerance between the targets of vertices welded together, mesh units."""
        return 0.0 if self.offset is None else 4.0 * float(np.linalg.norm(self.offset, axis=1).max())

    def in_place_tolerance(self, diagonal: float) -> float:
        """Distance from its target within which a held vertex is in place, mesh units."""
        return _IN_PLACE * diagonal + self.target_tolerance

    def offset_of(self, ids: np.ndarray) -> np.ndarray | float:
        """Offset of the file vertices ``ids`` from their welded positions."""
        return 0.0 if self.offset is None else self.offset[ids]

    def with_coincident_vertices(self, ids: np.ndarray) -> np.ndarray:
        """File vertices ``ids`` and all others at their positions, ascending."""
        if len(self.first) == len(self.inverse):
            return ids
        covered = np.zeros(len(self.first), dtype=bool)
        covered[self.inverse[ids]] = True
        return np.flatnonzero(covered[self.inverse])

    def to_file_vertices(self, U: np.ndarray) -> np.ndarray:
        """Positions (n, 3) of the file vertices, from those of solve vertices (k, 3)."""
        if len(U) == len(self.inverse):
            return U.copy()
        spread = U[self.inverse]
        if self.V is not None and self.offset is not None:
            apart = np.flatnonzero(self.offset.any(axis=1))
            # This order of operations restores unmoved vertices bit for bit.
            spread[apart] = self.V[apart] + (spread[apart] - self.V[self.representative[apart]])
        return spread


def _maps(representative: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First vertices (k,), and the place of each vertex's representative among them."""
    is_first = np.zeros(len(representative), dtype=bool)
    is_first[representative] = True
    return frozen(np.flatnonzero(is_first)), frozen((np.cumsum(is_first) - 1)[representative])


def _representatives_of_positions(V: np.ndarray) -> np.ndarray:
    """Lowest vertex at the position of each vertex of ``V`` (n, 3), (n,)."""
    key = _position_keys(V)
    order = np.argsort(key)
    representative = _lowest_of_runs(order, key[order][:, None])
    if not np.array_equal(V[representative], V):  # two positions share a key
        order = np.lexsort(V.T)
        representative = _lowest_of_runs(order, V[order])
    return representative


def _position_keys(V: np.ndarray) -> np.ndarray:
    """Hash keys (n,) of the positions ``V`` (n, 3), equal for equal ones."""
    key = np.zeros(len(V), dtype=np.uint64)
    for x in V.T:
        key ^= (x + 0.0).view(np.uint64)  # adding zero makes a negative zero positive
        key *= np.uint64(0x9E3779B97F4A7C15)  # odd and irregular: multiplicative hashing [Knuth 1973]
        key ^= key >> np.uint64(32)
    return key


def _lowest_of_runs(order: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Lowest vertex (n,) of each one's run of equal ``rows`` (n, k) in ``order`` (n,)."""
    is_first = np.ones(len(order), dtype=bool)
    is_first[1:] = False
    for x in rows.T:
        is_first[1:] |= x[1:] != x[:-1]
    lowest = np.empty(len(order), dtype=np.int64)
    lowest[order] = np.minimum.reduceat(order, np.flatnonzero(is_first))[np.cumsum(is_first) - 1]
    return lowest


def _edge_keys(corners: np.ndarray, n: int) -> np.ndarray:
    """Key of the undirected edge of each half-edge."""
    a, b = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    edge = a != b
    return np.minimum(a, b)[edge] * n + np.maximum(a, b)[edge]


def _representatives_across_cracks(
    V: np.ndarray, corners: np.ndarray, opposite: np.ndarray, tolerance: float
) -> np.ndarray | None:
    """Representatives (n,) of border vertices across cracks; None without cracks.

    Neighbours in the triangles ``corners`` (m, 3) are never joined.
    """
    # Imported here, as numba takes long to load.
    from apd_viewer.geometry.mesh.edges_and_components import boundary_edges

    edges, n = boundary_edges(corners, opposite), len(V)
    if not len(edges):
        return None
    from scipy.spatial import KDTree  # imported here: slow, and most meshes have no cracks

    border, most = np.unique(edges), MOST_EDGE_SHARE * shortest_edge_lengths(V, edges)
    # A far part makes the mesh large, and all vertices of a small one would be near each other.
    reach = min(tolerance * mesh_size(V, corners), float(most[border].max()))
    pairs = border[KDTree(V[border]).query_pairs(reach, output_type="ndarray")]
    gap = np.linalg.norm(V[pairs[:, 0]] - V[pairs[:, 1]], axis=1)
    room = most[pairs].min(axis=1)
    pairs, gap = pairs[gap <= room], gap[gap <= room]
    if not len(pairs):
        return None
    at_border = np.zeros(n, dtype=bool)
    at_border[border] = True
    between = _edge_keys(corners[np.count_nonzero(at_border[corners], axis=1) > 1], n)
    return _cluster_leaders(pairs[np.argsort(gap, kind="stable")], set(between.tolist()), n)


def shortest_edge_lengths(V: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Length of the shortest of ``edges`` (b, 2) at each vertex, (n,)."""
    shortest = np.full(len(V), np.inf)
    length = np.linalg.norm(V[edges[:, 0]] - V[edges[:, 1]], axis=1)
    for end in edges.T:
        np.minimum.at(shortest, end, length)
    return shortest


def _cluster_leaders(pairs: np.ndarray, edges: set[int], n: int) -> np.ndarray:
    """Lowest vertex in the cluster of each of ``n`` vertices.

    ``pairs`` (p, 2) are joined in their order, unless an edge would then lead from a cluster to itself: of a
    chain of near vertices the two ends of an edge stay apart.
    """
    leader, members = list(range(n)), dict[int, list[int]]()
    for a, b in pairs.tolist():
        low, high = leader[a], leader[b]
        if low == high:
            continue
        low, high = min(low, high), max(low, high)
        one, other = members.get(low, [low]), members.get(high, [high])
        if not any(min(i, j) * n + max(i, j) in edges for i in one for j in other):
            members[low] = one + other
            for i in other:
                leader[i] = low
    return np.array(leader)
