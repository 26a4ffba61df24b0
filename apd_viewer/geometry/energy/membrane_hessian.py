"""Membrane Hessian, triangle by triangle, with negative eigenvalues clamped.

The energy of a triangle is a function of the two stretches s1 >= s2 of its deformation gradient
``D = U diag(s1, s2) V^T`` alone. Then the modes of its Hessian are known: stretching along the two
directions, twisting and flipping in the plane, and turning each direction out of it [Smith, de Goes & Kim
2019, Analytic Eigensystems for Isotropic Distortion Energies]. With ``f1, f2`` the slopes by the stretches,

    stretching  the 2 x 2 second derivatives,
    twisting    (f1 + f2) / (s1 + s2),      flipping  (f1 - f2) / (s1 - s2),
    turning     f1 / s1,  f2 / s2.

A triangle that is compressed would rather turn out of its plane: there the last are negative.
"""

import numpy as np
from numba import prange

from apd_viewer.geometry.energy.membrane import larger_stretch
from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.threads import parallel

# Numbers per triangle: the frame U, the larger stretch's direction in the rest plane, the moduli.
WIDTH = 18
# Ratio of stretches below which a triangle has no plane, and relative difference treated as rounding.
_FLAT = 1e-6
# Lower bound: the derivative is infinite where the nearest triangle of equal area is not unique.
_SHARPEST = 1e-6


@njit(inline="always")
def _area_slopes(s1: float, s2: float) -> tuple[float, float, float, float, float]:
    """Derivatives of ``min_p (p - s1)^2 + (1/p - s2)^2``: f1, f2, f11, f12, f22."""
    p = larger_stretch(s1, s2)
    q = 1.0 / p
    # Derivatives of the minimiser p, by the implicit function theorem.
    bend = max(1.0 + (3.0 * q - 2.0 * s2) * q * q * q, _SHARPEST)
    p1, p2 = 1.0 / bend, -q * q / bend
    return 2.0 * (s1 - p), 2.0 * (s2 - q), 2.0 * (1.0 - p1), -2.0 * p2, 2.0 * (1.0 + q * q * p2)


@njit(inline="always")
def _stretch_moduli(f11: float, f12: float, f22: float, least: float) -> tuple[float, float, float]:
    """Second derivatives by the stretches, with eigenvalues of at least ``least``."""
    mean, half = 0.5 * (f11 + f22), 0.5 * (f11 - f22)
    r = np.sqrt(half * half + f12 * f12)
    larger, smaller = max(mean + r, least), max(mean - r, least)
    c, s = (half / r, f12 / r) if r > 0.0 else (1.0, 0.0)
    mean, half = 0.5 * (larger + smaller), 0.5 * (larger - smaller)
    return mean + half * c, half * s, mean - half * c


@njit(inline="always")
def _write_modes(D: np.ndarray, shear: float, area: float, least: float, out: np.ndarray) -> None:
    """Write a triangle's modes: frame U, direction in the rest plane, and moduli."""
    x0, x1, x2, y0, y1, y2 = D[0, 0], D[1, 0], D[2, 0], D[0, 1], D[1, 1], D[2, 1]
    a, b, d = x0 * x0 + x1 * x1 + x2 * x2, x0 * y0 + x1 * y1 + x2 * y2, y0 * y0 + y1 * y1 + y2 * y2
    m, h = 0.5 * (a + d), 0.5 * (a - d)
    r = np.sqrt(h * h + b * b)
    s1 = np.sqrt(m + r)
    z0, z1, z2 = x1 * y2 - x2 * y1, x2 * y0 - x0 * y2, x0 * y1 - x1 * y0
    det = np.sqrt(z0 * z0 + z1 * z1 + z2 * z2)
    s2 = det / s1 if s1 > 0.0 else 0.0
    out[:] = 0.0
    if s2 <= _FLAT * s1:
        # As in the constant matrix K: the Hessian for fixed projections.
        out[0] = out[4] = out[8] = out[9] = 1.0
        out[11] = out[13] = out[14] = out[16] = out[17] = 2.0 * (shear + area)
        return
    c, s = (h / r, b / r) if r > 0.0 else (1.0, 0.0)
    v0, v1 = np.sqrt(max(0.5 * (1.0 + c), 0.0)), np.copysign(np.sqrt(max(0.5 * (1.0 - c), 0.0)), s)
    for i in range(3):
        out[3 * i] = (D[i, 0] * v0 + D[i, 1] * v1) / s1
        out[3 * i + 1] = (D[i, 1] * v0 - D[i, 0] * v1) / s2
    out[2], out[5], out[8] = z0 / det, z1 / det, z2 / det
    out[9], out[10] = v0, v1
    f1, f2, f11, f12, f22 = _area_slopes(s1, s2)
    f1, f2 = area * f1 + 2.0 * shear * (s1 - 1.0), area * f2 + 2.0 * shear * (s2 - 1.0)
    f11, f12, f22 = area * f11 + 2.0 * shear, area * f12, area * f22 + 2.0 * shear
    out[11], out[12], out[13] = _stretch_moduli(f11, f12, f22, least)
    twist = max((f1 + f2) / (s1 + s2), least)
    flip = max((f1 - f2) / (s1 - s2) if s1 - s2 > _FLAT * s1 else f11 - f12, least)
    out[14], out[15] = 0.5 * (flip + twist), 0.5 * (flip - twist)
    out[16], out[17] = max(f1 / s1, least), max(f2 / s2, least)


@parallel(error_model="numpy")
def modes(
    F: np.ndarray, rest: np.ndarray, U: np.ndarray, shear: float, area: float, least: float
) -> np.ndarray:
    """Modes of every triangle's Hessian at ``U`` (n, 3), (m, 18) float array.

    Parameters
    ----------
    F : (m, 3) int array
    rest : (m, 3) float array
        Corners in the rest plane: (0, 0), (x1, 0), (x2, y2); x1 is 0 for a triangle that does not count.
    shear, area : float
        Weights of the two terms of the membrane.
    least : float
        Smaller eigenvalues of the Hessian by D are replaced by this one: 0 for a positive semi-definite
        matrix, -inf for the Hessian itself.
    """
    out = np.zeros((len(F), WIDTH))
    for t in prange(len(F)):
        x1, x2, y2 = rest[t, 0], rest[t, 1], rest[t, 2]
        if x1 != 0.0:
            i, j, k = F[t, 0], F[t, 1], F[t, 2]
            D = np.empty((3, 2))
            for a in range(3):
                D[a, 0] = (U[j, a] - U[i, a]) / x1
                D[a, 1] = (U[k, a] - U[i, a] - D[a, 0] * x2) / y2
            _write_modes(D, shear, area, least, out[t])
    return out


@njit(inline="always")
def _hat_gradient(rest: np.ndarray, mode: np.ndarray, c: int) -> tuple[float, float]:
    """Gradient of corner ``c``'s hat function along the principal stretch directions."""
    x1, x2, y2 = rest[0], rest[1], rest[2]
    if c == 0:
        gx, gy = -1.0 / x1, (x2 - x1) / (x1 * y2)
    elif c == 1:
        gx, gy = 1.0 / x1, -x2 / (x1 * y2)
    else:
        gx, gy = 0.0, 1.0 / y2
    return gx * mode[9] + gy * mode[10], gy * mode[9] - gx * mode[10]


@parallel(error_model="numpy")
def add_blocks(
    free: np.ndarray,
    start: np.ndarray,
    corner: np.ndarray,
    slot: np.ndarray,
    rest: np.ndarray,
    modes: np.ndarray,
    blocks: np.ndarray,
) -> None:
    """Add a quarter of the Hessian for the free vertices to ``blocks``.

    Parameters
    ----------
    free : (f,) int array
    start, corner : (n + 1,), (3 m,) int arrays
        The corners at each vertex: see :class:`Patch`.
    slot : (m, 3, 3) int array
        The block for corners c and d of each triangle; negative where either is not free.
    rest, modes : (m, 3), (m, 18) float arrays
    blocks : (e, 3, 3) float array
        Each row's are written by one core.
    """
    for r in prange(len(free)):
        i = free[r]
        for e in range(start[i], start[i + 1]):
            t, c = corner[e] // 3, corner[e] % 3
            if rest[t, 0] == 0.0:
                continue
            mode = modes[t]
            weight = 0.125 * rest[t, 0] * rest[t, 2]
            p, q = _hat_gradient(rest[t], mode, c)
            for d in range(3):
                if slot[t, c, d] < 0:
                    continue
                x, y = _hat_gradient(rest[t], mode, d)
                m00 = mode[11] * p * x + mode[14] * q * y
                m01 = mode[12] * p * y + mode[15] * q * x
                m10 = mode[12] * q * x + mode[15] * p * y
                m11 = mode[13] * q * y + mode[14] * p * x
                m22 = mode[16] * p * x + mode[17] * q * y
                block = blocks[slot[t, c, d]]
                for a in range(3):
                    u, v, w = weight * mode[3 * a], weight * mode[3 * a + 1], weight * mode[3 * a + 2]
                    l0, l1, l2 = u * m00 + v * m10, u * m01 + v * m11, w * m22
                    for b in range(3):
                        block[a, b] += l0 * mode[3 * b] + l1 * mode[3 * b + 1] + l2 * mode[3 * b + 2]
