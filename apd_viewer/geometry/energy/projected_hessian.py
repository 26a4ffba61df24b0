"""Positive definite approximation of the Hessian of an elastic energy."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from apd_viewer.geometry.energy import membrane_hessian
from apd_viewer.geometry.energy.membrane import Membrane
from apd_viewer.geometry.linalg.block_cholesky import BlockFactor, BlockPattern
from apd_viewer.geometry.linalg.linear_solver import Matrix


class ProjectedHessian:
    """A quarter of an energy's Hessian, clamped triangle by triangle.

    A matrix of 3 x 3 blocks. Triangles give their own Hessians; all other terms give the constant matrix of
    the global step, their Hessian while the rotations are held.

    Parameters
    ----------
    V : (n, 3) float array
        Rest positions.
    free : (f,) int array
        Vertices that are solved for.
    constant : (f, f) csr_array
        Matrix of all terms but the membrane.
    membrane : Membrane

    Attributes
    ----------
    start, column : (f + 1,), (e,) int arrays
        The blocks' columns, in compressed sparse rows.
    """

    def __init__(self, V: np.ndarray, free: np.ndarray, constant: Matrix, membrane: Membrane) -> None:
        self._free, self._membrane = free, membrane
        f, F = len(free), membrane.patch.F
        place = np.full(len(V), -1)
        place[free] = np.arange(f)
        # Each pair of corners of each triangle.
        c, d = np.repeat(place[F], 3, axis=1).ravel(), np.tile(place[F], 3).ravel()
        inside = (c >= 0) & (d >= 0)
        entries = constant.tocoo()
        rows, columns = np.concatenate([entries.row, c[inside]]), np.concatenate([entries.col, d[inside]])
        pattern = sp.csr_array((np.ones(len(rows), dtype=np.int8), (rows, columns)), shape=(f, f))
        pattern.sum_duplicates()
        self.start, self.column = pattern.indptr, pattern.indices
        keys = np.repeat(np.arange(f), np.diff(self.start)) * f + self.column
        slot = np.full(len(c), -1)
        slot[inside] = np.searchsorted(keys, c[inside] * f + d[inside])
        self._slot = slot.reshape(-1, 3, 3)
        self._constant = np.zeros(len(keys))
        self._constant[np.searchsorted(keys, entries.row * np.int64(f) + entries.col)] = entries.data
        self._elimination = BlockPattern(V[free], self.start, self.column)

    def blocks_at(self, U: np.ndarray, least: float = 0.0) -> np.ndarray:
        """Blocks of the matrix at ``U`` (n, 3), (e, 3, 3) float array.

        Parameters
        ----------
        least : float
            What smaller eigenvalues of a triangle's Hessian are replaced by; -inf for none.
        """
        membrane = self._membrane
        patch, rest = membrane.patch, membrane.rest
        modes = membrane_hessian.modes(patch.F, rest, U, membrane.shear, membrane.area, least)
        blocks = self._constant[:, None, None] * np.eye(3)
        corners = patch.start, patch.corner
        membrane_hessian.add_blocks(self._free, *corners, self._slot, rest, modes, blocks)
        return blocks

    def factor_at(self, U: np.ndarray) -> BlockFactor:
        """Factor of the positive definite matrix at ``U`` (n, 3)."""
        return self._elimination.factor(self.blocks_at(U))
