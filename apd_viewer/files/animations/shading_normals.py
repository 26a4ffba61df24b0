"""Normals of a shape for shading, one per vertex."""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.normals import vertex_normals
from apd_viewer.geometry.mesh.triangle_frames import triangle_frames

_ANY = 0.0, 0.0, 1.0  # where there is no area: a normal has to have a direction


def shading_normals(mesh: Mesh, U: np.ndarray) -> np.ndarray:
    """Unit normals of the shape ``U`` (n, 3), (n, 3).

    Those of the file turned with their triangles, averaged where the corners of a vertex have several;
    without any those of a smooth surface, the same on both sides of a seam.
    """
    if mesh.corner_normals is None:
        N = vertex_normals(U, mesh.joined_F)[mesh.weld.representative]
    else:
        N = _turned(mesh, mesh.corner_normals.local, U)
    N[~N.any(axis=1)] = _ANY
    return N


def _turned(mesh: Mesh, local: np.ndarray, U: np.ndarray) -> np.ndarray:
    """Normals of the corners (m, 3, 3), in the frames of their triangles, summed."""
    corners = U[mesh.F]
    edges = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    weight = np.linalg.norm(np.cross(*edges), axis=1)[:, None, None]
    own = (weight * (local @ triangle_frames(corners))).reshape(-1, 3)
    N = np.column_stack([np.bincount(mesh.F.ravel(), x, len(U)) for x in own.T])
    length = np.linalg.norm(N, axis=1, keepdims=True)
    unit: np.ndarray = np.divide(N, length, out=np.zeros_like(N), where=length > 0.0)
    return unit
