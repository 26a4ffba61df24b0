"""Conjugate gradients with a coarse level, for matrices too large to factor.

The preconditioner adds to Jacobi's the correction of the coarse level, ``P (P^T A P)^-1 P^T`` [Brandt 1977,
Multi-level adaptive solutions to boundary-value problems].
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array, diags_array
from scipy.sparse.linalg import LinearOperator, cg

from apd_viewer.geometry.linalg.linear_solver import LinearSolver

# Of the mean diagonal: keeps coarse unknowns that interpolate nothing from being singular.
_SHIFT = 1e-9


def solve(A: csr_array, B: np.ndarray, P: csr_array, steps: int) -> np.ndarray:
    """Approximate ``A^-1 B`` by ``steps`` preconditioned conjugate gradient steps.

    Parameters
    ----------
    A : (n, n) csr_array
        Symmetric positive definite.
    B : (n, k) float array
    P : (n, c) csr_array
        Interpolation from the coarse unknowns.
    steps : int
        Each reduces the error by about a third.
    """
    R = P.T.tocsr()
    coarse = R @ A @ P
    coarse += diags_array(np.full(coarse.shape[0], _SHIFT * coarse.diagonal().mean()))
    factor, inverse = LinearSolver(coarse.tocsr()), 1.0 / A.diagonal()

    def corrected(r: np.ndarray) -> np.ndarray:
        return P @ factor.solve((R @ r)[:, None])[:, 0]

    M = LinearOperator(A.shape, lambda r: inverse * r + corrected(r), dtype=np.float64)
    columns = (cg(A, b, corrected(b), rtol=0.0, maxiter=steps, M=M)[0] for b in B.T)
    return np.column_stack(list(columns))
