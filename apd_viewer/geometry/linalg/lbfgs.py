"""Limited-memory BFGS directions.

In the kernels ``A`` (l, m) are steps or gradient changes in single precision, ``order`` (k,) those that
count. Sums are made in double precision and in portions of a fixed length, so they are the same on any number
of cores.
"""

from collections.abc import Callable

import numpy as np
from numba import prange

from apd_viewer.geometry.linalg.threads import parallel, sum_of_portions, sums_of_portions

# Smallest relative curvature of a remembered step: without positive curvature it leads to no minimum.
_BENDS = 1e-10


class LbfgsMemory:
    """Limited-memory quasi-Newton directions [Nocedal 1980], preconditioned.

    With the factor of the global step as preconditioner, the first step is a global step, and the following
    ones correct what it leaves out [Liu, Bouaziz & Kavan 2017, Quasi-Newton methods for real-time simulation
    of hyperelastic materials]. Directions need no high precision, so steps and gradient changes are kept in
    single precision: half the memory to read.

    Parameters
    ----------
    count : int
        Number of variables, each a 3-vector.
    length : int
        Number of steps that are remembered.
    """

    def __init__(self, count: int, length: int) -> None:
        # One slot more than remembered steps, for the step in progress.
        shape = length + 1, 3 * count
        self._steps, self._changes = np.empty(shape, np.float32), np.empty(shape, np.float32)
        self._length, self._next = length, 0
        # Inner products of steps and gradient changes, by slot.
        self._products = np.zeros((length + 1, length + 1))
        self._order: list[int] = []

    def __len__(self) -> int:
        return len(self._order)

    def clear(self) -> None:
        """Forget all steps."""
        self._order.clear()

    def record_step(self, before: np.ndarray, after: np.ndarray, rows: np.ndarray) -> None:
        """Record the step between ``rows`` (count,) of two shapes, both (n, 3)."""
        used = set(self._order)
        self._next = next(slot for slot in range(self._length + 1) if slot not in used)
        subtract_rows(after, before, rows, self._steps[self._next])

    def store_gradients(self, slope: np.ndarray, before: np.ndarray) -> None:
        """Complete the recorded step with the gradients (count, 3) after and before it.

        A step over which the slope fell is left out.
        """
        slot = self._next
        step, change = self._steps[slot], self._changes[slot]
        bend, step2, change2 = subtract_with_products(slope.ravel(), before.ravel(), step, change)
        if not bend > _BENDS * np.sqrt(step2 * change2):
            return
        if len(self._order) == self._length:
            self._order.pop(0)
        self._order.append(slot)
        order = np.array(self._order)
        with_change, with_step = np.split(products(self._steps, self._changes, order, slot), 2)
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
        along = -dots(self._steps, order, flat)
        for k in range(len(order) - 1, -1, -1):
            i, newer = order[k], order[k + 1 :]
            first[k] = (along[k] - first[k + 1 :] @ P[i, newer]) / P[i, i]
        force = negative_combination(flat, first, self._changes, order)
        way = solve(force.reshape(slope.shape))
        across = dots(self._changes, order, way.ravel())
        for k in range(len(order)):
            i, older = order[k], order[:k]
            second[k] = first[k] - (across[k] + second[:k] @ P[older, i]) / P[i, i]
        return way, add_combination(way.ravel(), second, self._steps, order, flat)


# Numbers per parallel task: a portion of one array stays in cache while another one is read.
_PORTION = 6144
# Sums within a portion may be reordered, but in the same order each time.
_SUMS = {"contract", "reassoc", "nsz"}


@parallel()
def subtract_rows(A: np.ndarray, B: np.ndarray, rows: np.ndarray, out: np.ndarray) -> None:
    """Write ``rows`` of ``A - B`` (n, 3) into ``out`` (3 len(rows),)."""
    for k in prange(len(rows)):
        i = rows[k]
        for d in range(3):
            out[3 * k + d] = A[i, d] - B[i, d]


@parallel(fastmath=_SUMS)
def subtract_with_products(A: np.ndarray, B: np.ndarray, step: np.ndarray, out: np.ndarray) -> np.ndarray:
    """Write ``y = A - B`` (m,) into ``out``; return ``y . s``, ``s . s``, ``y . y``.

    That is, the products of ``A - B`` with ``step`` (m,), of ``step`` with itself, and of ``A - B`` with
    itself.
    """
    count = (len(A) + _PORTION - 1) // _PORTION
    sums = np.zeros((count, 3))
    for portion in prange(count):
        first, end = portion * _PORTION, (portion + 1) * _PORTION
        u, v, s, y = A[first:end], B[first:end], step[first:end], out[first:end]
        a = b = c = 0.0
        for i in range(len(u)):
            y[i] = u[i] - v[i]
            difference = np.float64(y[i])
            a += difference * s[i]
            b += np.float64(s[i]) * s[i]
            c += difference * difference
        sums[portion, 0], sums[portion, 1], sums[portion, 2] = a, b, c
    return sums_of_portions(sums)


@parallel(fastmath=_SUMS)
def products(steps: np.ndarray, changes: np.ndarray, order: np.ndarray, slot: int) -> np.ndarray:
    """Inner products (2 k,) of steps with a slot's change, and changes with its step."""
    count = (steps.shape[1] + _PORTION - 1) // _PORTION
    sums = np.zeros((count, 2 * len(order)))
    for portion in prange(count):
        first, end = portion * _PORTION, (portion + 1) * _PORTION
        step, change = steps[slot, first:end], changes[slot, first:end]
        for k in range(len(order)):
            s, y, a, b = steps[order[k], first:end], changes[order[k], first:end], 0.0, 0.0
            for i in range(len(step)):
                a += np.float64(s[i]) * change[i]
                b += np.float64(y[i]) * step[i]
            sums[portion, k], sums[portion, len(order) + k] = a, b
    return sums_of_portions(sums)


@parallel(fastmath=_SUMS)
def dots(A: np.ndarray, order: np.ndarray, X: np.ndarray) -> np.ndarray:
    """Inner products (k,) of rows of ``A`` with ``X`` (m,)."""
    count = (len(X) + _PORTION - 1) // _PORTION
    sums = np.zeros((count, len(order)))
    for portion in prange(count):
        first, end = portion * _PORTION, (portion + 1) * _PORTION
        x = X[first:end]
        for k in range(len(order)):
            a, along = A[order[k], first:end], 0.0
            for i in range(len(x)):
                along += a[i] * x[i]
            sums[portion, k] = along
    return sums_of_portions(sums)


@parallel(fastmath={"contract"})
def negative_combination(X: np.ndarray, c: np.ndarray, A: np.ndarray, order: np.ndarray) -> np.ndarray:
    """Combination ``-X - sum_k c_k A_k`` of ``X`` (m,) and rows of ``A``."""
    out = np.empty_like(X)
    for portion in prange((len(X) + _PORTION - 1) // _PORTION):
        first, end = portion * _PORTION, (portion + 1) * _PORTION
        x, y = X[first:end], out[first:end]
        for i in range(len(x)):
            y[i] = -x[i]
        for k in range(len(order)):
            a, f = A[order[k], first:end], c[k]
            for i in range(len(x)):
                y[i] -= f * a[i]
    return out


@parallel(fastmath=_SUMS)
def add_combination(
    X: np.ndarray, c: np.ndarray, A: np.ndarray, order: np.ndarray, slope: np.ndarray
) -> float:
    """Add ``sum_k c_k A_k`` to ``X`` (m,) in place, and return ``slope . X``."""
    count = (len(X) + _PORTION - 1) // _PORTION
    sums = np.zeros(count)
    for portion in prange(count):
        first, end, along = portion * _PORTION, (portion + 1) * _PORTION, 0.0
        x, g = X[first:end], slope[first:end]
        for k in range(len(order)):
            a, f = A[order[k], first:end], c[k]
            for i in range(len(x)):
                x[i] += f * a[i]
        for i in range(len(x)):
            along += x[i] * g[i]
        sums[portion] = along
    return sum_of_portions(sums)
