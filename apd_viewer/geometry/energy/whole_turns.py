"""Turns of a surface as a whole, taken out of forces and of steps.

A step has none if it leaves ``sum_i m_i a_i x u_i``, with a the places at first about their centre [Eckart
1935, Some studies concerning rotating axes and polyatomic molecules]. That is a condition on shapes: told
from shape to shape instead, by places that change, surfaces would turn as a falling cat does.
"""

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
    first : (n, 3) float array
        The shape that it must not turn against.
    """

    def __init__(self, X: np.ndarray, masses: np.ndarray, first: np.ndarray) -> None:
        self._m = masses / masses.sum()
        self._away, self._first = X - self._m @ X, first - self._m @ first
        second = np.einsum("i,ij,ik->jk", self._m, self._away, self._first)
        self._per_moment = np.linalg.pinv(np.trace(second) * _AXES - second)

    def without(self, step: np.ndarray) -> np.ndarray:
        """``step`` (n, 3) less its turn of the shape."""
        turn = self._per_moment @ np.cross(self._first, self._m[:, None] * step).sum(axis=0)
        return step - np.cross(turn, self._away)

    def balanced(self, force: np.ndarray) -> np.ndarray:
        """``force`` (n, 3) less what turns the whole: the transpose of :meth:`without`."""
        turn = self._per_moment.T @ np.cross(self._away, force).sum(axis=0)
        return force - self._m[:, None] * np.cross(turn, self._first)
