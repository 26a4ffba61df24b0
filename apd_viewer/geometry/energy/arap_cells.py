"""Kernels of the ARAP cells (Eq. 1): every vertex with its incident edges.

    E(U) = sum_i sum_{j in N(i)} w_ij |(u_i - u_j) - R_i (v_i - v_j)|^2                  (Eq. 1)

Every undirected edge counts twice, once in the cell of either end. The kernels divide the vertices among
the cores; edges and their weights are in compressed sparse rows, ``start, neighbour, w``. Rotations are unit
quaternions ``q`` (n, 4): to turn by one costs less than to fetch a matrix.
"""

import numpy as np
from numba import prange

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.rotations import (
    LANES,
    ROWS,
    fit_lanes,
    load_rotation,
    quaternion_to_matrix,
    rotated_vector,
    store_rotation,
)
from apd_viewer.geometry.linalg.threads import parallel, sum_of_portions

NO_MOMENTS = np.empty((0, 3, 3))
# Vertices per parallel task.
_PORTION = 32 * LANES


# Inlined: a call would update the reference counts of all arrays, three times the cost of its work.
@njit(inline="always")
def _load_cell(
    X: np.ndarray,
    lane: int,
    i: int,
    start: np.ndarray,
    neighbour: np.ndarray,
    w: np.ndarray,
    V: np.ndarray,
    U: np.ndarray,
    S0: np.ndarray,
) -> None:
    """Write the covariance ``S_i`` of cell ``i`` into a lane.

    ``S_i = S0_i + sum_j w_ij (u_i - u_j)(v_i - v_j)^T``.
    """
    s00 = s01 = s02 = s10 = s11 = s12 = s20 = s21 = s22 = 0.0
    if len(S0):
        s00, s01, s02 = S0[i, 0, 0], S0[i, 0, 1], S0[i, 0, 2]
        s10, s11, s12 = S0[i, 1, 0], S0[i, 1, 1], S0[i, 1, 2]
        s20, s21, s22 = S0[i, 2, 0], S0[i, 2, 1], S0[i, 2, 2]
    vx, vy, vz = V[i, 0], V[i, 1], V[i, 2]
    ux, uy, uz = U[i, 0], U[i, 1], U[i, 2]
    for e in range(start[i], start[i + 1]):
        j = neighbour[e]
        x, y, z = vx - V[j, 0], vy - V[j, 1], vz - V[j, 2]
        a, b, c = w[e] * (ux - U[j, 0]), w[e] * (uy - U[j, 1]), w[e] * (uz - U[j, 2])
        s00 += a * x
        s01 += a * y
        s02 += a * z
        s10 += b * x
        s11 += b * y
        s12 += b * z
        s20 += c * x
        s21 += c * y
        s22 += c * z
    X[lane], X[LANES + lane], X[2 * LANES + lane] = s00, s01, s02
    X[3 * LANES + lane], X[4 * LANES + lane], X[5 * LANES + lane] = s10, s11, s12
    X[6 * LANES + lane], X[7 * LANES + lane], X[8 * LANES + lane] = s20, s21, s22


@parallel(fastmath={"contract"})
def local_step(
    start: np.ndarray,
    neighbour: np.ndarray,
    w: np.ndarray,
    V: np.ndarray,
    U: np.ndarray,
    S0: np.ndarray,
    q: np.ndarray,
    energies: np.ndarray,
) -> None:
    """Set ``q`` (n, 4) to the optimal rotations for ``U``, warm-started.

    Parameters
    ----------
    V, U : (n, 3) float array
        Rest positions and positions.
    S0 : (n, 3, 3) or (0, 3, 3) float array
        What other terms than Eq. 1 say about the rotations, in ``tr(R_i^T S_i)``; FLAT where there are none.
    energies : (portions(n),) or (0,) float array
        Eq. 1 with those rotations is written there, in parts, while the cells are at hand.
    """
    n = len(V)
    for portion in prange((n + _PORTION - 1) // _PORTION):
        X, scratch = np.zeros(ROWS * LANES), np.empty((3, 4, 4))
        for first in range(portion * _PORTION, min(n, (portion + 1) * _PORTION), LANES):
            count = min(LANES, n - first)
            for lane in range(count):
                _load_cell(X, lane, first + lane, start, neighbour, w, V, U, S0)
                load_rotation(X, lane, q[first + lane])
            fit_lanes(X, scratch)
            for lane in range(count):
                store_rotation(X, lane, q[first + lane])
            if len(energies):
                for i in range(first, first + count):
                    energies[portion] += _cell_energy(i, start, neighbour, w, V, U, q)


def portion_count(n: int) -> int:
    """Number of portions for ``n`` cells."""
    return (n + _PORTION - 1) // _PORTION


@njit(inline="always")
def _cell_energy(
    i: int,
    start: np.ndarray,
    neighbour: np.ndarray,
    w: np.ndarray,
    V: np.ndarray,
    U: np.ndarray,
    q: np.ndarray,
) -> float:
    """ARAP energy of cell ``i``, its term of Eq. 1."""
    cell = 0.0
    for e in range(start[i], start[i + 1]):
        j = neighbour[e]
        x, y, z = rotated_vector(q, i, V[i, 0] - V[j, 0], V[i, 1] - V[j, 1], V[i, 2] - V[j, 2])
        a, b, c = U[i, 0] - U[j, 0] - x, U[i, 1] - U[j, 1] - y, U[i, 2] - U[j, 2] - z
        cell += w[e] * (a * a + b * b + c * c)
    return cell


@njit(cache=True, nogil=True)
def gauss_seidel_local_step(
    start: np.ndarray,
    neighbour: np.ndarray,
    w: np.ndarray,
    V: np.ndarray,
    U: np.ndarray,
    S0: np.ndarray,
    coupling: float,
    q: np.ndarray,
) -> None:
    """Gauss-Seidel local step with coupling of neighbouring rotations.

    The coupling energy is ``coupling / (2 deg i) sum_j |R_i - R_j|^2``. One sweep, as in CGAL [Levi & Gotsman
    2015, Smooth Rotation Enhanced As-Rigid-As-Possible Mesh Animation].
    """
    X, scratch, R = np.zeros(ROWS * LANES), np.empty((3, 4, 4)), np.empty((3, 3))
    for i in range(len(V)):
        _load_cell(X, 0, i, start, neighbour, w, V, U, S0)
        share = coupling / max(start[i + 1] - start[i], 1)
        for e in range(start[i], start[i + 1]):
            quaternion_to_matrix(q[neighbour[e]], R)
            for a in range(3):
                for b in range(3):
                    X[(3 * a + b) * LANES] += share * R[a, b]
        load_rotation(X, 0, q[i])
        fit_lanes(X, scratch)
        store_rotation(X, 0, q[i])


@parallel(fastmath={"contract"})
def right_hand_side(
    start: np.ndarray,
    neighbour: np.ndarray,
    w: np.ndarray,
    V: np.ndarray,
    LV: np.ndarray,
    q: np.ndarray,
    weight: float,
    added: np.ndarray,
    mult: np.ndarray,
    forces: np.ndarray,
    rows: np.ndarray,
    subtracted: np.ndarray,
) -> np.ndarray:
    """Rows (f, 3) of the right-hand side ``b`` of the global step, and further terms.

    They are ``b + added + sum_k mult_k forces_k - subtracted``, with ``b_i = weight * sum_j w_ij / 2 (R_i +
    R_j)(v_i - v_j)``; ``LV`` (n, 3) is the Laplacian of ``V``, what R_i is applied to. ``added`` is (n, 3),
    or (0, 3) without such a term; ``forces`` (k, n, 3); ``rows`` (f,); ``subtracted`` (f, 3). The gradient of
    the energy is ``4 (L U - b)``.
    """
    half = 0.5 * weight
    out = np.empty((len(rows), 3))
    for r in prange(len(rows)):
        i = rows[r]
        bx, by, bz = rotated_vector(q, i, LV[i, 0], LV[i, 1], LV[i, 2])
        vx, vy, vz = V[i, 0], V[i, 1], V[i, 2]
        for e in range(start[i], start[i + 1]):
            j = neighbour[e]
            x, y, z = rotated_vector(
                q, j, w[e] * (vx - V[j, 0]), w[e] * (vy - V[j, 1]), w[e] * (vz - V[j, 2])
            )
            bx += x
            by += y
            bz += z
        bx, by, bz = half * bx - subtracted[r, 0], half * by - subtracted[r, 1], half * bz - subtracted[r, 2]
        if len(added):
            bx, by, bz = bx + added[i, 0], by + added[i, 1], bz + added[i, 2]
        for k in range(len(mult)):
            bx += mult[k] * forces[k, i, 0]
            by += mult[k] * forces[k, i, 1]
            bz += mult[k] * forces[k, i, 2]
        out[r, 0], out[r, 1], out[r, 2] = bx, by, bz
    return out


@parallel(fastmath={"contract"})
def energy(
    start: np.ndarray, neighbour: np.ndarray, w: np.ndarray, V: np.ndarray, U: np.ndarray, q: np.ndarray
) -> float:
    """ARAP energy (Eq. 1) at ``U`` (n, 3) with the rotations ``q`` (n, 4)."""
    n = len(V)
    count = (n + _PORTION - 1) // _PORTION
    energies = np.zeros(count)
    for portion in prange(count):
        part = 0.0
        for i in range(portion * _PORTION, min(n, (portion + 1) * _PORTION)):
            part += _cell_energy(i, start, neighbour, w, V, U, q)
        energies[portion] = part
    return sum_of_portions(energies)


@parallel(fastmath={"contract"})
def quarter_gradient(
    start: np.ndarray,
    neighbour: np.ndarray,
    w: np.ndarray,
    V: np.ndarray,
    LV: np.ndarray,
    U: np.ndarray,
    q: np.ndarray,
    rows: np.ndarray,
) -> np.ndarray:
    """A quarter of the gradient (f, 3) of the ARAP energy (Eq. 1) at ``rows`` (f,).

    ``sum_j w_ij ((u_i - u_j) - 1/2 (R_i + R_j)(v_i - v_j))``; ``LV`` is as in :func:`right_hand_side`.
    """
    out = np.empty((len(rows), 3))
    for r in prange(len(rows)):
        i = rows[r]
        bx, by, bz = rotated_vector(q, i, LV[i, 0], LV[i, 1], LV[i, 2])
        a = b = c = 0.0
        for e in range(start[i], start[i + 1]):
            j = neighbour[e]
            x, y, z = rotated_vector(
                q, j, w[e] * (V[i, 0] - V[j, 0]), w[e] * (V[i, 1] - V[j, 1]), w[e] * (V[i, 2] - V[j, 2])
            )
            bx, by, bz = bx + x, by + y, bz + z
            a += w[e] * (U[i, 0] - U[j, 0])
            b += w[e] * (U[i, 1] - U[j, 1])
            c += w[e] * (U[i, 2] - U[j, 2])
        out[r, 0], out[r, 1], out[r, 2] = a - 0.5 * bx, b - 0.5 * by, c - 0.5 * bz
    return out
