"""Factorization in a separate process, killed once obsolete."""

import threading
import time
from collections.abc import Callable

import numpy as np

from apd_viewer.geometry.linalg.linear_solver import Matrix, csr_rows
from apd_viewer.language import tr
from apd_viewer.session.processes.child_process import START_SCRIPT, ChildProcess

_START = START_SCRIPT.format(module="processes.factor_main")
_MOST_DEATHS = 3
_ENDED = tr("the factoring process ended {times} times; memory may be low")


class RemoteFactor:
    """Factor of a symmetric positive definite matrix in a separate process.

    It is begun by :meth:`begin` or at its first use, and again if the process dies; :meth:`close` ends it at
    any stage.

    Parameters
    ----------
    matrix : callable
        Returns what to factor, a symmetric positive definite (n, n) csr_array. It is called on another
        thread, so without kernels that run in parallel, and again if the process dies.
    V : (n, 3) float array
        Positions of the unknowns.
    """

    is_in_other_process = True

    def __init__(self, matrix: Callable[[], Matrix], V: np.ndarray) -> None:
        self._matrix, self._V = matrix, V
        self._process = ChildProcess("factor", _START)
        self._thread: threading.Thread | None = None
        self._error: Exception | None = None
        self._missing = True
        self._deaths = 0
        self._begun = self._took = 0.0  # seconds; 0 before the factorization

    @property
    def seconds(self) -> float:
        """Seconds that the factorization took, or has taken so far."""
        return self._took or (time.monotonic() - self._begun if self._begun else 0.0)

    @property
    def ready(self) -> bool:
        """True if :meth:`solve` would not wait for the factorization."""
        self.begin()
        return not self.is_factoring

    @property
    def is_factoring(self) -> bool:
        """True while the process is factoring the matrix."""
        return self._thread is not None and self._thread.is_alive()

    def begin(self) -> None:
        """Start a factor process if none is running."""
        if self.is_factoring or not self._missing or self._error is not None:
            return
        if self._process.pid is not None:
            self._deaths += 1
        if self._deaths == _MOST_DEATHS:
            self._error = MemoryError(_ENDED.format(times=_MOST_DEATHS))
            return
        # Started here, not on the new thread: on Linux a process ends with the thread that started it.
        self._process.restart()
        self._missing, self._begun, self._took = False, time.monotonic(), 0.0
        self._thread = threading.Thread(target=self._send, name="factor", daemon=True)
        self._thread.start()

    def solve(self, B: np.ndarray) -> np.ndarray:
        """``A^-1 B`` for ``B`` (n, 3), float64, to about six digits.

        Raises
        ------
        ValueError
            If the matrix is not positive definite.
        MemoryError
            If the process dies again and again.
        OSError
            If there can be no process.
        """
        return self._solution(B, refined=False)

    def solve_refined(self, B: np.ndarray) -> np.ndarray:
        """``A^-1 B`` for ``B`` (n, 3) to about ten digits; raises as :meth:`solve`."""
        return self._solution(B, refined=True)

    def _solution(self, B: np.ndarray, refined: bool) -> np.ndarray:
        while True:
            while not self.ready:
                self._join()
            if self._error is not None:
                raise self._error
            X = self._answer_to(np.array([refined]), np.ascontiguousarray(B))
            if X is not None:
                self._deaths = 0
                return np.frombuffer(X).reshape(B.shape).copy()

    def close(self) -> None:
        """End the process and discard the factor."""
        if not self._missing:
            self._process.kill()
        self._join()
        self._process.end()

    def _join(self) -> None:
        if self._thread is not None:
            self._thread.join()

    def _send(self) -> None:
        try:
            word = self._answer_to(*csr_rows(self._matrix()), np.ascontiguousarray(self._V))
        except Exception as error:  # the waiting thread raises the error again
            self._error = error
            return
        if word:
            self._error = ValueError(word.decode())
        self._took = time.monotonic() - self._begun

    def _answer_to(self, *messages: np.ndarray) -> bytes | None:
        """Return the answer of the process; None if it has died."""
        answer = self._process.receive_message() if self._process.send_messages(*messages) else None
        self._missing = answer is None
        return answer
