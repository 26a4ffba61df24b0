"""Sparse Cholesky: factor once, solve often. The only place that knows cholespy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from cholespy import CholeskySolverD, MatrixType

if TYPE_CHECKING:
    from scipy.sparse import csr_array


class LinearSolver:
    """The factor of a symmetric positive definite matrix.

    Parameters
    ----------
    A : (n, n) csr_array
        Symmetric positive definite.

    Raises
    ------
    ValueError
        If ``A`` is not positive definite.
    """

    def __init__(self, A: csr_array) -> None:
        A.sort_indices()
        rows, columns = A.indptr.astype(np.int32), A.indices.astype(np.int32)
        data = np.ascontiguousarray(A.data, dtype=np.float64)
        self._factor = CholeskySolverD(A.shape[0], rows, columns, data, MatrixType.CSR)

    def solve(self, B: np.ndarray) -> np.ndarray:
        """Return ``A^-1 B`` for ``B`` of shape (n, k), float64."""
        B = np.ascontiguousarray(B)
        X = np.empty_like(B)
        self._factor.solve(B, X)
        return X
