"""Tubes in two halves, as programs export them: the two sides of a seam are not at one place."""

import numpy as np

from apd_viewer.geometry.mesh.arrays import diagonal


def half(first: float, around: int, along: int) -> tuple[np.ndarray, np.ndarray]:
    """Half of a tube of radius 1 and height 6, from an angle on."""
    angle, height = np.meshgrid(
        first + np.linspace(0.0, np.pi, around + 1), np.linspace(0.0, 6.0, along + 1), indexing="ij"
    )
    V = np.column_stack([np.cos(angle).ravel(), np.sin(angle).ravel(), height.ravel()])
    a = (np.arange(around)[:, None] * (along + 1) + np.arange(along)).ravel()
    b = a + along + 1
    return V, np.vstack([np.column_stack([a, b, b + 1]), np.column_stack([a, b + 1, a + 1])])


def halves(by: float = 0.0, along: tuple[int, int] = (12, 12), around: int = 6):
    """Two halves whose seams are ``by`` of the size apart; the vertices of the second come last."""
    (V, F), (W, G) = half(0.0, around, along[0]), half(np.pi, around, along[1])
    noise = np.random.default_rng(4).normal(size=W.shape)
    noise *= by * diagonal(np.vstack([V, W])) / np.linalg.norm(noise, axis=1)[:, None]
    return np.vstack([V, W + noise]), np.vstack([F, G + len(V)])


def twisted(V: np.ndarray, angle: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Held vertices, those of them that are the handle, and targets: the upper end turned."""
    low, high = V[:, 2].min(), V[:, 2].max()
    base, handle = np.flatnonzero(V[:, 2] < low + 0.01), np.flatnonzero(V[:, 2] > high - 0.01)
    c, s = np.cos(angle), np.sin(angle)
    turned = V[handle] @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]).T
    return np.r_[base, handle], handle, np.vstack([V[base], turned])
