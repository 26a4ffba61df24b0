"""Unit quaternions, and the rotation nearest to a 3x3 matrix, warm-started.

For every matrix S we want ``R = argmax tr(R^T S)`` over the rotations, the *global* maximum with
det R = +1 whatever S is (reflected, of rank 2, 1 or 0). Rotations are kept as unit quaternions
(w, x, y, z): products of millions of small steps then stay orthonormal to rounding.

Newton's method on the rotation is fast from a good start (steps by the Cayley map shrink to their cubes,
measured), and its Hessian
``H = tr(M) I - sym(M)``, ``M = R^T S``, certifies the answer: the eigenvalues of H at a stationary
point are the pairwise sums of M's, and only the global maximum makes them all positive. Where H is
not positive definite the largest eigenvector of Horn's symmetric 4x4 matrix is the answer
[Horn 1987, Closed-form solution of absolute orientation using unit quaternions].
"""

import numpy as np
from numba import prange

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.threads import parallel

# Matrices side by side: twice as many doubles as the widest registers hold, so that one
# half proceeds while the other waits for a division.
LANES = 16
# Rows of a lane: S, quaternion, square of half the last step.
ROWS = 14
_NEWTON_STEPS = 8
# Half a step, squared. Convergence is cubic: after a step of 1e-5 the error is at rounding level.
_SHORT_STEP = 0.25e-10
_UNCERTIFIED = -1.0
# Relative pivot below which the maximum is nearly ambiguous and Newton's systems lose accuracy.
_POSITIVE = 1e-6
_JACOBI_SWEEPS = 12
# Jacobi sweeps converge quadratically too: off-diagonal entries of this size are below rounding.
_JACOBI_DONE = 1e-20


@njit(cache=True, nogil=True, error_model="numpy")
def _newton_step(X: np.ndarray) -> None:
    """One Newton step on all lanes of ``X``; uncertified lanes are unchanged."""
    # No branches, no calls, one flat array with constant strides: the compiler vectorizes over lanes.
    for i in range(LANES):
        s00, s01, s02 = X[i], X[LANES + i], X[2 * LANES + i]
        s10, s11, s12 = X[3 * LANES + i], X[4 * LANES + i], X[5 * LANES + i]
        s20, s21, s22 = X[6 * LANES + i], X[7 * LANES + i], X[8 * LANES + i]
        w, x, y, z = X[9 * LANES + i], X[10 * LANES + i], X[11 * LANES + i], X[12 * LANES + i]
        r00, r01, r02 = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
        r10, r11, r12 = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
        r20, r21, r22 = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
        m00 = r00 * s00 + r10 * s10 + r20 * s20
        m01 = r00 * s01 + r10 * s11 + r20 * s21
        m02 = r00 * s02 + r10 * s12 + r20 * s22
        m10 = r01 * s00 + r11 * s10 + r21 * s20
        m11 = r01 * s01 + r11 * s11 + r21 * s21
        m12 = r01 * s02 + r11 * s12 + r21 * s22
        m20 = r02 * s00 + r12 * s10 + r22 * s20
        m21 = r02 * s01 + r12 * s11 + r22 * s21
        m22 = r02 * s02 + r12 * s12 + r22 * s22

        # H = L D L^T; only clearly positive pivots certify the maximum.
        floor = _POSITIVE * (
            abs(s00) + abs(s01) + abs(s02) + abs(s10) + abs(s11) + abs(s12) + abs(s20) + abs(s21) + abs(s22)
        )
        h01, h02, h12 = -0.5 * (m01 + m10), -0.5 * (m02 + m20), -0.5 * (m12 + m21)
        d0 = m11 + m22
        over0 = 1.0 / d0
        l1, l2 = h01 * over0, h02 * over0
        d1 = m00 + m22 - l1 * h01
        over1 = 1.0 / d1
        l3 = (h12 - l2 * h01) * over1
        d2 = m00 + m11 - l2 * h02 - l3 * l3 * d1
        certified = (d0 > floor) & (d1 > floor) & (d2 > floor)

        # Solve H t = axial(M); apply the Cayley map of t from the right.
        t0 = m21 - m12
        t1 = m02 - m20 - l1 * t0
        t2 = m10 - m01 - l2 * t0 - l3 * t1
        t2 /= d2
        t1 = t1 * over1 - l3 * t2
        t0 = t0 * over0 - l1 * t1 - l2 * t2
        t0 = 0.5 * t0 if certified else 0.0
        t1 = 0.5 * t1 if certified else 0.0
        t2 = 0.5 * t2 if certified else 0.0
        w, x, y, z = (
            w - x * t0 - y * t1 - z * t2,
            x + w * t0 + y * t2 - z * t1,
            y + w * t1 + z * t0 - x * t2,
            z + w * t2 + x * t1 - y * t0,
        )
        shrink = 1.0 / np.sqrt(w * w + x * x + y * y + z * z) if certified else 1.0
        X[9 * LANES + i] = w * shrink
        X[10 * LANES + i] = x * shrink
        X[11 * LANES + i] = y * shrink
        X[12 * LANES + i] = z * shrink
        X[13 * LANES + i] = t0 * t0 + t1 * t1 + t2 * t2 if certified else _UNCERTIFIED


@njit(cache=True, nogil=True)
def _jacobi_rotation(K: np.ndarray, E: np.ndarray, a: int, b: int) -> None:
    """Zero ``K[a, b]`` by a plane rotation, accumulated in the columns of ``E``."""
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
def horn(S: np.ndarray, q: np.ndarray, K: np.ndarray, E: np.ndarray) -> None:
    """Write the quaternion maximising ``tr(R^T S)`` into ``q``; S is not zero."""
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
    length = np.sqrt(E[0, best] ** 2 + E[1, best] ** 2 + E[2, best] ** 2 + E[3, best] ** 2)
    for a in range(4):
        q[a] = E[a, best] / length


@njit(cache=True, nogil=True)
def fit_lanes(X: np.ndarray, scratch: np.ndarray) -> None:
    """Rotations maximising ``tr(R^T S)``, for LANES matrices side by side.

    Parameters
    ----------
    X : (ROWS * LANES,) float array
        Lane i has S in ``X[i], X[LANES + i], ...``, row by row, and in the next four rows the unit
        quaternion (w, x, y, z): the start on entry, the answer on return. It is kept where S is zero.
    scratch : (3, 4, 4) float array
    """
    for _ in range(_NEWTON_STEPS):
        _newton_step(X)
        longest = 0.0
        for i in range(LANES):
            longest = max(longest, X[13 * LANES + i])
        if longest < _SHORT_STEP:
            break
    S, K, E = scratch[0], scratch[1], scratch[2]
    for i in range(LANES):
        if 0.0 <= X[13 * LANES + i] < _SHORT_STEP:
            continue
        scale = 0.0
        for a in range(3):
            for b in range(3):
                S[a, b] = X[(3 * a + b) * LANES + i]
                scale += abs(S[a, b])
        if scale > 0.0:
            horn(S, S[3], K, E)
            for a in range(4):
                X[(9 + a) * LANES + i] = S[3, a]


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
def load_rotation(X: np.ndarray, i: int, q: np.ndarray) -> None:
    """Load ``q`` (4,) as the initial rotation of lane ``i``."""
    for a in range(4):
        X[(9 + a) * LANES + i] = q[a]


@njit(cache=True, nogil=True)
def store_rotation(X: np.ndarray, i: int, q: np.ndarray) -> None:
    """Write the resulting rotation of lane ``i`` into ``q`` (4,)."""
    for a in range(4):
        q[a] = X[(9 + a) * LANES + i]


@njit(inline="always")
def rotated_vector(q: np.ndarray, i: int, x: float, y: float, z: float) -> tuple[float, float, float]:
    """The vector (x, y, z) turned by the unit quaternion ``q[i]``."""
    w, a, b, c = q[i, 0], q[i, 1], q[i, 2], q[i, 3]
    tx, ty, tz = 2 * (b * z - c * y), 2 * (c * x - a * z), 2 * (a * y - b * x)
    return x + w * tx + b * tz - c * ty, y + w * ty + c * tx - a * tz, z + w * tz + a * ty - b * tx


@parallel()
def compose_rotations(rotations: np.ndarray, q: np.ndarray) -> None:
    """Compose every rotation of ``q`` (n, 4) with ``rotations`` (n, 4), in place."""
    for i in prange(len(q)):
        w, x, y, z = rotations[i, 0], rotations[i, 1], rotations[i, 2], rotations[i, 3]
        a, b, c, d = q[i, 0], q[i, 1], q[i, 2], q[i, 3]
        q[i, 0] = w * a - x * b - y * c - z * d
        q[i, 1] = w * b + x * a + y * d - z * c
        q[i, 2] = w * c - x * d + y * a + z * b
        q[i, 3] = w * d + x * c - y * b + z * a


def relative_rotations(q: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """``q`` times the inverse of ``reference``, both (c, 4) unit quaternions."""
    w, x, y, z = q.T
    a, b, c, d = reference[:, 0], -reference[:, 1], -reference[:, 2], -reference[:, 3]
    return np.column_stack(
        [
            w * a - x * b - y * c - z * d,
            w * b + x * a + y * d - z * c,
            w * c - x * d + y * a + z * b,
            w * d + x * c - y * b + z * a,
        ]
    )


@parallel()
def blended_rotations(q: np.ndarray, near: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Weighted mean quaternions (n, 4) of ``q`` (c, 4) by ``near`` and ``weight``."""
    out = np.empty((len(near), 4))
    for i in prange(len(near)):
        w = x = y = z = 0.0
        for k in range(near.shape[1]):
            j, share = near[i, k], weight[i, k]
            # q and -q are the same rotation: align signs with the first.
            f = near[i, 0]
            side = q[f, 0] * q[j, 0] + q[f, 1] * q[j, 1] + q[f, 2] * q[j, 2] + q[f, 3] * q[j, 3]
            share = share if side >= 0.0 else -share
            w += share * q[j, 0]
            x += share * q[j, 1]
            y += share * q[j, 2]
            z += share * q[j, 3]
        length = np.sqrt(w * w + x * x + y * y + z * z)
        if length > 0.0:
            out[i, 0], out[i, 1], out[i, 2], out[i, 3] = w / length, x / length, y / length, z / length
        else:
            out[i, 0], out[i, 1], out[i, 2], out[i, 3] = 1.0, 0.0, 0.0, 0.0
    return out
