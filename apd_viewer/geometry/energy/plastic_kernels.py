"""Kernels of bending that yields; see :mod:`plastic_bending`."""

from __future__ import annotations

import numpy as np
from numba import prange

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.quaternions import rotated_vector
from apd_viewer.geometry.linalg.threads import parallel


@parallel(fastmath={"contract"})
def change_sizes(
    start: np.ndarray,
    corner: np.ndarray,
    weight: np.ndarray,
    inverse: np.ndarray,
    mean: np.ndarray,
    normals: np.ndarray,
    creased: np.ndarray,
    kept: np.ndarray,
    D: np.ndarray,
    q: np.ndarray,
    means: np.ndarray,
    sizes: np.ndarray,
) -> None:
    """Write ``means`` (n, 3, 3) of ``D_t`` and ``sizes`` (n,) of changes of all rings."""
    for i in prange(len(mean)):
        d = np.zeros((3, 3))
        for e in range(start[i], start[i + 1]):
            t, c = corner[e] // 3, corner[e] % 3
            share = inverse[i] * weight[t, c]
            for a in range(3):
                for b in range(3):
                    d[a, b] += share * D[t, a, b]
        means[i] = d
        own = 0.0
        for e in range(start[i], start[i + 1]):
            t, c = corner[e] // 3, corner[e] % 3
            for b in range(3):
                x, y, z = _target(mean, normals, creased, kept, i, t, c, b)
                x, y, z = rotated_vector(q, i, x, y, z)
                own += weight[t, c] * (
                    (D[t, 0, b] - d[0, b] - x) ** 2
                    + (D[t, 1, b] - d[1, b] - y) ** 2
                    + (D[t, 2, b] - d[2, b] - z) ** 2
                )
        sizes[i] = np.sqrt(own)


@njit(inline="always")
def _target(
    mean: np.ndarray,
    normals: np.ndarray,
    creased: np.ndarray,
    kept: np.ndarray,
    i: int,
    t: int,
    c: int,
    b: int,
) -> tuple[float, float, float]:
    """Column ``b`` of ``mean_i(n n^T) - n_t n_t^T``, adjusted for creases."""
    n = normals[t, b]
    x, y, z = mean[i, 0, b], mean[i, 1, b], mean[i, 2, b]
    x, y, z = x - n * normals[t, 0], y - n * normals[t, 1], z - n * normals[t, 2]
    if creased[i]:
        x, y, z = x + kept[t, c, 0, b], y + kept[t, c, 1, b], z + kept[t, c, 2, b]
    return x, y, z


@parallel(fastmath={"contract"})
def moments(
    start: np.ndarray,
    corner: np.ndarray,
    weight: np.ndarray,
    mean: np.ndarray,
    creased: np.ndarray,
    kept: np.ndarray,
    D: np.ndarray,
    scale: np.ndarray,
) -> np.ndarray:
    """``scale_i sum_t w_it D_t (mean_i + kept_it)^T``, (n, 3, 3): ``D_t n_t = 0``."""
    out = np.empty_like(mean)
    for i in prange(len(out)):
        s, own = np.zeros((3, 3)), np.zeros((3, 3))
        for e in range(start[i], start[i + 1]):
            t, c = corner[e] // 3, corner[e] % 3
            for a in range(3):
                for b in range(3):
                    s[a, b] += weight[t, c] * D[t, a, b]
                    if creased[i]:
                        x, y, z = kept[t, c, b, 0], kept[t, c, b, 1], kept[t, c, b, 2]
                        own[a, b] += weight[t, c] * (D[t, a, 0] * x + D[t, a, 1] * y + D[t, a, 2] * z)
        for a in range(3):
            x, y, z = s[a, 0], s[a, 1], s[a, 2]
            for b in range(3):
                of_mean = x * mean[i, 0, b] + y * mean[i, 1, b] + z * mean[i, 2, b]
                out[i, a, b] = scale[i] * (of_mean + own[a, b])
    return out


@parallel(fastmath={"contract"})
def tensions(
    F: np.ndarray,
    weight: np.ndarray,
    mean: np.ndarray,
    creased: np.ndarray,
    kept: np.ndarray,
    elastic: np.ndarray,
    D: np.ndarray,
    means: np.ndarray,
    scale: float,
    q: np.ndarray,
) -> np.ndarray:
    """Tensions: ``scale sum_i w_it`` times the target in ring i, (m, 3, 3).

    The target is elastic_i R_i (mean_i + kept_it), and flow keeps the rest where it is.
    """
    out = np.zeros((len(F), 3, 3))
    for t in prange(len(F)):
        for c in range(3):
            i, w = F[t, c], scale * weight[t, c]
            drawn, flows = w * elastic[i], w * (1.0 - elastic[i])
            for b in range(3):
                x, y, z = mean[i, 0, b], mean[i, 1, b], mean[i, 2, b]
                if creased[i]:
                    x, y, z = x + kept[t, c, 0, b], y + kept[t, c, 1, b], z + kept[t, c, 2, b]
                x, y, z = rotated_vector(q, i, x, y, z)
                out[t, 0, b] += drawn * x
                out[t, 1, b] += drawn * y
                out[t, 2, b] += drawn * z
                if flows > 0.0:
                    for a in range(3):
                        out[t, a, b] += flows * (D[t, a, b] - means[i, a, b])
    return out


@parallel(fastmath={"contract"})
def add_flow(
    start: np.ndarray,
    corner: np.ndarray,
    mean: np.ndarray,
    normals: np.ndarray,
    D: np.ndarray,
    means: np.ndarray,
    q: np.ndarray,
    flowing: np.ndarray,
    creased: np.ndarray,
    kept: np.ndarray,
) -> None:
    """Add ``flowing_i R_i^T B_it`` to what every corner keeps."""
    back = q * np.array([1.0, -1.0, -1.0, -1.0])
    for i in prange(len(mean)):
        if flowing[i] > 0.0:
            for e in range(start[i], start[i + 1]):
                t, c = corner[e] // 3, corner[e] % 3
                for b in range(3):
                    x, y, z = _target(mean, normals, creased, kept, i, t, c, b)
                    d, m = D[t], means[i]
                    dx, dy, dz = rotated_vector(
                        back, i, d[0, b] - m[0, b], d[1, b] - m[1, b], d[2, b] - m[2, b]
                    )
                    kept[t, c, 0, b] += flowing[i] * (dx - x)
                    kept[t, c, 1, b] += flowing[i] * (dy - y)
                    kept[t, c, 2, b] += flowing[i] * (dz - z)
