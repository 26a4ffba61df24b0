"""One-sided penalty on triangles that lose most of their area.

    E(U) = 2 A sum_t max(0, 1 - a_t(U) / (0.3 A_t))^2,        a_t the area, A_t that at rest, A the total

Bending turns neighbouring triangles alike, and where sharp folds meet, single ones give way: a triangle
without area has no direction. Above three tenths of its area nothing acts. A triangle costs about as much as
a sharp fold at one of its vertices, so the penalty is a part of bending. It is continuously differentiable,
for a descent with a line search; its curvature, though bounded, grows as triangles get smaller, and no
matrix knows of it.
"""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry.linalg.parallel_ops import inner_product
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.mesh.weighted_areas import SLIVER

# Half of the weight left single triangles below a fifth of their area. A wall on its way to a smooth shape
# passes shapes that are squeezed: acting from half of the area on, the penalty led it into dearer folds.
_WEIGHT, _FROM = 2.0, 0.3
# Below this part of the area at rest a normal is rounding, and the force fades.
_FLAT = 1e-3


class AreaBarrier:
    """The penalty and its gradient.

    Parameters
    ----------
    V : (n, 3) float array, rest positions
    F : (m, 3) int array, triangles
        Slivers do not count.
    """

    def __init__(self, V: np.ndarray, F: np.ndarray) -> None:
        self._F, areas = F, face_areas(V, F)
        self._rest = np.where(areas > SLIVER * areas.mean(), areas, 0.0)
        self._least, self._weight = _FROM * self._rest, _WEIGHT * areas.sum()

    def energy(self, U: np.ndarray) -> float:
        """The penalty at ``U`` (n, 3), square mesh units."""
        missing = self._collapsing(U)[1]
        return float(self._weight * inner_product(missing, missing))

    def gradient(self, U: np.ndarray) -> np.ndarray:
        """Gradient at ``U`` (n, 3), (n, 3)."""
        (t, missing), out = self._collapsing(U), np.zeros_like(U)
        if len(t):
            F = self._F[t]
            X = U[F]
            normal = np.cross(X[:, 1] - X[:, 0], X[:, 2] - X[:, 0])
            double = np.linalg.norm(normal, axis=1)
            normal *= (
                -self._weight * missing / self._least[t] / np.maximum(double, 2.0 * _FLAT * self._rest[t])
            )[:, None]
            np.add.at(out, F, np.cross(normal[:, None, :], X[:, [2, 0, 1]] - X[:, [1, 2, 0]]))
        return out

    def _collapsing(self, U: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Triangles that collapse, and how far, from 0 to 1."""
        areas = face_areas(U, self._F)
        t = np.flatnonzero(areas < self._least)
        return t, 1.0 - areas[t] / self._least[t]
