"""Sparse Cholesky factorization: factor once, solve often."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

import numpy as np
from cholespy import CholeskySolverD, MatrixType

if TYPE_CHECKING:
    from typing import TypeAlias

    from scipy.sparse import csr_array


class Metric(Protocol):
    """Inverse of a symmetric positive definite matrix."""

    def solve(self, B: np.ndarray) -> np.ndarray:
        """Return ``A^-1 B`` for ``B`` of shape (n, k), float64."""


class Factor(Metric, Protocol):
    """Factor of a symmetric positive definite matrix, possibly still pending."""

    @property
    def ready(self) -> bool:
        """True if :meth:`solve` would not wait for the factorization."""

    @property
    def elsewhere(self) -> bool:
        """True if factored in another process, and dispensable meanwhile."""

    @property
    def seconds(self) -> float:
        """Seconds that the factorization took, or has taken so far."""


if TYPE_CHECKING:
    Matrix: TypeAlias = csr_array
    Factored: TypeAlias = Callable[[Callable[[], Matrix]], Factor]


class LinearSolver:
    """The factor of a symmetric positive definite matrix.

    Parameters
    ----------
    A : (n, n) csr_array
        Symmetric positive definite.

    Attributes
    ----------
    seconds : float
        How long the factorization took.

    Raises
    ------
    ValueError
        If ``A`` is not positive definite.
    """

    ready, elsewhere = True, False

    def __init__(self, A: Matrix) -> None:
        self._factorize(*rows_of(A))

    @classmethod
    def from_rows(cls, start: np.ndarray, column: np.ndarray, entry: np.ndarray) -> LinearSolver:
        """The same, of the matrix with these :func:`rows_of`."""
        solver = cls.__new__(cls)
        solver._factorize(start, column, entry)
        return solver

    def _factorize(self, start: np.ndarray, column: np.ndarray, entry: np.ndarray) -> None:
        begun = time.monotonic()
        self._factor = CholeskySolverD(len(start) - 1, start, column, entry, MatrixType.CSR)
        self.seconds = time.monotonic() - begun

    def solve(self, B: np.ndarray) -> np.ndarray:
        """Return ``A^-1 B`` for ``B`` of shape (n, k), float64."""
        B = np.ascontiguousarray(B)
        X = np.empty_like(B)
        self._factor.solve(B, X)
        return X


def rows_of(A: Matrix) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """CSR rows of ``A`` (n, n): starts (n + 1,), columns and entries, ascending."""
    A.sort_indices()
    entry = np.ascontiguousarray(A.data, dtype=np.float64)
    return A.indptr.astype(np.int32), A.indices.astype(np.int32), entry
