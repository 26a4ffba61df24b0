"""Collision times: collision-free fractions of a step for near pairs.

Additive continuous collision detection [Li, Kaufman & Jiang 2021, Codimensional incremental potential
contact, Algorithm 1]: no step is longer than the gap that is left, divided by the motion of the two parts of
a pair about their mean.
"""

import numpy as np
from numba import prange

from apd_viewer.geometry.contact.distances import gap
from apd_viewer.geometry.contact.gap_energy import gap_energy
from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.threads import parallel, sum_of_portions

# Smallest fraction of a gap left after a step.
LEAST_GAP_FRACTION = 0.1
# Fraction of the known collision-free motion used at once; shorter advances end the search.
_TAKEN = 0.9
_SHORTEST = 1e-9
_MOST_STEPS = 400
_PORTION = 1024
# Motions of more gaps than this, as of neighbours in slivers, get the finer strain bound.
_MANY = 8.0
# Ridge relative to the trace of the moments, which are singular for coplanar points.
_THIN = 1e-12


@njit(cache=True, nogil=True)
def _squared_displacement(U: np.ndarray, W: np.ndarray, v: int, x: float, y: float, z: float) -> float:
    """Squared length of a vertex's displacement relative to (x, y, z)."""
    dx, dy, dz = W[v, 0] - U[v, 0] - x, W[v, 1] - U[v, 1] - y, W[v, 2] - U[v, 2] - z
    return dx * dx + dy * dy + dz * dz


@njit(cache=True, nogil=True)
def _relative_motion(U: np.ndarray, W: np.ndarray, pair: np.ndarray, edges: bool) -> float:
    """Upper bound of the approach of a pair's two parts from ``U`` to ``W``."""
    a, b, c, d = pair[0], pair[1], pair[2], pair[3]
    x = 0.25 * (W[a, 0] - U[a, 0] + W[b, 0] - U[b, 0] + W[c, 0] - U[c, 0] + W[d, 0] - U[d, 0])
    y = 0.25 * (W[a, 1] - U[a, 1] + W[b, 1] - U[b, 1] + W[c, 1] - U[c, 1] + W[d, 1] - U[d, 1])
    z = 0.25 * (W[a, 2] - U[a, 2] + W[b, 2] - U[b, 2] + W[c, 2] - U[c, 2] + W[d, 2] - U[d, 2])
    one, other = _squared_displacement(U, W, a, x, y, z), _squared_displacement(U, W, b, x, y, z)
    third = max(_squared_displacement(U, W, c, x, y, z), _squared_displacement(U, W, d, x, y, z))
    if edges:
        return np.sqrt(max(one, other)) + np.sqrt(third)
    return np.sqrt(one) + np.sqrt(max(other, third))


@njit(cache=True, nogil=True)
def _strain_and_remainder(X: np.ndarray, D: np.ndarray, edges: bool) -> tuple[float, float]:
    """Coefficients of the bound ``strain * gap + remainder`` on a pair's closing rate.

    An affine motion ``x + t A x`` shortens no distance faster than by the norm of the symmetric part of
    ``A``. Only what it leaves of the displacements ``D`` (4, 3) brings the two parts of the pair together as
    if they moved freely: little where neighbours on the surface turn or stretch as one.
    """
    x, d = _centred(X), _centred(D)
    moments, affine = np.zeros((3, 3)), np.zeros((3, 3))
    for k in range(4):
        for a in range(3):
            for b in range(3):
                moments[a, b] += x[k, a] * x[k, b]
                affine[a, b] += x[k, a] * d[k, b]
    # Coplanar points make the moments singular.
    ridge = _THIN * (moments[0, 0] + moments[1, 1] + moments[2, 2])
    for a in range(3):
        moments[a, a] += ridge
    _solve_three(moments, affine)
    squares, r = 0.0, np.zeros(4)
    for a in range(3):
        for b in range(3):
            squares += (affine[a, b] + affine[b, a]) ** 2
    for k in range(4):
        for b in range(3):
            left = d[k, b] - x[k, 0] * affine[0, b] - x[k, 1] * affine[1, b] - x[k, 2] * affine[2, b]
            r[k] += left * left
    strain, r = 0.5 * np.sqrt(squares), np.sqrt(r)
    if edges:
        return strain, max(r[0], r[1]) + max(r[2], r[3])
    return strain, r[0] + max(r[1], r[2], r[3])


@njit(cache=True, nogil=True)
def _centred(X: np.ndarray) -> np.ndarray:
    """Four points relative to their centroid."""
    out = np.empty((4, 3))
    for c in range(3):
        centre = 0.25 * (X[0, c] + X[1, c] + X[2, c] + X[3, c])
        for k in range(4):
            out[k, c] = X[k, c] - centre
    return out


@njit(cache=True, nogil=True)
def _solve_three(A: np.ndarray, B: np.ndarray) -> None:
    """Solve ``A X = B`` for three unknowns, in place; ``A`` is positive definite."""
    for k in range(3):
        for i in range(k + 1, 3):
            factor = A[i, k] / A[k, k]
            for j in range(3):
                A[i, j] -= factor * A[k, j]
                B[i, j] -= factor * B[k, j]
    for k in range(2, -1, -1):
        for j in range(3):
            for i in range(k + 1, 3):
                B[k, j] -= A[k, i] * B[i, j]
            B[k, j] /= A[k, k]


@njit(cache=True, nogil=True)
def _free_fraction(
    U: np.ndarray, W: np.ndarray, pair: np.ndarray, edges: bool, d: float, floor: float, motion: float
) -> float:
    """Fraction of a step keeping a tenth of the clearance ``d - floor``."""
    wanted = LEAST_GAP_FRACTION * (d - floor)
    X, D, own = np.empty((4, 3)), np.empty((4, 3)), np.arange(4)
    for k in range(4):
        for c in range(3):
            X[k, c] = U[pair[k], c]
            D[k, c] = W[pair[k], c] - X[k, c]
    # Up to rounding, the first advance leaves the wanted gap.
    fraction, left, part = 0.0, d - floor, 1.0 - LEAST_GAP_FRACTION
    for _ in range(_MOST_STEPS):
        rate = motion
        if motion > _MANY * left:
            strain, rest = _strain_and_remainder(X, D, edges)
            rate = min(motion, strain * (left + floor) + rest)
        if rate == 0.0:
            return 1.0  # the pair does not approach, even if its gap is below the floor
        step = part * left / max(rate, part * left)
        if step < _SHORTEST:
            return fraction
        tried = min(1.0, fraction + step)
        for k in range(4):
            for c in range(3):
                X[k, c] = U[pair[k], c] + tried * D[k, c]
        left = gap(X, own, edges)[0] - floor
        if left < wanted and fraction > 0.0:
            return fraction
        fraction, part = tried, _TAKEN
        if fraction >= 1.0:
            return fraction
    return fraction


@parallel()
def detect_collisions(
    U: np.ndarray,
    W: np.ndarray,
    margin: float,
    pairs: np.ndarray,
    is_edge_pair: np.ndarray,
    low: np.ndarray,
    reach: np.ndarray,
    floor: np.ndarray,
    approach: np.ndarray,
    owner: np.ndarray,
    low_after: np.ndarray,
    fraction: np.ndarray,
    radius: float,
) -> tuple[float, int]:
    """Detect collisions in a step from ``U`` to ``W``; write collision-free fractions.

    Parameters
    ----------
    U, W : (n, 3) float arrays
    margin : float
        Lower bounds that are not so much above the range are replaced by the gaps.
    pairs : (p, 4) int array
    is_edge_pair : (p,) bool array
    low : (p,) float array
        Lower bounds of the gaps at ``U``; improved where they are needed.
    reach, floor : (p,) float arrays
        Range of the energy of each pair, and the gap that no step goes below.
    approach : (k,) float array
        Bound of how much nearer the parts of every pair of an owner come.
    owner : (p,) int array
    low_after, fraction : (p,) float arrays
        Written into: lower bounds of the gaps at ``W``, and the collision-free fraction of the step.
    radius : float
        Radius of a rounded obstacle: gaps are smaller than distances from its points by this amount.

    Returns
    -------
    energy : float
        Per stiffness, at ``W``.
    blocking : int
        Number of pairs that block the step.
    """
    count = (len(pairs) + _PORTION - 1) // _PORTION
    energies, blocked = np.zeros(count), np.zeros(count, np.int64)
    for portion in prange(count):
        for p in range(portion * _PORTION, min(len(pairs), (portion + 1) * _PORTION)):
            motion = approach[owner[p]]
            fraction[p], low_after[p] = 1.0, low[p] - motion
            if low_after[p] >= reach[p] + margin:
                continue
            motion = min(motion, _relative_motion(U, W, pairs[p], is_edge_pair[p]))
            low_after[p] = low[p] - motion
            if low_after[p] >= reach[p] + margin:
                continue
            if motion > (1.0 - LEAST_GAP_FRACTION) * (low[p] - floor[p]):
                low[p] = gap(U, pairs[p], is_edge_pair[p])[0] - radius
                if motion > (1.0 - LEAST_GAP_FRACTION) * (low[p] - floor[p]):
                    d, least = low[p] + radius, floor[p] + radius
                    fraction[p] = _free_fraction(U, W, pairs[p], is_edge_pair[p], d, least, motion)
                    blocked[portion] += fraction[p] < 1.0
            low_after[p] = gap(W, pairs[p], is_edge_pair[p])[0] - radius
            if low_after[p] < reach[p]:
                energies[portion] += gap_energy(low_after[p], reach[p])
    return sum_of_portions(energies), sum_of_portions(blocked)
