"""Normals of a file, turned with the surface."""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry.mesh.triangle_frames import triangle_frames


def turned_normals(
    V: np.ndarray, U: np.ndarray, F: np.ndarray, N: np.ndarray, normal_of: np.ndarray
) -> np.ndarray:
    """Normals turned by the rotation of their triangles; creases are kept.

    Parameters
    ----------
    V, U : (n, 3) float arrays
        Positions before and after.
    F : (m, 3) int array
    N : (k, 3) float array
    normal_of : (m, 3) int array
        Which of ``N`` every corner uses; -1 is none.

    Returns
    -------
    (k, 3) float array
        As long as those of ``N``; bit for bit the same where no triangle has moved.
    """
    moved = (U != V).any(axis=1)[F].any(axis=1)
    corners = (normal_of >= 0) & moved[:, None]
    t, c = np.nonzero(corners)
    if not len(t):
        return N
    before, after = triangle_frames(V[F]), triangle_frames(U[F])
    which = normal_of[t, c]
    local = np.einsum("tij,tj->ti", before[t], N[which])
    turned = np.einsum("tji,tj->ti", after[t], local)
    edges = U[F[t, 1]] - U[F[t, 0]], U[F[t, 2]] - U[F[t, 0]]
    weight = np.linalg.norm(np.cross(*edges), axis=1)
    sums = np.column_stack(
        [np.bincount(which, weights=weight * turned[:, axis], minlength=len(N)) for axis in range(3)]
    )
    size = np.linalg.norm(sums, axis=1)
    good = size > 0.0
    out = N.copy()
    out[good] = sums[good] * (np.linalg.norm(N[good], axis=1) / size[good])[:, None]
    return out
