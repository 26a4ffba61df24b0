"""Orthonormal frames of triangles."""

from __future__ import annotations

import numpy as np


def triangle_frames(corners: np.ndarray) -> np.ndarray:
    """Frame of each triangle: along its first edge, across it, and its normal.

    Parameters
    ----------
    corners : (m, 3, 3) float array
        Positions of the corners.

    Returns
    -------
    (m, 3, 3) float array
        Zero for a triangle without area.
    """
    along = corners[:, 1] - corners[:, 0]
    normal = _unit(np.cross(along, corners[:, 2] - corners[:, 0]))
    along = np.where(normal.any(axis=1, keepdims=True), _unit(along), 0.0)
    return np.stack([along, np.cross(normal, along), normal], axis=1)


def _unit(X: np.ndarray) -> np.ndarray:
    size = np.linalg.norm(X, axis=1, keepdims=True)
    return np.divide(X, size, out=np.zeros_like(X), where=size > 0.0)
