"""Sparse Cholesky factorization: factor once, solve often.

Large systems have a supernodal factor in single precision: it solves in a quarter of the time to six digits,
enough for steps, and one refinement gives ten. Small systems, and those unsuited to a supernodal factor, have
CHOLMOD's simplicial one.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from functools import cache
from typing import Protocol, TypeAlias

import numpy as np
from cholespy import CholeskySolverD, MatrixType
from scipy.sparse import csr_array, diags_array, eye_array, kron

from apd_viewer.errors import InputError
from apd_viewer.geometry.linalg.supernodal import SupernodalFactor
from apd_viewer.geometry.linalg.supernodes import Supernodes
from apd_viewer.language import tr

_log = logging.getLogger(__name__)
# Smallest number of unknowns for which a supernodal factor saves time.
FEWEST_SUPERNODAL_UNKNOWNS = 3000
# Largest ratio of factor to matrix entries; above it, ordering the unknowns by position has failed.
_MOST_FILL = 60
# Relative error of a known solution above which a factor is too inaccurate for descent steps.
LARGEST_RELATIVE_ERROR = 1e-2
# Relative error allowed in the self-check; single precision leaves about 1e-6.
_WRONG = 1e-4


class Metric(Protocol):
    """Inverse of a symmetric positive definite matrix."""

    def solve(self, B: np.ndarray) -> np.ndarray:
        """Solution ``A^-1 B`` for ``B`` (n, k), float64, to about six digits."""


class Factor(Metric, Protocol):
    """Factor of a symmetric positive definite matrix, possibly still pending."""

    def solve_refined(self, B: np.ndarray) -> np.ndarray:
        """Solution ``A^-1 B`` for ``B`` (n, k), float64, to about ten digits."""

    @property
    def ready(self) -> bool:
        """True if :meth:`solve` would not wait for the factorization."""

    @property
    def is_in_other_process(self) -> bool:
        """True if factored in another process, in parallel with other work."""

    @property
    def seconds(self) -> float:
        """Seconds that the factorization took, or has taken so far."""


Matrix: TypeAlias = csr_array
# Called with a function returning the matrix, and the positions (n, 3) of its unknowns.
Factorizer: TypeAlias = Callable[[Callable[[], Matrix], np.ndarray], Factor]


class LinearSolver:
    """Direct solver for a symmetric positive definite matrix.

    Parameters
    ----------
    A : (n, n) csr_array
        Symmetric positive definite.
    V : (n, 3) float array, optional
        Positions of the unknowns, by which a large matrix is ordered; what is coupled should be near.

    Attributes
    ----------
    factor
        Supernodal factor, or CHOLMOD's where that will not do.
    seconds : float
        Duration of the factorization, seconds.

    Raises
    ------
    InputError
        If ``A`` is not positive definite, of triangles that differ too much.
    """

    ready, is_in_other_process = True, False

    def __init__(self, A: Matrix, V: np.ndarray | None = None) -> None:
        self._factorize(*csr_rows(A), V)

    @classmethod
    def from_rows(
        cls, start: np.ndarray, column: np.ndarray, entry: np.ndarray, V: np.ndarray | None = None
    ) -> LinearSolver:
        """Linear solver of the matrix with the given :func:`csr_rows`."""
        solver = cls.__new__(cls)
        solver._factorize(start, column, entry, V)
        return solver

    def _factorize(
        self, start: np.ndarray, column: np.ndarray, entry: np.ndarray, V: np.ndarray | None
    ) -> None:
        begun = time.monotonic()
        self.factor: _SimplicialFactor | SupernodalFactor | None = None
        if V is not None and len(V) >= FEWEST_SUPERNODAL_UNKNOWNS and supernodal_solver_works():
            self.factor = _supernodal_factor(start, column, entry, V)
        if self.factor is None:
            self.factor = _SimplicialFactor(start, column, entry)
        self.seconds = time.monotonic() - begun

    def solve(self, B: np.ndarray) -> np.ndarray:
        """Solution ``A^-1 B`` for ``B`` (n, k), float64, to about six digits."""
        assert self.factor is not None
        return self.factor.solve(np.ascontiguousarray(B))

    def solve_refined(self, B: np.ndarray) -> np.ndarray:
        """Solution ``A^-1 B`` for ``B`` (n, k), float64, to about ten digits."""
        assert self.factor is not None
        return self.factor.solve_refined(np.ascontiguousarray(B))


class _SimplicialFactor:
    """CHOLMOD's factor in double precision, by cholespy."""

    def __init__(self, start: np.ndarray, column: np.ndarray, entry: np.ndarray) -> None:
        try:
            self._factor = CholeskySolverD(len(start) - 1, start, column, entry, MatrixType.CSR)
        except ValueError as error:
            raise InputError(
                tr(
                    "The triangles of the mesh differ too much in size or shape to compute with; remesh it, "
                    "or remove vertices that lie far off."
                )
            ) from error

    def solve(self, B: np.ndarray) -> np.ndarray:
        """Solution ``A^-1 B`` in double precision; same as :meth:`solve_refined`."""
        X = np.empty_like(B)
        self._factor.solve(B, X)
        return X

    solve_refined = solve


def _supernodal_factor(
    start: np.ndarray, column: np.ndarray, entry: np.ndarray, V: np.ndarray
) -> SupernodalFactor | None:
    """Supernodal factor; None if nearly dense, or too inaccurate in single precision."""
    nodes = Supernodes(V, start, column)
    if nodes.fill > _MOST_FILL * len(column):
        return None
    A = csr_array((entry, column, start), shape=(len(V), len(V)))
    try:
        factor = SupernodalFactor(A, nodes)
    except ValueError:  # indefinite in single precision
        return None
    away = np.abs(factor.solve(A @ V) - V).max()
    return factor if away <= LARGEST_RELATIVE_ERROR * np.abs(V).max() else None


@cache
def supernodal_solver_works() -> bool:
    """True if the supernodal solver solves a known system on this processor."""
    size = 24
    line = diags_array([np.ones(size - 1), np.ones(size - 1)], offsets=[-1, 1])
    couplings = kron(line, eye_array(size)) + kron(eye_array(size), line)
    A = csr_array(5.0 * eye_array(size * size) - couplings)
    V = np.stack(np.divmod(np.arange(size * size), size) + (np.zeros(size * size),), axis=1).astype(float)
    expected = V + np.sin(V[:, [1, 2, 0]])
    try:
        factor = _supernodal_factor(*csr_rows(A), V)
        found = np.zeros_like(V) if factor is None else factor.solve(A @ expected)
    except Exception:
        _log.exception("The supernodal factor failed its self-check")
        return False
    works = bool(np.abs(found - expected).max() <= _WRONG * np.abs(expected).max())
    if not works:
        _log.error("The supernodal factor failed its self-check")
    return works


def csr_rows(A: Matrix) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """CSR rows of ``A`` (n, n): starts (n + 1,), columns and entries, ascending."""
    A.sort_indices()
    entry = np.ascontiguousarray(A.data, dtype=np.float64)
    return A.indptr.astype(np.int32), A.indices.astype(np.int32), entry
