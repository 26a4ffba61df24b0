"""Control of freed memory kept by the C library."""

import ctypes
import sys
from typing import Any

# Parameters of mallopt with their values.
_TRIM_THRESHOLD, _MMAP_THRESHOLD = (-1, 1 << 28), (-3, 1 << 25)
_MOST_ARENAS = (-8, 1)


def keep_freed_memory() -> None:
    """Keep freed memory for the next frame, on glibc.

    By default, depending on earlier allocations, all memory of a frame may be returned and requested again:
    16,000 pages for 164,000 vertices, a third of the time of the frame.
    """
    if mallopt := _glibc_function("mallopt"):
        for option in (_TRIM_THRESHOLD, _MMAP_THRESHOLD):
            mallopt(*option)


def share_freed_memory() -> None:
    """Let threads reuse memory freed by other threads, on glibc.

    Call it before starting threads. By default each thread has its own arena: after a window had opened 20
    files in turn, 100 MiB were free in the arenas of the reading threads, more after every file.
    """
    if mallopt := _glibc_function("mallopt"):
        mallopt(*_MOST_ARENAS)


def release_freed_memory() -> None:
    """Return freed memory to the system, on glibc."""
    if trim := _glibc_function("malloc_trim"):
        trim(0)


def _glibc_function(name: str) -> Any:
    """Function of the C library by name; None if missing."""
    return getattr(ctypes.CDLL(None), name, None) if sys.platform.startswith("linux") else None
