"""Projections of the membrane's triangles, LANES side by side.

No branches, no calls, one flat array with constant strides: the compiler vectorizes over lanes. A division
or a root then takes no longer for eight triangles than for one.
"""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry.linalg.kernels import njit

# Twice as many doubles as the widest registers hold: one half proceeds while the other waits for a division.
LANES = 16
# Of a lane: D, then T in its place; s1, s2, p, cosine and sine of twice the angle of s1's direction, the last
# step of Newton's method, 1 where there is a plane, the energy.
ROWS = 14
_S1, _S2, _P, _C, _S, _STEP, _PLANE, _ENERGY = (k * LANES for k in range(6, ROWS))
_NEWTON_STEPS = 20
# Convergence is quadratic: after such a step only rounding is left.
_SHORT_STEP = 1e-8
# A flatter triangle has no plane to open it into.
_FLAT = 1e-12


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _stretch(X: np.ndarray) -> None:
    """Stretches of all lanes, and where Newton's method begins."""
    for i in range(LANES):
        x0, x1, x2 = X[i], X[2 * LANES + i], X[4 * LANES + i]
        y0, y1, y2 = X[LANES + i], X[3 * LANES + i], X[5 * LANES + i]
        a, b, d = x0 * x0 + x1 * x1 + x2 * x2, x0 * y0 + x1 * y1 + x2 * y2, y0 * y0 + y1 * y1 + y2 * y2
        # D^T D = m I + r [[c, s], [s, -c]]; (c, s) is the larger stretch's direction at twice its angle.
        m, h = 0.5 * (a + d), 0.5 * (a - d)
        r = np.sqrt(h * h + b * b)
        s1 = np.sqrt(m + r)
        z0, z1, z2 = x1 * y2 - x2 * y1, x2 * y0 - x0 * y2, x0 * y1 - x1 * y0
        s2 = np.sqrt(z0 * z0 + z1 * z1 + z2 * z2) / s1
        plane = s2 > _FLAT * s1
        s1, s2 = s1 if plane else 1.0, s2 if plane else 1.0
        X[_S1 + i], X[_S2 + i], X[_PLANE + i] = s1, s2, 1.0 if plane else 0.0
        X[_C + i], X[_S + i] = h / r if r > 0.0 else 1.0, b / r if r > 0.0 else 0.0
        X[_P + i] = s1 if s1 > 1.0 else 1.0


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _newton_step(X: np.ndarray) -> None:
    """One step towards the minimiser ``p`` of ``(p - s1)^2 + (1/p - s2)^2``."""
    for i in range(LANES):
        s1, s2, p = X[_S1 + i], X[_S2 + i], X[_P + i]
        q = 1.0 / p
        q2 = q * q
        step = (p - s1 - (q - s2) * q2) / (1.0 + (3.0 * q - 2.0 * s2) * q2 * q)
        X[_P + i], X[_STEP + i] = p - step, abs(step) * q


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _pull(X: np.ndarray, shear: float, area: float) -> None:
    """``T = D (f1 v1 v1^T + f2 v2 v2^T)``, v the directions of the stretches."""
    for i in range(LANES):
        s1, s2, p1, plane = X[_S1 + i], X[_S2 + i], X[_P + i], X[_PLANE + i]
        p2 = 1.0 / p1
        f1, f2 = (shear + area * p1) / s1, (shear + area * p2) / s2
        mean, half = plane * (0.5 * (f1 + f2)) + (1.0 - plane) * (shear + area), plane * (0.5 * (f1 - f2))
        m00, m01, m11 = mean + half * X[_C + i], half * X[_S + i], mean - half * X[_C + i]
        for k in (0, 2, 4):
            x, y = X[k * LANES + i], X[(k + 1) * LANES + i]
            X[k * LANES + i], X[(k + 1) * LANES + i] = x * m00 + y * m01, x * m01 + y * m11
        moved, strained = (s1 - 1.0) ** 2 + (s2 - 1.0) ** 2, (s1 - p1) ** 2 + (s2 - p2) ** 2
        X[_ENERGY + i] = plane * (shear * moved + area * strained)


@njit(cache=True, nogil=True)
def project_lanes(X: np.ndarray, shear: float, area: float) -> None:
    """``T = shear R + area P`` for LANES deformation gradients D side by side.

    Where a triangle has collapsed, T is ``(shear + area) D``: zero is a subgradient.

    Parameters
    ----------
    X : (ROWS * LANES,) float array
        Lane i has D (3, 2) in ``X[i], X[LANES + i], ...``, row by row, and T on return; in the last row then
        ``shear |D - R|^2 + area |D - P|^2``.
    """
    _stretch(X)
    for _ in range(_NEWTON_STEPS):
        _newton_step(X)
        longest = 0.0
        for i in range(LANES):
            longest = max(longest, X[_STEP + i])
        if longest < _SHORT_STEP:
            break
    _pull(X, shear, area)
