"""Bending stiffness of the ARAP cells (Eq. 1), and the loads that it adds.

A cell compares its edges with turned straight ones. Bent to a curvature k along the direction u, an edge e
leaves the tangent plane by ``k (e . u)^2 / 2``, and the best rotation takes only what is linear in e from it:

    E_i = k^2 / 4 min_a sum_j w_ij ((e_ij . u)^2 - a . e_ij)^2 = D A_i k^2 / 2.

The mean over all directions u is 0.75 h^2 where all edges have the length h, and in a grid of squares of that
side; there it is h^2 along the sides, and half of that across.
"""

import numpy as np

from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.mesh.normals import vertex_normals
from apd_viewer.geometry.mesh.operators import cotangents, face_areas

# Determinant relative to the squared trace, below which parallel edges allow no fit.
_FLAT = 1e-12


def load_excess(material: Material, cells: float) -> float | None:
    """Expected relative overestimate of a bent wall's load, 0.1 for 10 %.

    None without stiffness: the load is that of the cells alone. 0 for a thin wall, which has no cells.

    Parameters
    ----------
    material : Material
    cells : float
        :func:`cell_stiffness` of the mesh.
    """
    if material.thickness:
        return 0.0
    return material.rigidity * cells / material.bending if material.bending > 0.0 else None


def cell_stiffness(V: np.ndarray, F: np.ndarray) -> float:
    """Bending stiffness of the ARAP cells (Eq. 1), mean over all directions.

    With the area A it is ``D / (2 A)``, as that of a material.

    Parameters
    ----------
    V : (n, 3) float array, rest positions
        One for each vertex of the solve: those at one position are joined.
    F : (m, 3) int array, triangles
    """
    a, b = F[:, [1, 2, 0]].ravel(), F[:, [2, 0, 1]].ravel()
    i, j = np.concatenate([a, b]), np.concatenate([b, a])
    w = np.tile(0.5 * np.maximum(cotangents(V, F), 0.0).ravel(), 2)
    x, y = _in_plane(V, F, i, V[j] - V[i])

    def sums(values: np.ndarray) -> np.ndarray:
        return np.bincount(i, w * values, minlength=len(V))

    square = x * x + y * y
    xx, xy, yy = sums(x * x), sums(x * y), sums(y * y)
    determinant = xx * yy - xy * xy
    sound = determinant > _FLAT * (xx + yy) ** 2
    energy = 0.375 * sums(square * square)
    # For u = (cos t, sin t), (e . u)^2 is half the dot product of these and (1, cos 2t, sin 2t).
    for part, share in ((square, 0.25), (x * x - y * y, 0.125), (2.0 * x * y, 0.125)):
        p, q = sums(part * x), sums(part * y)
        tilted = yy * p * p - 2.0 * xy * p * q + xx * q * q
        energy -= share * np.divide(tilted, determinant, out=np.zeros_like(tilted), where=sound)
    return 0.25 * float(energy.sum() / face_areas(V, F).sum() ** 2)


def _in_plane(V: np.ndarray, F: np.ndarray, i: np.ndarray, e: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates of edges ``e`` (k, 3) in the tangent planes of vertices ``i`` (k,)."""
    N = vertex_normals(V, F)
    along = np.cross(N, np.eye(3)[np.abs(N).argmin(axis=1)])
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), np.finfo(float).tiny)
    across = np.cross(N, along)
    return (e * along[i]).sum(axis=1), (e * across[i]).sum(axis=1)
