"""Total curvature: distance of a surface from bending without stretching."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from apd_viewer.geometry.mesh.laplacian import cotangents, well_shaped
from apd_viewer.geometry.mesh.operators import boundary_vertices, vertex_neighbours

# Vertices on a cylinder, triangulated anyhow, have defects of both signs, 0.46 in total. So many steps of
# averaging leave 0.02 of them, and 1.0 of a tube whose vertices are off by a hundredth of its radius.
_STEPS = 30


def total_curvature(V: np.ndarray, F: np.ndarray) -> float:
    """Integral of the absolute Gauss curvature, of its means over neighbourhoods.

    4 pi for every convex closed surface, 0 for tubes, sheets and whatever else can be unrolled. The borders
    of an open surface do not count.

    Parameters
    ----------
    V : (n, 3) float array
        One for each vertex: those at one position are joined.
    F : (m, 3) int array, triangles
    """
    n, cot = len(V), cotangents(V, F)
    angles = np.where(well_shaped(cot)[:, None], np.arctan2(1.0, cot), 0.0)
    around = np.bincount(F.ravel(), angles.ravel(), n)
    defect = np.where(around > 0.0, 2.0 * np.pi - around, 0.0)
    defect[boundary_vertices(F, n)] = 0.0
    start, neighbour = vertex_neighbours(F, n)
    count = np.diff(start)
    handed = sp.csr_array((np.repeat(1.0 / np.maximum(count, 1), count), neighbour, start), shape=(n, n)).T
    for _ in range(_STEPS):
        defect = 0.5 * (defect + handed @ defect)
    return float(np.abs(defect).sum())
