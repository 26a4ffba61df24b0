"""Turns of a surface as a whole, taken out of forces, of steps and of shapes.

A shape has none if it leaves ``sum_i m_i a_i x u_i``, with a the places at first about their centre [Eckart
1935, Some studies concerning rotating axes and polyatomic molecules]. That is a condition on shapes: told
from shape to shape instead, by places that change, surfaces would turn as a falling cat does. What keeps it
does no work, so that loads stay derivatives of the energy.
"""

from __future__ import annotations

import numpy as np

_AXES = np.eye(3)


class OverallRotation:
    """Turns about the centre of a shape.

    Parameters
    ----------
    X : (n, 3) float array
        The shape.
    masses : (n,) float array
    first : (n, 3) float array
        The shape that it must not turn against.
    weight : (n,) array, optional
        How far each place turns when turns are taken out, relative to the others; without, all do alike.
    """

    def __init__(
        self, X: np.ndarray, masses: np.ndarray, first: np.ndarray, weight: np.ndarray | None = None
    ) -> None:
        m = masses / masses.sum()
        self._away, self._first = X - _mean(m, X), m[:, None] * (first - _mean(m, first))
        if weight is not None:
            self._away *= weight[:, None]
        second = _products(self._away, self._first)
        self._per_moment = np.linalg.pinv(np.trace(second) * _AXES - second)

    def without_rotation(self, step: np.ndarray) -> np.ndarray:
        """``step`` (n, 3), or the shape itself, without its overall rotation."""
        turn = self._per_moment @ _moment(self._first, step)
        return step - self._away @ _turned_by(turn)

    def without_torque(self, force: np.ndarray) -> np.ndarray:
        """``force`` (n, 3) without its torque: transpose of :meth:`without_rotation`."""
        turn = self._per_moment.T @ _moment(self._away, force)
        return force - self._first @ _turned_by(turn)


def _moment(X: np.ndarray, Y: np.ndarray) -> np.ndarray:
    """Sum (3,) of the cross products of rows."""
    P = _products(X, Y)
    return np.array([P[1, 2] - P[2, 1], P[2, 0] - P[0, 2], P[0, 1] - P[1, 0]])


def _turned_by(turn: np.ndarray) -> np.ndarray:
    """The matrix (3, 3) whose products with rows are ``turn x row``."""
    return np.cross(turn, _AXES)


# Without BLAS, whose sums depend on its number of threads.


def _mean(m: np.ndarray, X: np.ndarray) -> np.ndarray:
    return np.einsum("i,ij->j", m, X)


def _products(X: np.ndarray, Y: np.ndarray) -> np.ndarray:
    return np.einsum("ij,ik->jk", X, Y)
