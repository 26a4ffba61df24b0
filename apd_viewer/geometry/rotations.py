"""The local step: the rotation nearest to a 3x3 matrix, as a kernel that can be warm-started.

For every matrix S we want ``R = argmax tr(R^T S)`` over the rotations, the *global* maximum with
det R = +1 whatever S is (reflected, of rank 2, 1 or 0). Rotations are kept as unit quaternions
(w, x, y, z): products of millions of small steps then stay orthonormal to rounding.

Newton's method on the rotation is fast from a good start, and its Hessian
``H = tr(M) I - sym(M)``, ``M = R^T S``, certifies the answer: the eigenvalues of H at a stationary
point are the pairwise sums of M's, and only the global maximum makes them all positive. Where H is
not positive definite the largest eigenvector of Horn's symmetric 4x4 matrix is the answer
[Horn 1987, Closed-form solution of absolute orientation using unit quaternions].
"""

from __future__ import annotations

import numpy as np
from numba import njit

_NEWTON_STEPS = 8
# Newton converges quadratically: a step this short leaves an error at rounding level.
_SHORT_STEP = 1e-8
# Below this the maximum is nearly ambiguous and Newton's linear systems lose their digits.
_POSITIVE = 1e-6
_JACOBI_SWEEPS = 12
# Jacobi sweeps converge quadratically too: what is left at this size cannot change a digit.
_JACOBI_DONE = 1e-20


@njit(cache=True, nogil=True)
def quaternion_to_matrix(q: np.ndarray, R: np.ndarray) -> None:
    """Write the rotation matrix of the unit quaternion ``q`` (4,) into ``R`` (3, 3)."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    R[0, 0] = 1 - 2 * (y * y + z * z)
    R[0, 1] = 2 * (x * y - w * z)
    R[0, 2] = 2 * (x * z + w * y)
    R[1, 0] = 2 * (x * y + w * z)
    R[1, 1] = 1 - 2 * (x * x + z * z)
    R[1, 2] = 2 * (y * z - w * x)
    R[2, 0] = 2 * (x * z - w * y)
    R[2, 1] = 2 * (y * z + w * x)
    R[2, 2] = 1 - 2 * (x * x + y * y)


@njit(cache=True, nogil=True)
def _normalize(q: np.ndarray) -> None:
    length = np.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    for a in range(4):
        q[a] /= length


@njit(cache=True, nogil=True)
def _turn(q: np.ndarray, x: float, y: float, z: float) -> None:
    """Multiply ``q`` from the right by the Cayley map of the rotation vector (x, y, z)."""
    x, y, z = 0.5 * x, 0.5 * y, 0.5 * z
    w0, x0, y0, z0 = q[0], q[1], q[2], q[3]
    q[0] = w0 - x0 * x - y0 * y - z0 * z
    q[1] = x0 + w0 * x + y0 * z - z0 * y
    q[2] = y0 + w0 * y + z0 * x - x0 * z
    q[3] = z0 + w0 * z + x0 * y - y0 * x
    _normalize(q)


@njit(cache=True, nogil=True)
def _newton(S: np.ndarray, scale: float, q: np.ndarray, R: np.ndarray) -> bool:
    """Improve ``q`` in place; True if the global maximum was reached and certified."""
    floor = _POSITIVE * scale
    for _ in range(_NEWTON_STEPS):
        quaternion_to_matrix(q, R)
        m00 = R[0, 0] * S[0, 0] + R[1, 0] * S[1, 0] + R[2, 0] * S[2, 0]
        m01 = R[0, 0] * S[0, 1] + R[1, 0] * S[1, 1] + R[2, 0] * S[2, 1]
        m02 = R[0, 0] * S[0, 2] + R[1, 0] * S[1, 2] + R[2, 0] * S[2, 2]
        m10 = R[0, 1] * S[0, 0] + R[1, 1] * S[1, 0] + R[2, 1] * S[2, 0]
        m11 = R[0, 1] * S[0, 1] + R[1, 1] * S[1, 1] + R[2, 1] * S[2, 1]
        m12 = R[0, 1] * S[0, 2] + R[1, 1] * S[1, 2] + R[2, 1] * S[2, 2]
        m20 = R[0, 2] * S[0, 0] + R[1, 2] * S[1, 0] + R[2, 2] * S[2, 0]
        m21 = R[0, 2] * S[0, 1] + R[1, 2] * S[1, 1] + R[2, 2] * S[2, 1]
        m22 = R[0, 2] * S[0, 2] + R[1, 2] * S[1, 2] + R[2, 2] * S[2, 2]

        # H = L D L^T; a pivot that is not clearly positive ends the attempt.
        h01, h02, h12 = -0.5 * (m01 + m10), -0.5 * (m02 + m20), -0.5 * (m12 + m21)
        d0 = m11 + m22
        if d0 <= floor:
            return False
        l1, l2 = h01 / d0, h02 / d0
        d1 = m00 + m22 - l1 * h01
        if d1 <= floor:
            return False
        l3 = (h12 - l2 * h01) / d1
        d2 = m00 + m11 - l2 * h02 - l3 * l3 * d1
        if d2 <= floor:
            return False

        x = m21 - m12
        y = m02 - m20 - l1 * x
        z = m10 - m01 - l2 * x - l3 * y
        z /= d2
        y = y / d1 - l3 * z
        x = x / d0 - l1 * y - l2 * z
        _turn(q, x, y, z)
        if x * x + y * y + z * z < _SHORT_STEP * _SHORT_STEP:
            return True
    return False


@njit(cache=True, nogil=True)
def _jacobi_rotation(K: np.ndarray, E: np.ndarray, a: int, b: int) -> None:
    """Make ``K[a, b]`` zero by a plane rotation; collect the rotation in the columns of ``E``."""
    if K[a, b] == 0.0:
        return
    theta = (K[b, b] - K[a, a]) / (2.0 * K[a, b])
    t = 1.0 / (abs(theta) + np.sqrt(theta * theta + 1.0))
    if theta < 0.0:
        t = -t
    c = 1.0 / np.sqrt(t * t + 1.0)
    s = t * c
    for k in range(4):
        ka, kb = K[k, a], K[k, b]
        K[k, a], K[k, b] = c * ka - s * kb, s * ka + c * kb
    for k in range(4):
        ak, bk = K[a, k], K[b, k]
        K[a, k], K[b, k] = c * ak - s * bk, s * ak + c * bk
        ea, eb = E[k, a], E[k, b]
        E[k, a], E[k, b] = c * ea - s * eb, s * ea + c * eb
    K[a, b] = K[b, a] = 0.0


@njit(cache=True, nogil=True)
def _horn(S: np.ndarray, q: np.ndarray, K: np.ndarray, E: np.ndarray) -> None:
    """Write the quaternion that maximises ``tr(R^T S)`` into ``q``, from any S but zero."""
    K[0, 0] = S[0, 0] + S[1, 1] + S[2, 2]
    K[1, 1] = S[0, 0] - S[1, 1] - S[2, 2]
    K[2, 2] = S[1, 1] - S[0, 0] - S[2, 2]
    K[3, 3] = S[2, 2] - S[0, 0] - S[1, 1]
    K[0, 1] = K[1, 0] = S[2, 1] - S[1, 2]
    K[0, 2] = K[2, 0] = S[0, 2] - S[2, 0]
    K[0, 3] = K[3, 0] = S[1, 0] - S[0, 1]
    K[1, 2] = K[2, 1] = S[0, 1] + S[1, 0]
    K[1, 3] = K[3, 1] = S[0, 2] + S[2, 0]
    K[2, 3] = K[3, 2] = S[1, 2] + S[2, 1]
    E[:] = 0.0
    for a in range(4):
        E[a, a] = 1.0
    for _ in range(_JACOBI_SWEEPS):
        for a in range(3):
            for b in range(a + 1, 4):
                _jacobi_rotation(K, E, a, b)
        off = abs(K[0, 1]) + abs(K[0, 2]) + abs(K[0, 3]) + abs(K[1, 2]) + abs(K[1, 3]) + abs(K[2, 3])
        if off <= _JACOBI_DONE * (abs(K[0, 0]) + abs(K[1, 1]) + abs(K[2, 2]) + abs(K[3, 3])):
            break
    best = 0
    for a in range(1, 4):
        if K[a, a] > K[best, best]:
            best = a
    for a in range(4):
        q[a] = E[a, best]
    _normalize(q)


@njit(cache=True, nogil=True)
def fit_rotation(S: np.ndarray, q: np.ndarray, R: np.ndarray, K: np.ndarray, E: np.ndarray) -> None:
    """Replace ``q`` and ``R`` by the rotation that maximises ``tr(R^T S)``.

    Parameters
    ----------
    S : (3, 3) float array
    q : (4,) float array
        Unit quaternion, the start on entry and the answer on return. Kept where S is zero.
    R : (3, 3) float array
        Overwritten with the matrix of ``q``.
    K, E : (4, 4) float arrays
        Scratch.
    """
    scale = 0.0
    for a in range(3):
        for b in range(3):
            scale += abs(S[a, b])
    if scale > 0.0 and not _newton(S, scale, q, R):
        _horn(S, q, K, E)
    quaternion_to_matrix(q, R)


@njit(cache=True, nogil=True)
def fit_rotations(S: np.ndarray, q: np.ndarray, R: np.ndarray) -> None:
    """Apply :func:`fit_rotation` to every matrix of ``S`` (n, 3, 3), with ``q`` (n, 4), ``R`` (n, 3, 3)."""
    K, E = np.empty((4, 4)), np.empty((4, 4))
    for i in range(S.shape[0]):
        fit_rotation(S[i], q[i], R[i], K, E)
