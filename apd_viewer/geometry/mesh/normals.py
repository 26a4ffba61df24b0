"""Vertex normals, and normals of a file, rotated with the surface."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.mesh.arrays import frozen

_LONGEST = 1e30  # the square of a longer vector would overflow


class CornerNormals(NamedTuple):
    """Normals at triangle corners, rotating with the triangles.

    Attributes
    ----------
    group : (m, 3) int32 array
        Corners with one normal have one number.
    local : (m, 3, 3) float32 array
        The unit normals in the frames of their triangles at rest: along the first edge, across it, and the
        triangle's normal; zero at triangles without area.
    """

    group: np.ndarray
    local: np.ndarray

    @classmethod
    def from_normals(
        cls, N: np.ndarray, normal_of: np.ndarray, V: np.ndarray, F: np.ndarray
    ) -> CornerNormals | None:
        """Corner normals from ``N`` (k, 3) and the row of each corner in it, (m, 3).

        Without one, or with one that has no direction, a corner has the normal of its triangle. None if no
        corner has one.
        """
        with np.errstate(all="ignore"):
            length = np.linalg.norm(N, axis=1, keepdims=True)
            good = (np.abs(N) < _LONGEST).all(axis=1) & (length[:, 0] > 0.0)
            unit = np.where(good[:, None], N / length, 0.0)
        has = (normal_of >= 0) & good[normal_of]
        if not has.any():
            return None
        local = unit[normal_of] @ triangle_frames(V[F]).transpose(0, 2, 1)
        local[~has] = 0.0, 0.0, 1.0
        own = len(N) + np.arange(F.size).reshape(F.shape)
        group = np.where(has, normal_of, own)
        return cls(frozen(group.astype(np.int32)), frozen(local.astype(np.float32)))


def vertex_normals(U: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Area-weighted unit normals of the vertices; zero without area.

    In NumPy: the first picture does not wait for a compiler.

    Parameters
    ----------
    U : (n, 3) float array
    F : (m, 3) int array

    Returns
    -------
    (n, 3) float array
    """
    a = U[F[:, 0]]
    across = np.cross(U[F[:, 1]] - a, U[F[:, 2]] - a)
    # Without triangles, bincount returns integers.
    sums = [np.bincount(F.ravel(), np.repeat(x, 3), len(U)) for x in across.T]
    N = np.column_stack(sums).astype(float, copy=False)
    length = np.linalg.norm(N, axis=1, keepdims=True)
    normals: np.ndarray = np.divide(N, length, out=np.zeros_like(N), where=length > 0)
    return normals


def rotated_normals(
    V: np.ndarray, U: np.ndarray, F: np.ndarray, N: np.ndarray, normal_of: np.ndarray
) -> np.ndarray:
    """File normals rotated with their triangles; creases are kept.

    Parameters
    ----------
    V, U : (n, 3) float arrays
        Positions before and after.
    F : (m, 3) int array
    N : (k, 3) float array
    normal_of : (m, 3) int array
        Row of ``N`` for every corner; -1 is none.

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


def triangle_frames(corners: np.ndarray) -> np.ndarray:
    """Frame of each triangle: along its first edge, across it, and its normal.

    Parameters
    ----------
    corners : (m, 3, 3) float array
        Positions of the corners.

    Returns
    -------
    (m, 3, 3) float array
        Zero for a triangle without area.
    """
    along = corners[:, 1] - corners[:, 0]
    normal = _unit(np.cross(along, corners[:, 2] - corners[:, 0]))
    along = np.where(normal.any(axis=1, keepdims=True), _unit(along), 0.0)
    return np.stack([along, np.cross(normal, along), normal], axis=1)


def _unit(X: np.ndarray) -> np.ndarray:
    size = np.linalg.norm(X, axis=1, keepdims=True)
    return np.divide(X, size, out=np.zeros_like(X), where=size > 0.0)
