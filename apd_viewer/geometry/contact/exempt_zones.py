"""Zones around triangles that cross at rest, where contact keeps nothing apart."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

# Rings of triangles around those that cross.
_RINGS = 3


def is_near_crossing(F: np.ndarray, crossing: np.ndarray, n: int) -> np.ndarray:
    """Mask (n,) of the vertices within a few rings of the ``crossing`` triangles (k,)."""
    near = np.zeros(n, bool)
    near[F[crossing]] = True
    for _ in range(_RINGS):
        near[F[near[F].any(axis=1)]] = True
    return near


def exempt_zones(F: np.ndarray, pairs: np.ndarray | None, n: int) -> np.ndarray:
    """Number of the zone of each vertex, from 1; 0 for none.

    What crosses is in one zone, and so is what is connected with it within a few rings. Zones of different
    places are kept apart.

    Parameters
    ----------
    F : (m, 3) int array
    pairs : (p, 2) int array or None
        Triangles that cross at rest.
    n : int
        Number of the vertices.

    Returns
    -------
    (n,) int array
    """
    if pairs is None or not len(pairs):
        return np.zeros(n, np.int64)
    near = is_near_crossing(F, pairs.ravel(), n)
    whole = F[near[F].all(axis=1)]
    a = np.concatenate([whole[:, 0], whole[:, 1], F[pairs[:, 0], 0]])
    b = np.concatenate([whole[:, 1], whole[:, 2], F[pairs[:, 1], 0]])
    _, place = connected_components(sp.coo_array((np.ones(len(a)), (a, b)), shape=(n, n)), directed=False)
    zone = np.zeros(n, np.int64)
    zone[near] = np.unique(place[near], return_inverse=True)[1] + 1
    return zone


def is_within_zone(zone: np.ndarray) -> np.ndarray:
    """Mask (p,) of pairs of triangles that share a zone, by their corners (p, 2, 3).

    At the rim a triangle of a zone is crossed by those with one corner in it.
    """
    same = zone[:, 0, :, None] == zone[:, 1, None, :]
    return (same & (zone[:, 0, :, None] > 0)).any(axis=(1, 2))
