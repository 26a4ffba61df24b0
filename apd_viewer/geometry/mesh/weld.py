"""Welding: map between file vertices and solve vertices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from apd_viewer.geometry.mesh.arrays import diagonal, frozen

# Boundary vertices closer than this, in bounding-box diagonals, are welded.
TOLERANCE = 1e-7


@dataclass(frozen=True, eq=False)
class Weld:
    """Map of file vertices at one position to one vertex of the solve.

    Files repeat vertices at texture seams, and STL repeats all of them: without welding such a mesh falls
    apart into loose triangles. Equal positions are joined; at borders, where rounding leaves cracks, also
    those within :data:`TOLERANCE` of each other.

    Attributes
    ----------
    first : (k,) int array
        For every vertex of the solve the first file vertex at its position.
    inverse : (n,) int array
        For every file vertex its vertex of the solve.
    offset : (n, 3) float array or None
        How far every file vertex lies from the position that it is joined at; None if nowhere.
    """

    first: np.ndarray
    inverse: np.ndarray
    offset: np.ndarray | None = None

    @classmethod
    def of(cls, V: np.ndarray, F: np.ndarray | None = None) -> Weld:
        """Weld positions ``V`` (n, 3) in file order; ``F`` (m, 3) gives borders."""
        order = np.lexsort((np.arange(len(V)), V[:, 2], V[:, 1], V[:, 0]))
        new = np.ones(len(V), dtype=bool)
        new[1:] = (V[order[1:]] != V[order[:-1]]).any(axis=1)
        leader = order[np.flatnonzero(new)[np.cumsum(new) - 1]]
        representative = np.empty(len(V), dtype=np.int64)
        representative[order] = leader
        if F is not None:
            representative = _cracks_closed(V, F, representative)
        first, inverse = np.unique(representative, return_inverse=True)
        return cls.between(V, first, inverse)

    @classmethod
    def between(cls, V: np.ndarray, first: np.ndarray, inverse: np.ndarray) -> Weld:
        """The weld with these maps of the positions ``V`` (n, 3)."""
        first, inverse = frozen(first), frozen(inverse)
        if len(first) == len(inverse):
            return cls(first, inverse)
        offset = V - V[first[inverse]]
        return cls(first, inverse, frozen(offset) if offset.any() else None)

    @property
    def slack(self) -> float:
        """Tolerance between targets of welded vertices, in box diagonals."""
        return 0.0 if self.offset is None else 4.0 * TOLERANCE

    def offset_of(self, ids: np.ndarray) -> np.ndarray | float:
        """Offset of the file vertices ``ids`` from their welded positions."""
        return 0.0 if self.offset is None else self.offset[ids]

    def everywhere(self, ids: np.ndarray) -> np.ndarray:
        """File vertices ``ids`` with all others at their positions, ascending."""
        if len(self.first) == len(self.inverse):
            return ids
        covered = np.zeros(len(self.first), dtype=bool)
        covered[self.inverse[ids]] = True
        return np.flatnonzero(covered[self.inverse])

    def spread(self, U: np.ndarray) -> np.ndarray:
        """Positions ``U`` (k, 3) of solve vertices spread to the file's, (n, 3)."""
        if len(U) == len(self.inverse):
            return U.copy()
        spread = U[self.inverse]
        return spread if self.offset is None else spread + self.offset


def _cracks_closed(V: np.ndarray, F: np.ndarray, representative: np.ndarray) -> np.ndarray:
    """Representatives joining border vertices across cracks; neighbours stay apart."""
    corners = representative[F]
    a, b = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    edge = a != b
    key = np.minimum(a, b)[edge] * len(V) + np.maximum(a, b)[edge]
    key.sort()
    alone = np.ones(len(key), dtype=bool)
    alone[1:] &= key[1:] != key[:-1]
    alone[:-1] &= key[:-1] != key[1:]
    if not alone.any():
        return representative
    from scipy.spatial import KDTree  # most meshes have no cracks, and the window opens before it is loaded

    border = np.unique(np.concatenate([key[alone] // len(V), key[alone] % len(V)]))
    near = TOLERANCE * diagonal(V[corners.ravel()])
    pairs = border[np.sort(KDTree(V[border]).query_pairs(near, output_type="ndarray"), axis=1)]
    pairs = pairs[~np.isin(pairs[:, 0] * len(V) + pairs[:, 1], key)]
    joined = representative.copy()
    for low, high in pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))].tolist():
        joined[high] = joined[low]
    return joined[representative]
