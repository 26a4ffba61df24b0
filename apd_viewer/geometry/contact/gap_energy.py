"""Gap energy: repulsion between near parts of a surface.

A pair with the gap d and the range h has the energy ``h^2 f(d / h)`` with

    f(s) = -(1 - s)^2 ln s  for s < 1,  0 beyond,

the clamped logarithm of [Li, Ferguson, Schneider et al. 2020, Incremental potential contact, Eq. 6]. It is
twice continuously differentiable and grows without bound where a gap closes.
"""

import numpy as np

from apd_viewer.geometry.contact.distances import gap
from apd_viewer.geometry.linalg.kernels import njit

_CLOSED = 1e-12  # lower limit of the ratio of gap to range


@njit(cache=True, nogil=True)
def gap_energy(d: float, h: float) -> float:
    """Energy of a gap ``d`` below its range ``h``."""
    s = max(d / h, _CLOSED)
    return -h * h * (1.0 - s) * (1.0 - s) * np.log(s)


@njit(cache=True, nogil=True)
def gap_slope(d: float, h: float) -> float:
    """Derivative of the energy with respect to the gap."""
    s = max(d / h, _CLOSED)
    return h * (2.0 * (1.0 - s) * np.log(s) - (1.0 - s) * (1.0 - s) / s)


@njit(cache=True, nogil=True)
def gap_curvature(d: float, h: float) -> float:
    """Second derivative of the energy with respect to the gap."""
    s = max(d / h, _CLOSED)
    return -2.0 * np.log(s) + 4.0 * (1.0 - s) / s + (1.0 - s) * (1.0 - s) / (s * s)


@njit(cache=True, nogil=True)
def gap_gradient(
    U: np.ndarray,
    pairs: np.ndarray,
    is_edge_pair: np.ndarray,
    low: np.ndarray,
    reach: np.ndarray,
    radius: float,
) -> tuple[np.ndarray, int, float]:
    """Gradient (n, 3) of the energy, number of touching pairs, and smallest gap.

    Parameters
    ----------
    U : (n, 3) float array
    pairs : (p, 4) int array
    is_edge_pair : (p,) bool array
    low, reach : (p,) float arrays
        Lower bound of each gap, and the range of its energy.
    radius : float
        What is round ends so far before its points.
    """
    g = np.zeros_like(U)
    touching, least = 0, np.inf
    for p in range(len(pairs)):
        if low[p] >= reach[p]:
            continue
        apart, wa, wb, wc, wd = gap(U, pairs[p], is_edge_pair[p])
        d = apart - radius
        if d >= reach[p]:
            continue
        touching += 1
        least = min(least, d)
        a, b, c, e = pairs[p, 0], pairs[p, 1], pairs[p, 2], pairs[p, 3]
        force = gap_slope(d, reach[p]) / max(apart, _CLOSED * reach[p])
        for k in range(3):
            along = force * (wa * U[a, k] + wb * U[b, k] + wc * U[c, k] + wd * U[e, k])
            g[a, k] += wa * along
            g[b, k] += wb * along
            g[c, k] += wc * along
            g[e, k] += wd * along
    return g, touching, least


@njit(cache=True, nogil=True)
def gap_springs(
    U: np.ndarray, pairs: np.ndarray, is_edge_pair: np.ndarray, reach: np.ndarray, most: float, radius: float
) -> tuple[np.ndarray, np.ndarray]:
    """Isotropic springs ``k w w^T`` with the energy's curvature along the gap.

    Parameters
    ----------
    U, pairs, is_edge_pair, reach, radius
        See :func:`gap_gradient`; of pairs that are in touch.
    most : float
        The largest k.

    Returns
    -------
    k : (p,) float array
    w : (p, 4) float array
    """
    k, w = np.zeros(len(pairs)), np.zeros((len(pairs), 4))
    for p in range(len(pairs)):
        apart, w[p, 0], w[p, 1], w[p, 2], w[p, 3] = gap(U, pairs[p], is_edge_pair[p])
        d = apart - radius
        if d < reach[p]:
            k[p] = min(gap_curvature(d, reach[p]), most)
    return k, w
