"""Thread rule of parallel kernels: one caller at a time, enough work a core."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager

import numba

# Below so many vertices a second core takes longer to wake than it saves.
_WORTH_WAKING = 8000
# Where numba finds neither OpenMP nor TBB, two threads in parallel kernels at once would end the process.
_ONE_AT_A_TIME = threading.RLock()


@contextmanager
def cores_for(n: int) -> Iterator[None]:
    """Run parallel kernels on a mesh of ``n`` vertices."""
    with _ONE_AT_A_TIME:
        before = numba.get_num_threads()
        numba.set_num_threads(before if n >= _WORTH_WAKING else 1)
        try:
            yield
        finally:
            numba.set_num_threads(before)
