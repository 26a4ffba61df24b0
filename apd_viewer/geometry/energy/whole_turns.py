"""Turns of a surface as a whole, taken out of forces and of steps."""

from __future__ import annotations

import numpy as np

_AXES = np.eye(3)


class WholeTurns:
    """Turns about the centre of a shape.

    Parameters
    ----------
    X : (n, 3) float array
        The shape.
    masses : (n,) float array
    """

    def __init__(self, X: np.ndarray, masses: np.ndarray) -> None:
        self._m = masses / masses.sum()
        self._away = X - self._m @ X
        second = np.einsum("i,ij,ik->jk", self._m, self._away, self._away)
        self._inertia = np.linalg.pinv(np.trace(second) * _AXES - second)

    def without(self, step: np.ndarray) -> np.ndarray:
        """``step`` (n, 3) less its mean turn."""
        turn = self._inertia @ np.cross(self._away, self._m[:, None] * step).sum(axis=0)
        return step - np.cross(turn, self._away)

    def balanced(self, force: np.ndarray) -> np.ndarray:
        """``force`` (n, 3) less what turns the whole: the transpose of :meth:`without`."""
        turn = self._inertia @ np.cross(self._away, force).sum(axis=0)
        return force - self._m[:, None] * np.cross(turn, self._away)
