"""Seams: boundary edges lying on others without being joined."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.mesh.arrays import mesh_size
from apd_viewer.geometry.mesh.edges_and_components import boundary_edges, opposite_half_edges
from apd_viewer.geometry.mesh.weld import MOST_EDGE_SHARE, SEAM_TOLERANCE, Weld, shortest_edge_lengths
from apd_viewer.language import trn

PAIRS_AT_ONCE = 1_000_000  # of boundary vertices and edges near each other, 100 bytes each
_MOST_PIECES = 32  # of an edge


class Seams(NamedTuple):
    """Unjoined boundary edges lying on others within :data:`SEAM_TOLERANCE`.

    Attributes
    ----------
    edges : (e, 2) int array
        Ends of those that a wider weld joins; vertices of the file.
    gap : float
        Largest distance that it joins across, mesh units.
    joints : (j,) int array
        Vertices inside boundary edges (T-junctions): there is no vertex to weld them to.
    """

    edges: np.ndarray
    gap: float
    joints: np.ndarray

    @classmethod
    def from_mesh(cls, V: np.ndarray, F: np.ndarray, weld: Weld, opposite: np.ndarray) -> Seams:
        """Seams of positions ``V`` (n, 3) and triangles ``F`` (m, 3) with their ``weld``.

        ``opposite`` (m, 3) are the :func:`.opposite_half_edges` of the welded triangles.
        """
        corners, n = weld.representative[F], len(V)
        edges = boundary_edges(corners, opposite)
        if not len(edges):
            return cls(edges, 0.0, edges[:, 0])
        wider = weld.with_seams(V, F, opposite)
        if len(wider.first) == len(weld.first):
            return cls(edges[:0], 0.0, _joints(V, edges, corners))
        onto = wider.representative
        ends, corners = np.sort(onto[edges], axis=1), onto[corners]
        left = np.sort(boundary_edges(corners, opposite_half_edges(corners, n)), axis=1)
        meets = ~np.isin(ends[:, 0] * n + ends[:, 1], left[:, 0] * n + left[:, 1])
        moved = edges[meets].ravel()
        gap = float(np.linalg.norm(V[moved] - V[onto[moved]], axis=1).max(initial=0.0))
        return cls(edges[meets], gap, _joints(V, left, corners))

    @property
    def weldable_sentence(self) -> str | None:
        """Sentence about the weldable boundary edges; None if there are none."""
        if not len(self.edges):
            return None
        said = trn(
            "{n:,} boundary edge lies on another without being joined (up to {gap:.3g} apart): the surface "
            "tears there; weld its seams.",
            "{n:,} boundary edges lie on others without being joined (up to {gap:.3g} apart): the surface "
            "tears there; weld its seams.",
            len(self.edges),
        )
        return said.format(n=len(self.edges), gap=self.gap)

    @property
    def unweldable_sentence(self) -> str | None:
        """Sentence about the T-junctions; None if there are none."""
        if not len(self.joints):
            return None
        said = trn(
            "{n:,} boundary vertex lies inside another boundary edge (T-junction): the surface tears there, "
            "there is no vertex to weld it to; export it with a vertex there.",
            "{n:,} boundary vertices lie inside other boundary edges (T-junctions): the surface tears there, "
            "and there is no vertex to weld them to; export it with vertices there.",
            len(self.joints),
        )
        return said.format(n=len(self.joints))

    @property
    def sentences(self) -> tuple[str, ...]:
        """Sentences about weldable edges and T-junctions, if there are any."""
        return tuple(filter(None, (self.weldable_sentence, self.unweldable_sentence)))


def _joints(V: np.ndarray, edges: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Vertices inside ``edges`` (b, 2), the boundary of the triangles ``corners``."""
    edges = edges[np.linalg.norm(V[edges[:, 1]] - V[edges[:, 0]], axis=1) > 0.0]  # lengths may underflow
    border = np.unique(edges)
    near = SEAM_TOLERANCE * mesh_size(V, corners)
    room = np.minimum(near, MOST_EDGE_SHARE * shortest_edge_lengths(V, edges)[border])
    pairs = [np.empty((0, 2), dtype=np.int64)]  # so that arrays can be joined even without edges
    for point, edge in _nearby_pairs(V, border, edges, float(room.max(initial=0.0))):
        a, along = V[edges[edge, 0]], V[edges[edge, 1]] - V[edges[edge, 0]]
        length = np.linalg.norm(along, axis=1)
        at = np.einsum("ij,ij->i", V[border[point]] - a, along) / length
        away = np.linalg.norm(V[border[point]] - a - (at / length)[:, None] * along, axis=1)
        inside = (away <= room[point]) & (at > room[point]) & (at < length - room[point])
        pairs.append(np.column_stack([point[inside], edge[inside]]))
    point, edge = np.concatenate(pairs).T
    triples = np.sort(np.column_stack([border[point], edges[edge]]), axis=1)
    # A vertex and an edge may belong to one sliver triangle of the mesh, which is no T-junction.
    own = set(map(tuple, np.sort(corners[np.isin(corners, border[point]).any(axis=1)], axis=1).tolist()))
    free = [tuple(three) not in own for three in triples.tolist()]
    return np.unique(border[point[np.array(free, dtype=bool)]])


def _nearby_pairs(
    V: np.ndarray, border: np.ndarray, edges: np.ndarray, near: float
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Portions of pairs (p,), (p,) of ``border`` vertices and ``edges`` nearby."""
    from scipy.spatial import KDTree  # imported here: slow, and most meshes have no boundary

    ends, points = V[edges], KDTree(V[border])
    half = 0.5 * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    # Edges are queried by size: the search radius of long ones would find too many vertices near short ones.
    size = np.frexp(half)[1]
    for each in np.unique(size):
        some = np.flatnonzero(size == each)
        longest = half[some].max()
        count = points.count_neighbors(KDTree(ends[some].mean(axis=1)), longest + near)
        # Loose parts in one place are all near each other, but few are near a short piece of an edge.
        pieces = int(np.clip(np.sqrt(count / PAIRS_AT_ONCE), 1.0, _MOST_PIECES))
        share = ((np.arange(pieces) + 0.5) / pieces)[:, None]
        middles = ((1.0 - share) * ends[some, None, 0] + share * ends[some, None, 1]).reshape(-1, 3)
        owner, reach = np.repeat(some, pieces), longest / pieces + near
        portion = np.cumsum(points.query_ball_point(middles, reach, return_length=True)) // PAIRS_AT_ONCE
        for part in np.split(np.arange(len(owner)), np.flatnonzero(np.diff(portion)) + 1):
            found = points.sparse_distance_matrix(KDTree(middles[part]), reach, output_type="ndarray")
            yield found["i"], owner[part[found["j"]]]
