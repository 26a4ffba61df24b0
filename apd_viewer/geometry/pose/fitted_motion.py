"""Motion that fits two sets of points best."""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry.pose.transforms import linear_map_about, translation

# Width over length of points that tell no rotation about the line through them.
_LINE = 1e-6


def fitted_motion(X: np.ndarray, Y: np.ndarray) -> np.ndarray:
    """Similarity transform (4, 4) from ``X`` (k, 3) to ``Y`` by least squares.

    [Umeyama 1991, Least-squares estimation of transformation parameters between two point patterns]. Points
    that coincide are only translated.
    """
    centre, target = X.mean(axis=0), Y.mean(axis=0)
    x, y = X - centre, Y - target
    left, sizes, right = np.linalg.svd(y.T @ x)
    signs = np.array([1.0, 1.0, np.linalg.det(left @ right)])
    spread = float((x * x).sum())
    scale = float(sizes @ signs) / spread if spread > 0.0 else 1.0
    linear = (left * signs) @ right
    fitted: np.ndarray = translation(target - centre) @ linear_map_about(centre, (scale or 1.0) * linear)
    return fitted


def fitted_rotation(X: np.ndarray, Y: np.ndarray) -> np.ndarray | None:
    """Rotation (3, 3) from ``X`` (k, 3) to ``Y`` by least squares; None of a line."""
    if len(X) < 3:
        return None
    sizes = np.linalg.svd(X - X.mean(axis=0), compute_uv=False)
    if sizes[1] <= _LINE * sizes[0]:
        return None
    linear = fitted_motion(X, Y)[:3, :3]
    rotation: np.ndarray = linear / np.cbrt(np.linalg.det(linear))
    return rotation
