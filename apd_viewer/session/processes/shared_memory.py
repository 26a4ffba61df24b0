"""Memory that two processes see: arrays on their way to the solver, and its shapes on their way back.

Whoever asks for work makes the blocks and removes them; the solver only looks into them.
"""

from __future__ import annotations

import os
import secrets
import sys
import weakref
from collections.abc import Sequence
from multiprocessing import resource_tracker
from multiprocessing.shared_memory import SharedMemory

import numpy as np

_LINE = 64  # bytes; arrays begin at multiples of it


class Envelope:
    """Copies of arrays in one block, for the time until they have been read.

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
        block = _made(int(ends[-1]))
        self.name = block.name
        self.discard = weakref.finalize(self, _remove, block)
        for array, offset in zip(arrays, self.offsets, strict=True):
            _view(block, array.dtype, array.shape, offset)[...] = array


class OpenedEnvelope:
    """An envelope as its reader has it."""

    def __init__(self, name: str) -> None:
        self._block = _attached(name)

    def array(self, dtype: str, shape: tuple[int, ...], offset: int) -> np.ndarray:
        """A copy of the array that begins at ``offset``."""
        return _view(self._block, np.dtype(dtype), shape, offset).copy()

    def close(self) -> None:
        """Let go of it."""
        self._block.close()


class Tray:
    """Room for one shape, which the solver puts down and its owner carries away.

    Three counters stand beside it: how many shapes were put down, which of them was carried away last, and
    which was the last that anybody has looked at. Each is written by one side only and read by the other when
    it likes: there is no message about them that could be lost or be late.

    Parameters
    ----------
    n : int
        Number of vertices.
    name : str, optional
        Of the block that its owner has made.

    Raises
    ------
    OSError
        If there is no room.
    """

    def __init__(self, n: int, name: str | None = None) -> None:
        block = _made(_LINE + 24 * n) if name is None else _attached(name)
        self.name = block.name
        self._counts = _view(block, np.dtype(np.int64), (3,), 0)
        self._U = _view(block, np.dtype(np.float64), (n, 3), _LINE)
        # Who knows it last may be any thread that holds a reply.
        weakref.finalize(self, _remove if name is None else SharedMemory.close, block)

    # The solver's side

    @property
    def free(self) -> bool:
        """Whether the last shape has been carried away."""
        return bool(self._counts[1] == self._counts[0])

    @property
    def seen(self) -> bool:
        """Whether the last shape has been looked at."""
        return bool(self._counts[2] == self._counts[0])

    def put(self, U: np.ndarray) -> int:
        """Put ``U`` (n, 3) down; its number."""
        self._U[...] = U
        self._counts[0] += 1
        return int(self._counts[0])

    # The owner's side

    def carry(self, number: int) -> np.ndarray:
        """Carry the shape with that number away: a copy."""
        U = self._U.copy()
        self._counts[1] = number
        return U

    def look(self, number: int) -> None:
        """Say that the shape with that number has been looked at."""
        self._counts[2] = number


def leave_blocks_to_their_owner() -> None:
    """Have this process remove no block that it has only looked into; Python before 3.13 does at its end."""
    if sys.version_info < (3, 13):
        resource_tracker.register = lambda *_: None


def _made(size: int) -> SharedMemory:
    # By its owner's number a block can be told from those of other programs.
    block = SharedMemory(f"apd-{os.getpid()}-{secrets.token_hex(4)}", create=True, size=size)
    try:
        # Linux promises more than it has, and ends the process that believes it: ask for it all now.
        if hasattr(os, "posix_fallocate") and (descriptor := getattr(block, "_fd", -1)) >= 0:
            os.posix_fallocate(descriptor, 0, size)
    except OSError:
        _remove(block)
        raise
    return block


def _attached(name: str) -> SharedMemory:
    if sys.version_info >= (3, 13):
        return SharedMemory(name, track=False)
    return SharedMemory(name)


def _remove(block: SharedMemory) -> None:
    block.close()
    block.unlink()


def _view(block: SharedMemory, dtype: np.dtype, shape: tuple[int, ...], offset: int) -> np.ndarray:
    return np.ndarray(shape, dtype, buffer=block.buf, offset=offset)
