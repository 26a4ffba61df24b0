"""Thread rule of parallel kernels: one caller at a time, enough work a core.

Where numba finds neither OpenMP nor TBB, it ends the process if two threads are in parallel kernels at once.
So every kernel is compiled by :func:`parallel`, which lets one caller in at a time.
"""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numba

if TYPE_CHECKING:
    from typing import ParamSpec, TypeVar

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
        kernel = numba.njit(cache=True, nogil=True, parallel=True, **options)(function)

        @functools.wraps(function)
        def guarded(*args: P.args, **kwargs: P.kwargs) -> R:
            with _ONE_AT_A_TIME:
                return kernel(*args, **kwargs)

        return guarded

    return compiled


@contextmanager
def cores_for(n: int) -> Iterator[None]:
    """Limit the parallel kernels within to the cores useful for ``n`` vertices."""
    with _ONE_AT_A_TIME:
        before = numba.get_num_threads()
        numba.set_num_threads(before if n >= _WORTH_WAKING else 1)
        try:
            yield
        finally:
            numba.set_num_threads(before)
