"""Cotangent weights and Laplacians."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.mesh.operators import boundary_vertices, vertex_neighbours


@njit(cache=True, nogil=True)
def cotangents(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Cotangents of the corner angles, (m, 3); 0 in triangles without area."""
    cot = np.zeros(F.shape)
    for t in range(F.shape[0]):
        for c in range(3):
            i, j, k = F[t, c], F[t, (c + 1) % 3], F[t, (c + 2) % 3]
            ax, ay, az = V[j, 0] - V[i, 0], V[j, 1] - V[i, 1], V[j, 2] - V[i, 2]
            bx, by, bz = V[k, 0] - V[i, 0], V[k, 1] - V[i, 1], V[k, 2] - V[i, 2]
            x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
            double_area = np.sqrt(x * x + y * y + z * z)
            if double_area > 0.0:
                cot[t, c] = (ax * bx + ay * by + az * bz) / double_area
    return cot


# Connects vertices left unconnected by clamped weights, too weakly to be visible in the shape.
_WEIGHT_FLOOR = 1e-6


# Slivers: a weight this large is rigid to eight digits; a larger one would cost the others their digits.
_STEEPEST = 1e8


# Squared cotangents leave half the digits.
_NEEDLE = 1e4


def well_shaped(cot: np.ndarray) -> np.ndarray:
    """Mask (m,) of the triangles that are no needles, by their cotangents (m, 3)."""
    size = np.abs(cot)
    return (size.max(axis=1) < _NEEDLE) & (size.sum(axis=1) > 0.0)


def _opposite(F: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Edge opposite to every corner, in scipy's index type."""
    return F[:, [1, 2, 0]].ravel().astype(np.int32), F[:, [2, 0, 1]].ravel().astype(np.int32)


def edge_weights(V: np.ndarray, F: np.ndarray) -> sp.csr_array:
    """Symmetric matrix ``w_ij = (max(0, cot a_ij) + max(0, cot b_ij)) / 2``.

    Each cotangent is clamped by itself, as CGAL does; clamping the sum gives another energy. Where
    clamping cuts a connected piece apart (needles, obtuse fans), the edges between the parts get a
    weight that is tiny, or the Laplacian of the piece would be singular.

    Returns
    -------
    (n, n) csr_array
        Zero diagonal; every edge of the mesh is stored, also those of weight zero.
    """
    n = len(V)
    cot = np.clip(cotangents(V, F), 0.0, _STEEPEST)
    i, j = _opposite(F)
    w = 0.5 * cot.ravel()
    edge = i != j
    i, j, w = i[edge], j[edge], w[edge]
    W = sp.coo_array((np.concatenate([w, w]), (np.concatenate([i, j]), np.concatenate([j, i]))), shape=(n, n))
    W = W.tocsr()
    W.sort_indices()
    positive = W.copy()
    positive.eliminate_zeros()
    part = sp.csgraph.connected_components(positive, directed=False)[1]
    row = np.repeat(np.arange(n), np.diff(W.indptr))
    # The median: one sliver would dominate the mean.
    usual = np.median(positive.data) if positive.nnz else 1.0
    W.data[part[row] != part[W.indices]] = _WEIGHT_FLOOR * usual
    return W


def laplacian(W: sp.csr_array) -> sp.csr_array:
    """Positive semi-definite Laplacian ``L_ij = -w_ij`` of the weights ``W`` (n, n)."""
    return (sp.diags_array(W.sum(axis=1)) - W).tocsr()


def element_laplacian(cot: np.ndarray, F: np.ndarray, n: int) -> sp.csr_array:
    """Laplacian (n, n) assembled from corner values ``cot`` (m, 3) of ``F``."""
    w = 0.5 * cot.ravel()
    i, j = _opposite(F)
    W = sp.coo_array((np.concatenate([w, w]), (np.concatenate([i, j]), np.concatenate([j, i]))), shape=(n, n))
    return laplacian(W.tocsr())


# Vertices on a cylinder, triangulated anyhow, have defects of both signs, 0.46 in total. So many steps of
# averaging leave 0.02 of them, and 1.0 of a tube whose vertices are off by a hundredth of its radius.
_STEPS = 30


def total_curvature(V: np.ndarray, F: np.ndarray) -> float:
    """Integral of the absolute Gauss curvature, of its means over neighbourhoods.

    4 pi for every convex closed surface, 0 for tubes, sheets and whatever else can be unrolled. The borders
    of an open surface do not count.

    Parameters
    ----------
    V : (n, 3) float array
        One for each vertex: those at one position are joined.
    F : (m, 3) int array, triangles
    """
    n, cot = len(V), cotangents(V, F)
    angles = np.where(well_shaped(cot)[:, None], np.arctan2(1.0, cot), 0.0)
    around = np.bincount(F.ravel(), angles.ravel(), n)
    defect = np.where(around > 0.0, 2.0 * np.pi - around, 0.0)
    defect[boundary_vertices(F, n)] = 0.0
    start, neighbour = vertex_neighbours(F, n)
    count = np.diff(start)
    handed = sp.csr_array((np.repeat(1.0 / np.maximum(count, 1), count), neighbour, start), shape=(n, n)).T
    for _ in range(_STEPS):
        defect = 0.5 * (defect + handed @ defect)
    return float(np.abs(defect).sum())
