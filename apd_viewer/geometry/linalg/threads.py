"""Threading of parallel kernels: one caller at a time, enough work per core.

Where numba finds neither OpenMP nor TBB, it ends the process if two threads are in parallel kernels at once.
So every kernel is compiled by :func:`parallel`, which lets one caller in at a time.

Numba splits a sum over ``prange``, and an array's own ``sum()``, by the number of threads, and rounding with
them. So kernels sum portions of a fixed length, and then the portions by :func:`sum_of_portions`: the bits
are the same on any number of cores.

Kernels that call BLAS have :func:`one_blas_thread`. Its threads wait for each other in loops that sleep for
nothing: on a machine that does something else as well, a factor of 13,010 vertices took 16 s of the processor
by two, and 0.5 s by one.

A sum along an axis, and an array assigned to a part of another one, take a second to compile in each kernel:
numba compiles them, and the message of their errors, with it. Loops do not.
"""

import functools
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any, ParamSpec, TypeVar

import numba
import numpy as np
import scipy.linalg.cython_blas  # noqa: F401  # used by numba: it must be loaded before it can be limited
from threadpoolctl import ThreadpoolController

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.signals.deferred_signals import DEFERRED_SIGNALS

P = ParamSpec("P")
R = TypeVar("R")

# Below this many vertices a second core takes longer to wake than it saves.
_WORTH_WAKING = 8000
_ONE_AT_A_TIME = threading.RLock()


def parallel(**options: Any) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Compile a parallel kernel, run by one thread at a time.

    The lock costs less than a microsecond a call, of 20 that a kernel takes. Other kernels cannot call it.

    Parameters
    ----------
    options
        Of :func:`numba.njit`, besides ``parallel``, ``cache`` and ``nogil``.
    """

    def compiled(function: Callable[P, R]) -> Callable[P, R]:
        kernel = njit(cache=True, nogil=True, parallel=True, **options)(function)

        @functools.wraps(function)
        def guarded(*args: P.args, **kwargs: P.kwargs) -> R:
            with _ONE_AT_A_TIME:
                return kernel(*args, **kwargs)

        return guarded

    return compiled


@njit(cache=True, nogil=True)
def sum_of_portions(parts: np.ndarray) -> float:
    """Sum of the portions' partial sums (k,) in fixed order, for use in kernels."""
    found = 0.0
    for k in range(len(parts)):
        found += parts[k]
    return found


@njit(cache=True, nogil=True)
def sums_of_portions(parts: np.ndarray) -> np.ndarray:
    """Column sums (m,) of partial sums (k, m), as :func:`sum_of_portions`."""
    found = np.zeros(parts.shape[1])
    for k in range(len(parts)):
        for e in range(parts.shape[1]):
            found[e] += parts[k, e]
    return found


@contextmanager
def cores_for(n: int) -> Iterator[None]:
    """Context with parallel kernels on one core if ``n`` is small; SIGINT deferred."""
    with DEFERRED_SIGNALS, _ONE_AT_A_TIME:
        before = numba.get_num_threads()
        numba.set_num_threads(before if n >= _WORTH_WAKING else 1)
        try:
            yield
        finally:
            numba.set_num_threads(before)


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Context with BLAS limited to one thread; signals deferred."""
    with DEFERRED_SIGNALS, _ONE_AT_A_TIME, _libraries().limit(limits=1, user_api="blas"):
        yield


@cache
def _libraries() -> ThreadpoolController:
    return ThreadpoolController()


def use_one_core() -> None:
    """Run all further parallel kernels called from this thread on one core."""
    numba.set_num_threads(1)
