"""Vertices without a face, carried along by the nearest surface."""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from apd_viewer.geometry.mesh.triangle_frames import triangle_frames


class UnreferencedVertices:
    """Unreferenced vertices, fastened to the nearest triangle.

    Parameters
    ----------
    V : (n, 3) float array, rest positions
    F : (m, 3) int array, triangles
    loose : (l,) int array
        Vertices of none of them.
    """

    def __init__(self, V: np.ndarray, F: np.ndarray, loose: np.ndarray) -> None:
        corners = V[F]
        frames = triangle_frames(corners)
        good = np.flatnonzero(frames.any(axis=(1, 2)))  # degenerate triangles have no frame to fasten to
        self._loose, self._V = loose, V
        self._corners = F[good[KDTree(corners[good].mean(axis=1)).query(V[loose])[1]]]
        at = V[self._corners]
        self._local = np.einsum("lij,lj->li", triangle_frames(at), V[loose] - at[:, 0])

    def carried(self, U: np.ndarray, held: np.ndarray) -> np.ndarray:
        """``U`` (n, 3) with these vertices carried along, except ``held`` ones."""
        at = U[self._corners]
        gone = (at != self._V[self._corners]).any(axis=(1, 2)) & ~np.isin(self._loose, held)
        out = U.copy()
        beside = np.einsum("lij,li->lj", triangle_frames(at[gone]), self._local[gone])
        out[self._loose[gone]] = at[gone, 0] + beside
        return out
