"""Limited-memory BFGS directions."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from apd_viewer.geometry.linalg import lbfgs_kernels

# A step over which the slope fell says nothing that a minimum can be sought by.
_BENDS = 1e-10


class LbfgsMemory:
    """Limited-memory quasi-Newton directions [Nocedal 1980], preconditioned.

    With the factor of the global step as preconditioner a first step is the plain one, and the following
    ones know what it leaves out [Liu, Bouaziz & Kavan 2017, Quasi-Newton methods for real-time simulation
    of hyperelastic materials]. Directions only lead somewhere, so what they are made of is kept in single
    precision: half the memory to read.

    Parameters
    ----------
    count : int
        Number of variables, each a 3-vector.
    length : int
        Number of steps that are remembered.
    """

    def __init__(self, count: int, length: int) -> None:
        # One more than are remembered: the step under way.
        shape = length + 1, 3 * count
        self._steps, self._changes = np.empty(shape, np.float32), np.empty(shape, np.float32)
        self._length, self._next = length, 0
        # Inner products of steps and changes, by slot.
        self._products = np.zeros((length + 1, length + 1))
        self._order: list[int] = []

    def __len__(self) -> int:
        return len(self._order)

    def clear(self) -> None:
        """Start again."""
        self._order.clear()

    def note_step(self, before: np.ndarray, after: np.ndarray, rows: np.ndarray) -> None:
        """Note the step between ``rows`` (count,) of two shapes, both (n, 3)."""
        used = set(self._order)
        self._next = next(slot for slot in range(self._length + 1) if slot not in used)
        lbfgs_kernels.subtract_rows(after, before, rows, self._steps[self._next])

    def store_gradients(self, slope: np.ndarray, before: np.ndarray) -> None:
        """Remember the last step with the slopes (count, 3) after and before it.

        A step over which the slope fell is left out.
        """
        slot = self._next
        step, change = self._steps[slot], self._changes[slot]
        bend, step2, change2 = lbfgs_kernels.subtract(slope.ravel(), before.ravel(), step, change)
        if not bend > _BENDS * np.sqrt(step2 * change2):
            return
        if len(self._order) == self._length:
            self._order.pop(0)
        self._order.append(slot)
        order = np.array(self._order)
        with_change, with_step = np.split(lbfgs_kernels.products(self._steps, self._changes, order, slot), 2)
        self._products[order, slot], self._products[slot, order] = with_change, with_step

    def descent_direction(
        self, slope: np.ndarray, solve: Callable[[np.ndarray], np.ndarray]
    ) -> tuple[np.ndarray, float]:
        """Descent direction (count, 3), of length about 1, and the slope along it.

        Parameters
        ----------
        slope : (count, 3) float array
        solve : callable
            The preconditioner: the step for a gradient if nothing is remembered.
        """
        P, order = self._products, np.array(self._order, dtype=np.int64)
        first, second = np.zeros(len(order)), np.zeros(len(order))
        flat = slope.ravel()
        along = -lbfgs_kernels.dots(self._steps, order, flat)
        for k in range(len(order) - 1, -1, -1):
            i, newer = order[k], order[k + 1 :]
            first[k] = (along[k] - first[k + 1 :] @ P[i, newer]) / P[i, i]
        force = lbfgs_kernels.negative_combination(flat, first, self._changes, order)
        way = solve(force.reshape(slope.shape))
        across = lbfgs_kernels.dots(self._changes, order, way.ravel())
        for k in range(len(order)):
            i, older = order[k], order[:k]
            second[k] = first[k] - (across[k] + second[:k] @ P[older, i]) / P[i, i]
        return way, lbfgs_kernels.add_combination(way.ravel(), second, self._steps, order, flat)
