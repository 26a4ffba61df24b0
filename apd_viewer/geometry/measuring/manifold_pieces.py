"""Any triangles as oriented manifold pieces."""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry.mesh.adjacency import opposite_half_edges
from apd_viewer.geometry.mesh.components import vertex_components


def manifold_pieces(F: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Cut a surface open along edges of three triangles and more, and at bow ties.

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
    h, o, alike = _neighbours(F, n)
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
    """Turn triangles (m, 3) over: neighbours face the same side, if possible."""
    m, (h, o, alike) = len(F), _neighbours(F, n)
    # Each triangle twice, as it is and turned over; what is joined faces the same side.
    s, t = h // 3, o // 3
    joined = np.vstack(
        [np.column_stack([s, np.where(alike, t + m, t)]), np.column_stack([s + m, np.where(alike, t, t + m)])]
    )
    side = vertex_components(joined[:, [0, 1, 1]], 2 * m)
    turned = side[:m] > side[m:]
    return np.where(turned[:, None], F[:, ::-1], F)


def _neighbours(F: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Half-edges of each inner edge, (e,) each, and their equality of direction."""
    opposite = opposite_half_edges(F, n).ravel().astype(np.int64)
    h = np.flatnonzero(opposite > np.arange(len(opposite)))
    o = opposite[h]
    return h, o, F.ravel()[h] == F.ravel()[o]
