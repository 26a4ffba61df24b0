"""Shared memory for arrays sent to the solver and shapes sent back.

The parent process of the solver creates and removes the blocks; the solver only opens them.
"""

import os
import secrets
import sys
import time
import weakref
from collections.abc import Sequence
from multiprocessing import resource_tracker
from multiprocessing.shared_memory import SharedMemory

import numpy as np

from apd_viewer.geometry.linalg.atomic_access import load_acquire, store_release

_LINE = 64  # bytes; arrays start at multiples of this
_COUNTER = 8  # bytes of an int64
_PUT, _COPIED, _SEEN = range(3)  # indices of the counters of a shape buffer


class SharedArrays:
    """Copies of arrays in one shared block, discarded after reading.

    Its name is sent by a pipe, whose two ends acquire the same lock in the operating system: the reader of
    the message thus sees all earlier writes.

    Parameters
    ----------
    arrays : sequence of arrays, not empty

    Attributes
    ----------
    discard : callable
        Removes it, the first time.

    Raises
    ------
    OSError
        If there is no room.
    """

    def __init__(self, arrays: Sequence[np.ndarray]) -> None:
        ends = np.cumsum([-(-array.nbytes // _LINE) * _LINE for array in arrays])
        self.offsets = [0, *(int(end) for end in ends[:-1])]
        block = _create(int(ends[-1]))
        self.name = block.name
        self.discard = weakref.finalize(self, _remove, block)
        for array, offset in zip(arrays, self.offsets, strict=True):
            _view(block, array.dtype, array.shape, offset)[...] = array


class SharedArraysReader:
    """Reader of a block of shared arrays."""

    def __init__(self, name: str) -> None:
        self._block = _attach(name)

    def array(self, dtype: str, shape: tuple[int, ...], offset: int) -> np.ndarray:
        """Return a copy of the array at ``offset``."""
        return _view(self._block, np.dtype(dtype), shape, offset).copy()

    def close(self) -> None:
        """Close the block for this process."""
        self._block.close()


class SharedCounters:
    """Integers in shared memory, each written by one process and read by another.

    A process that loads a number sees all that the other one had stored before it stored that number, and
    the other one had finished reading what this one overwrites next: loads acquire, stores release. Plain
    loads and stores are ordered like that on x86, but not on ARM, which Apple silicon is.

    Parameters
    ----------
    counters : (n,) int64 array
        In shared memory; to be accessed through this class alone.
    """

    def __init__(self, counters: np.ndarray) -> None:
        self._places = counters  # the address is valid as long as the array lives
        self._address = counters.ctypes.data

    def load(self, k: int) -> int:
        """Return a counter, with acquire ordering."""
        return int(load_acquire(self._address + k * _COUNTER))

    def store(self, k: int, value: int) -> None:
        """Set a counter, with release ordering."""
        store_release(self._address + k * _COUNTER, value)


class SharedShapeBuffer:
    """Shared buffer for one shape, written by the solver and copied by its parent.

    Three counters beside it: the shapes put so far, the last one copied, the last one displayed. Each is
    written by one side only and read by the other at any time. The solver writes a shape once the last one
    has been copied, the parent copies it once it has been put; see :class:`SharedCounters` for why either
    then sees it whole.

    Parameters
    ----------
    n : int
        Number of vertices.
    name : str, optional
        Name of the block created by the parent process.

    Raises
    ------
    OSError
        If there is no room.
    """

    def __init__(self, n: int, name: str | None = None) -> None:
        block = _create(_LINE + 24 * n) if name is None else _attach(name)
        self.name = block.name
        self._counters = SharedCounters(_view(block, np.dtype(np.int64), (3,), 0))
        self._U = _view(block, np.dtype(np.float64), (n, 3), _LINE)
        # Any thread with a reply may hold the last reference.
        weakref.finalize(self, _remove if name is None else SharedMemory.close, block)

    # Methods for the solver

    @property
    def is_free(self) -> bool:
        """True if the last shape has been copied."""
        return self._counters.load(_COPIED) == self._counters.load(_PUT)

    @property
    def is_displayed(self) -> bool:
        """True if the last shape has been displayed."""
        return self._counters.load(_SEEN) == self._counters.load(_PUT)

    def write_shape(self, U: np.ndarray) -> int:
        """Write ``U`` (n, 3) and return its number; the buffer must be free."""
        self._U[...] = U
        number = self._counters.load(_PUT) + 1
        self._counters.store(_PUT, number)
        return number

    # Methods for the parent process

    def take_shape(self, number: int) -> np.ndarray:
        """Copy shape ``number``, and free the buffer."""
        while self._counters.load(_PUT) < number:  # the message may arrive before the counter is stored
            time.sleep(0.0)
        U = self._U.copy()
        self._counters.store(_COPIED, number)
        return U

    def mark_displayed(self, number: int) -> None:
        """Mark shape ``number`` as displayed."""
        self._counters.store(_SEEN, number)


def untrack_shared_memory() -> None:
    """Keep blocks created by other processes at exit, as Python 3.13 does."""
    if sys.version_info < (3, 13):
        resource_tracker.register = lambda *_: None


def _create(size: int) -> SharedMemory:
    # The process id distinguishes the block from those of other programs.
    block = SharedMemory(f"apd-{os.getpid()}-{secrets.token_hex(4)}", create=True, size=size)
    try:
        # Linux overcommits and kills the process at first use: reserve all of it now.
        if hasattr(os, "posix_fallocate") and (descriptor := getattr(block, "_fd", -1)) >= 0:
            os.posix_fallocate(descriptor, 0, size)
    except OSError:
        _remove(block)
        raise
    return block


def _attach(name: str) -> SharedMemory:
    if sys.version_info >= (3, 13):
        return SharedMemory(name, track=False)
    return SharedMemory(name)


def _remove(block: SharedMemory) -> None:
    block.close()
    block.unlink()


def _view(block: SharedMemory, dtype: np.dtype, shape: tuple[int, ...], offset: int) -> np.ndarray:
    return np.ndarray(shape, dtype, buffer=block.buf, offset=offset)
