"""Hessian of a thin wall, a matrix of 3 x 3 blocks.

Stretching, bending and the goals' curvature give exact blocks. With ``share`` below 1 compressive stresses,
the curvature of the hinges' angles and that of the goals count less: at 0 what is left is positive definite.

The second derivatives of an angle follow from its gradient, made of ``u = L N / |N|^2`` and
``s = p . q / L^2`` of either triangle, with the edge p of length L, the way q from its start to the opposite
corner and ``N = p x q``. Those of a triangle's area are ``1/2 ((e_i . e_j) / (2 A) n n^T -+ [n]_x)`` for the
edges e opposite to its corners, those of a volume ``-[x_k]_x / 6``.
"""

import numpy as np
from numba import prange

from apd_viewer.geometry.energy.tension_field import relaxed_moduli, relaxed_stress
from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.threads import parallel

# Parallel tasks; each has a table of all columns.
_TASKS = 16


@njit(cache=True, nogil=True)
def _clamped(s00: float, s11: float, s01: float, share: float) -> tuple[float, float, float]:
    """Plane stress with its compressive part times ``share``."""
    m, h = 0.5 * (s00 + s11), 0.5 * (s00 - s11)
    r = np.sqrt(h * h + s01 * s01)
    p, q = m + r, m - r
    c, s = (h / r, s01 / r) if r > 0.0 else (1.0, 0.0)
    if p < 0.0:
        p *= share
    if q < 0.0:
        q *= share
    m, h = 0.5 * (p + q), 0.5 * (p - q)
    return m + h * c, m - h * c, h * s


@njit(cache=True, nogil=True, error_model="numpy")
def _add_triangle(
    U: np.ndarray,
    F: np.ndarray,
    t: int,
    c: int,
    hats: np.ndarray,
    area: float,
    lame: float,
    mu: float,
    strains: np.ndarray,
    relaxed: bool,
    tension: float,
    pressure: float,
    share: float,
    at: np.ndarray,
    blocks: np.ndarray,
) -> None:
    """Add the row of corner ``c`` of triangle ``t`` at the blocks ``at`` (3,)."""
    i, j, k = F[t, 0], F[t, 1], F[t, 2]
    x, y = np.empty(3), np.empty(3)
    for a in range(3):
        u, v = U[j, a] - U[i, a], U[k, a] - U[i, a]
        x[a] = u * hats[t, 1, 0] + v * hats[t, 2, 0]
        y[a] = u * hats[t, 1, 1] + v * hats[t, 2, 1]
    e00 = 0.5 * (x[0] * x[0] + x[1] * x[1] + x[2] * x[2] - 1.0) + strains[t, 0]
    e11 = 0.5 * (y[0] * y[0] + y[1] * y[1] + y[2] * y[2] - 1.0) + strains[t, 1]
    e01 = 0.5 * (x[0] * y[0] + x[1] * y[1] + x[2] * y[2]) + strains[t, 2]
    trace = lame * (e00 + e11)
    s00, s11, s01 = _clamped(trace + 2.0 * mu * e00, trace + 2.0 * mu * e11, 2.0 * mu * e01, share)
    g, h = hats[t, c, 0], hats[t, c, 1]
    whole, moduli = lame + 2.0 * mu, np.empty((3, 3))
    if relaxed:
        _, s00, s11, s01 = relaxed_stress(e00, e11, e01, lame, mu)
        s00, s11, s01 = _clamped(s00, s11, s01, share)
        relaxed_moduli(e00, e11, e01, lame, mu, moduli)
    for d in range(3):
        if at[d] < 0:
            continue
        p, q = hats[t, d, 0], hats[t, d, 1]
        turning = area * (g * (s00 * p + s01 * q) + h * (s01 * p + s11 * q))
        block = blocks[at[d]]
        if relaxed:
            _add_strained(area, x, y, g, h, p, q, moduli, block)
            for a in range(3):
                block[a, a] += turning
            continue
        for a in range(3):
            ax, ay, az = area * x[a] * g, area * y[a] * h, area * mu * (x[a] * h + y[a] * g)
            for b in range(3):
                bx, by = x[b] * p, y[b] * q
                value = ax * (whole * bx + lame * by) + ay * (lame * bx + whole * by)
                block[a, b] += value + az * (x[b] * q + y[b] * p)
            block[a, a] += turning
    if tension != 0.0 or pressure != 0.0:
        _add_goals(U, F[t], c, tension, pressure, share, at, blocks)


@njit(cache=True, nogil=True)
def _add_strained(
    area: float,
    x: np.ndarray,
    y: np.ndarray,
    g: float,
    h: float,
    p: float,
    q: float,
    moduli: np.ndarray,
    block: np.ndarray,
) -> None:
    """Add ``moduli`` (3, 3) between corners with hat gradients (g, h) and (p, q)."""
    for b in range(3):
        b0, b1, b2 = x[b] * p, y[b] * q, x[b] * q + y[b] * p
        s0 = area * (moduli[0, 0] * b0 + moduli[0, 1] * b1 + moduli[0, 2] * b2)
        s1 = area * (moduli[1, 0] * b0 + moduli[1, 1] * b1 + moduli[1, 2] * b2)
        s2 = area * (moduli[2, 0] * b0 + moduli[2, 1] * b1 + moduli[2, 2] * b2)
        for a in range(3):
            block[a, b] += x[a] * g * s0 + y[a] * h * s1 + (x[a] * h + y[a] * g) * s2


@njit(cache=True, nogil=True, error_model="numpy")
def _add_goals(
    U: np.ndarray,
    T: np.ndarray,
    c: int,
    tension: float,
    pressure: float,
    share: float,
    at: np.ndarray,
    blocks: np.ndarray,
) -> None:
    """Add ``tension`` times the area's Hessian and ``pressure`` times the volume's."""
    E = np.empty((3, 3))
    for i in range(3):
        for a in range(3):
            E[i, a] = U[T[(i + 2) % 3], a] - U[T[(i + 1) % 3], a]
    n = np.empty(3)
    n[0] = E[0, 1] * E[1, 2] - E[0, 2] * E[1, 1]
    n[1] = E[0, 2] * E[1, 0] - E[0, 0] * E[1, 2]
    n[2] = E[0, 0] * E[1, 1] - E[0, 1] * E[1, 0]
    double = np.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
    if double == 0.0:
        return
    outwards = 0.5 * tension * (share if tension < 0.0 else 1.0)
    for a in range(3):
        n[a] /= double
    for d in range(3):
        if at[d] < 0:
            continue
        block = blocks[at[d]]
        along = outwards * (E[c, 0] * E[d, 0] + E[c, 1] * E[d, 1] + E[c, 2] * E[d, 2]) / double
        for a in range(3):
            for b in range(3):
                block[a, b] += along * n[a] * n[b]
        if d == c:
            continue
        sign = -share if d == (c + 1) % 3 else share
        third = T[3 - c - d]
        for a in range(3):
            # [w]_x has -w_2 at (0, 1), -w_0 at (1, 2) and -w_1 at (2, 0).
            b, o = (a + 1) % 3, (a + 2) % 3
            w = sign * (0.5 * tension * n[o] + pressure * U[third, o] / 6.0)
            block[a, b] -= w
            block[b, a] += w


@njit(cache=True, nogil=True, error_model="numpy")
def _add_hinge(
    U: np.ndarray, hinge: np.ndarray, row: int, moment: float, at: np.ndarray, blocks: np.ndarray
) -> None:
    """Add ``moment`` times a row of the second derivatives of a hinge's angle."""
    p, q, N, Nq, pN = np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    up, uq = np.empty((3, 3)), np.empty((3, 3))
    for side in range(2):
        if row == 3 - side:
            continue
        third = 2 + side
        for a in range(3):
            p[a] = U[hinge[1], a] - U[hinge[0], a]
            q[a] = U[hinge[third], a] - U[hinge[0], a]
        _cross(p, q, N)
        square = max(p[0] * p[0] + p[1] * p[1] + p[2] * p[2], 1e-300)
        double = max(N[0] * N[0] + N[1] * N[1] + N[2] * N[2], 1e-300)
        length, pq = np.sqrt(square), p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
        s = pq / square
        # N points the other way for the second triangle.
        scale = moment * (1.0 if side == 0 else -1.0) / double
        _cross(q, N, Nq)  # Change of the squared length of N: N . dN = dp . (q x N) = dq . (N x p).
        _cross(N, p, pN)
        for a in range(3):
            for b in range(3):
                up[a, b] = scale * N[a] * (p[b] / length - 2.0 * length / double * Nq[b])
                uq[a, b] = -scale * 2.0 * length / double * N[a] * pN[b]
        for a in range(3):
            # Change of N itself: dN = dp x q + p x dq.
            b, o = (a + 1) % 3, (a + 2) % 3
            up[a, b] += scale * length * q[o]
            up[b, a] -= scale * length * q[o]
            uq[a, b] -= scale * length * p[o]
            uq[b, a] += scale * length * p[o]
        for a in range(3):
            u = scale * length * N[a]
            for b in range(3):
                sp, sq = q[b] / square - 2.0 * s * p[b] / square, p[b] / square
                if row == 0:
                    x, y = (1.0 - s) * up[a, b] - u * sp, (1.0 - s) * uq[a, b] - u * sq
                elif row == 1:
                    x, y = s * up[a, b] + u * sp, s * uq[a, b] + u * sq
                else:
                    x, y = -up[a, b], -uq[a, b]
                if at[0] >= 0:
                    blocks[at[0], a, b] -= x + y
                if at[1] >= 0:
                    blocks[at[1], a, b] += x
                if at[third] >= 0:
                    blocks[at[third], a, b] += y


@njit(cache=True, nogil=True)
def _cross(a: np.ndarray, b: np.ndarray, out: np.ndarray) -> None:
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


@parallel(error_model="numpy")
def wall_blocks(
    U: np.ndarray,
    F: np.ndarray,
    start: np.ndarray,
    corner: np.ndarray,
    hats: np.ndarray,
    areas: np.ndarray,
    lame: float,
    mu: float,
    strains: np.ndarray,
    relaxed: bool,
    tensions: np.ndarray,
    pressure: float,
    hinges: np.ndarray,
    hinge_start: np.ndarray,
    hinge_at: np.ndarray,
    q_start: np.ndarray,
    q_column: np.ndarray,
    q_entry: np.ndarray,
    J: np.ndarray,
    moments: np.ndarray,
    share: float,
    free: np.ndarray,
    place: np.ndarray,
    row_start: np.ndarray,
    column: np.ndarray,
) -> np.ndarray:
    """Blocks (e, 3, 3) of the Hessian for the free vertices.

    Parameters
    ----------
    U : (n, 3) float array
    F, start, corner
        Triangles, and the corners at each vertex: see :class:`Patch`.
    hats, areas, lame, mu, strains, relaxed
        See :class:`Stretching`.
    tensions : (m,) float array
        Weight of each triangle's area in the Lagrangian.
    pressure : float
        That of the volume.
    hinges : (h, 4) int array
    hinge_start, hinge_at : (n + 1,), (4 h,) int arrays
        Hinges at each vertex: 4 times the hinge plus its corner.
    q_start, q_column, q_entry : (h + 1,), (z,), (z,) arrays
        The matrix Q.
    J, moments : (h, 4, 3), (h,) float arrays
        Gradients of the angles, and derivatives of the energy by them.
    share : float
        What counts of terms that may not be positive, 0 to 1.
    free, place : (f,), (n,) int arrays
        Free vertices, and the row of each vertex; negative if it has none.
    row_start, column : (f + 1,), (e,) int arrays
        The block columns of each row.
    """
    blocks = np.zeros((len(column), 3, 3))
    rows, bent = len(free), len(moments)
    for task in prange(_TASKS):
        table, at = np.full(rows, -1), np.empty(4, np.int64)
        for r in range(task * rows // _TASKS, (task + 1) * rows // _TASKS):
            for e in range(row_start[r], row_start[r + 1]):
                table[column[e]] = e
            i = free[r]
            for e in range(start[i], start[i + 1]):
                t, c = corner[e] // 3, corner[e] % 3
                if areas[t] == 0.0:
                    continue
                for d in range(3):
                    j = place[F[t, d]]
                    at[d] = table[j] if j >= 0 else -1
                _add_triangle(
                    U,
                    F,
                    t,
                    c,
                    hats,
                    areas[t],
                    lame,
                    mu,
                    strains,
                    relaxed,
                    tensions[t],
                    pressure,
                    share,
                    at,
                    blocks,
                )
            for e in range(hinge_start[i], hinge_start[i + 1]):
                hinge, own = hinge_at[e] // 4, hinge_at[e] % 4
                x, y, z = J[hinge, own, 0], J[hinge, own, 1], J[hinge, own, 2]
                for f in range(q_start[hinge], q_start[hinge + 1]):
                    other, q = q_column[f], q_entry[f]
                    for d in range(4 if other < bent else 2):
                        j = place[hinges[other, d]]
                        if j < 0:
                            continue
                        block = blocks[table[j]]
                        for b in range(3):
                            w = q * J[other, d, b]
                            block[0, b] += x * w
                            block[1, b] += y * w
                            block[2, b] += z * w
                moment = share * moments[hinge] if hinge < bent else 0.0
                if moment != 0.0:
                    for d in range(4):
                        j = place[hinges[hinge, d]]
                        at[d] = table[j] if j >= 0 else -1
                    _add_hinge(U, hinges[hinge], own, moment, at, blocks)
    return blocks
