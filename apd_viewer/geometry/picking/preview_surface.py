"""A mesh as it is drawn before there is more than numpy to draw it with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Sketch:
    """Stands in for a :class:`Skin` until there is one: to be seen, not touched.

    Attributes
    ----------
    F : (m, 3) int array
    """

    F: np.ndarray
    copied = np.empty(0, dtype=np.int32)

    def rendered(self, sharp: bool, filed: bool = False) -> Sketch:  # noqa: ARG002
        """The sketch itself, always smooth."""
        return self

    def drape(
        self, U: np.ndarray, origin: np.ndarray, points: np.ndarray, normals: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Write the renderer's arrays for the shape ``U``; see ``RenderMesh.drape``."""
        corners = U[self.F]
        a, b, c = corners.transpose(1, 0, 2)
        across = np.repeat(np.cross(b - a, c - a), 3, axis=0)
        N = np.column_stack([np.bincount(self.F.ravel(), x, len(U)) for x in across.T])
        length = np.linalg.norm(N, axis=1, keepdims=True)
        points[:] = U - origin
        normals[:] = np.divide(N, length, out=np.zeros_like(N), where=length > 0)
        return corners.min(axis=(0, 1)) - origin, corners.max(axis=(0, 1)) - origin
