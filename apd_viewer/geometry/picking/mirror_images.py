"""Vertices at the mirror images of others."""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from apd_viewer.geometry.pose.mirror import MirrorPlane


def nearest_mirror_vertices(
    V: np.ndarray, ids: np.ndarray, candidates: np.ndarray, plane: MirrorPlane, reach: np.ndarray
) -> np.ndarray:
    """Vertex nearest to the mirror image of each of some vertices.

    Parameters
    ----------
    V : (n, 3) float array
    ids : (k,) int array
    candidates : (n,) bool array
        Vertices that count.
    plane : MirrorPlane
    reach : (k,) float array
        How far from the image each may be, mesh units.

    Returns
    -------
    (k,) int array
        -1 where none is within reach.
    """
    found = np.full(len(ids), -1)
    if not len(ids):
        return found
    images = plane.image(V[ids])
    low, high = images.min(axis=0) - reach.max(), images.max(axis=0) + reach.max()
    others = np.flatnonzero(candidates & ((low <= V) & (high >= V)).all(axis=1))
    if len(others):
        # Neither balanced nor compact: not worth it for a single query.
        tree = KDTree(V[others], balanced_tree=False, compact_nodes=False)
        distance, which = tree.query(images, workers=-1)
        near = distance <= reach
        found[near] = others[which[near]]
    return found
