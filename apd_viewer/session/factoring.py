"""Factors that are made in processes of their own, so that nobody need wait for one that nobody needs."""

from __future__ import annotations

import contextlib
import threading
from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.geometry.linear_solver import rows_of
from apd_viewer.session import wire
from apd_viewer.session.processes import START, started

if TYPE_CHECKING:
    from apd_viewer.geometry.linear_solver import Matrix

_START = START.format(module="factor_process")
_MOST_DEATHS = 3
_ENDED = "the process that factors has ended {times} times; it may lack memory"


class FarFactor:
    """The factor of a symmetric positive definite matrix, in a process of its own.

    It is begun at once, and begun again if the process dies; :meth:`close` ends it, however far it is.

    Parameters
    ----------
    A : (n, n) csr_array
        Symmetric positive definite.
    """

    elsewhere = True

    def __init__(self, A: Matrix) -> None:
        self._matrix = rows_of(A)
        self._error: Exception | None = None
        self._died = False
        self._deaths = 0
        self._begin()

    @property
    def ready(self) -> bool:
        """Whether :meth:`solve` need not wait until it is factored."""
        if not self._thread.is_alive() and self._died:
            self._begin()
        return not self._thread.is_alive()

    def solve(self, B: np.ndarray) -> np.ndarray:
        """Return ``A^-1 B`` for ``B`` of shape (n, 3), float64.

        Raises
        ------
        ValueError
            If the matrix is not positive definite.
        MemoryError
            If the process dies again and again.
        OSError
            If there can be no process.
        """
        while True:
            self._thread.join()
            if self._error is not None:
                raise self._error
            X = None if self._died else self._answer_to(np.ascontiguousarray(B))
            if X is not None:
                self._deaths = 0
                return np.frombuffer(X).reshape(B.shape).copy()
            self._begin()

    def close(self) -> None:
        """End the process; there is no factor any more."""
        self._process.kill()
        self._thread.join()
        self._process.wait()
        with contextlib.suppress(OSError):  # what was not sent yet finds nobody any more
            self._process.stdin.close()
        self._process.stdout.close()

    def _begin(self) -> None:
        """Start a process, in place of the one that has died."""
        if self._died:
            self.close()
            self._deaths += 1
        if self._deaths == _MOST_DEATHS:
            self._error, self._died = MemoryError(_ENDED.format(times=_MOST_DEATHS)), False
            return
        # Not on the thread that waits for it: on Linux it ends with the thread that has started it.
        self._process, self._died = started(_START), False
        self._thread = threading.Thread(target=self._send, name="factor", daemon=True)
        self._thread.start()

    def _send(self) -> None:
        word = self._answer_to(*self._matrix)
        if word:
            self._error = ValueError(word.decode())

    def _answer_to(self, *messages: np.ndarray) -> bytes | None:
        """The answer of the process; None if it has died."""
        with contextlib.suppress(OSError, ValueError):
            for message in messages:
                wire.write(self._process.stdin, message)
            if (answer := wire.read(self._process.stdout)) is not None:
                return answer
        self._died = True
        return None
