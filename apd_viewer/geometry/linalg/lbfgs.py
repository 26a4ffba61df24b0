"""Limited-memory BFGS directions."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from apd_viewer.geometry.linalg import parallel_ops


class QuasiNewtonMemory:
    """Limited-memory quasi-Newton directions [Nocedal 1980], preconditioned.

    With the factor of the global step as preconditioner a first step is the plain one, and the following
    ones know what it leaves out [Liu, Bouaziz & Kavan 2017, Quasi-Newton methods for real-time simulation
    of hyperelastic materials].

    Parameters
    ----------
    count : int
        Number of variables, each a 3-vector.
    length : int
        Number of steps that are remembered.
    """

    def __init__(self, count: int, length: int) -> None:
        self._steps = np.empty((length, count, 3))
        self._changes = np.empty((length, count, 3))
        # Inner products of steps and changes, by slot.
        self._products = np.empty((length, length))
        self._order: list[int] = []

    def __len__(self) -> int:
        return len(self._order)

    def forget(self) -> None:
        """Start again."""
        self._order.clear()

    def learn(self, step: np.ndarray, change: np.ndarray) -> None:
        """Remember a ``step`` and the ``change`` of the gradient over it, both (count, 3).

        A step over which the slope fell says nothing that a minimum can be sought by, and is left out.
        """
        bend = float(parallel_ops.dots(step[None], change)[0])
        lengths = parallel_ops.dots(step[None], step)[0] * parallel_ops.dots(change[None], change)[0]
        if not bend > 1e-10 * np.sqrt(lengths):
            return
        full = len(self._order) == len(self._steps)
        place = self._order.pop(0) if full else len(self._order)
        self._steps[place], self._changes[place] = step, change
        self._order.append(place)
        count = len(self._order)
        self._products[place, :count] = parallel_ops.dots(self._changes[:count], step)
        self._products[:count, place] = parallel_ops.dots(self._steps[:count], change)

    def direction(self, gradient: np.ndarray, solve: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        """Descent direction for a ``gradient`` (count, 3), of length about 1.

        Parameters
        ----------
        solve : callable
            The preconditioner: the step for a gradient if nothing is remembered.
        """
        order, P, count = self._order, self._products, len(self._order)
        rest = -gradient
        if not order:
            return solve(rest)
        along = parallel_ops.dots(self._steps[:count], rest)
        first = np.zeros(count)
        for k, i in reversed(list(enumerate(order))):
            newer = order[k + 1 :]
            first[i] = (along[i] - sum(first[j] * P[i, j] for j in newer)) / P[i, i]
        parallel_ops.add(rest, -first, self._changes[:count])
        step = solve(rest)
        across = parallel_ops.dots(self._changes[:count], step)
        second = np.zeros(count)
        for k, i in enumerate(order):
            second[i] = first[i] - (across[i] + sum(second[j] * P[j, i] for j in order[:k])) / P[i, i]
        parallel_ops.add(step, second, self._steps[:count])
        return step
