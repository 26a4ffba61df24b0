"""Guess of the up axis by the flat foot of a mesh."""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.up_axis import UpAxis

_FLAT = 0.005  # depth of a foot, as a fraction of the diagonal of the bounding box
_WIDE = 0.3  # least area of a foot, as a fraction of the side of the bounding box that it lies on
_UNLIKE = 0.5  # largest area of the opposite end, as a fraction of that of the foot
_CUSTOMARY = UpAxis.PLUS_Y, UpAxis.PLUS_Z  # files have one or the other
_MOST_FACES = 300_000  # more would keep the window waiting


def standing_axis(mesh: Mesh) -> UpAxis | None:
    """Up axis for which a mesh stands on a flat foot, or None where that is not plain.

    It is +Y or +Z. A box, a can and a sphere have none: a foot is wide, and the opposite end is not.
    """
    if len(mesh.F) > _MOST_FACES:
        return None
    points = mesh.V[mesh.F]  # (m, 3, 3)
    across = 0.5 * np.abs(np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]))
    low, high = points.min(axis=(0, 1)), points.max(axis=(0, 1))
    depth = _FLAT * float(np.linalg.norm(high - low))
    at_low = (points <= low + depth).all(axis=1)  # (m, 3): triangles at the end of each axis
    at_high = (points >= high - depth).all(axis=1)
    ends = np.array([(across * at_low).sum(axis=0), (across * at_high).sum(axis=0)])
    sides = np.prod(high - low) / np.maximum(high - low, 1e-300)
    found = [
        axis
        for axis in _CUSTOMARY
        for foot, top in [ends[:, axis.index]]
        if foot >= _WIDE * sides[axis.index] > 0.0 and top <= _UNLIKE * foot
    ]
    return found[0] if len(found) == 1 else None
