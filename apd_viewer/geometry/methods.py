"""The deformation methods: each turns ARAP iterations into shapes.

A method has ``aim(targets)``, ``iterate()``, the shape ``U`` (n, 3), the held positions ``held``
(k, 3) that ``U`` really has, the ``tolerance`` of the area and whether it is ``within_tolerance``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import diags_array

from apd_viewer.geometry.linear_solver import LinearSolver
from apd_viewer.geometry.operators import area

if TYPE_CHECKING:
    from apd_viewer.geometry.arap import Arap


class PlainArap:
    """ARAP alone: as rigid as possible, whatever becomes of the area."""

    # Nothing is asked of the area, so every tolerance is met.
    within_tolerance = True

    def __init__(self, arap: Arap, tolerance: float) -> None:
        self._arap = arap
        self.tolerance = tolerance

    @property
    def U(self) -> np.ndarray:
        """Current shape, (n, 3) float array."""
        return self._arap.U

    def aim(self, targets: np.ndarray) -> None:
        """Hold the fixed vertices at ``targets`` (k, 3) from now on."""
        self.held = targets

    def iterate(self) -> None:
        """One global step, one local step."""
        self._arap.iterate(self.held)


class LiHui:
    """Area-preserving deformation [Li & Hui, Area-preserving Deformation of 3D Objects].

    A round is (i) ARAP iterations with the handle at h, giving a shape of area A; (ii) free
    vertices scaled about the base's centroid B_c by ``s = sqrt(A0 / A)`` (Eqs. 2 and 6), the handle
    moved by ``(s - 1)(H_c - B_c)`` (Eq. 8); (iii) a blend (Eq. 9) towards those positions c,

        min_U  sum_i m_i |u_i - c_i|^2 + (kappa / 2) E(U; R),    m_i = vertex area / mean vertex area,

    with base and handle held. Rounds are repeated, from the moved handle, until the area is within
    the tolerance. Steps (ii) and (iii) are cheap, so they are applied after *every* ARAP iteration:
    each shape that is shown is the one that the round would end with, were it to end now.

    Parameters
    ----------
    arap : Arap
    is_handle : (k,) bool array
        Which of the held vertices are handle; the others are base.
    tolerance : float
        Relative error of the area that is accepted.
    """

    # Literally (kappa = 0) Eq. 9 returns the corrected points and leaves a crease at the base.
    KAPPA = 1.0
    ITERATIONS_A_ROUND = 20

    def __init__(self, arap: Arap, is_handle: np.ndarray, tolerance: float) -> None:
        self._arap = arap
        self._is_handle = is_handle
        self.tolerance = tolerance
        self._rest_area = area(arap.rest.V, arap.rest.F)
        self._m = arap.rest.masses[arap.free][:, None]
        self._blend = LinearSolver((diags_array(self._m[:, 0]) + self.KAPPA * arap.L_ff).tocsr())
        self.U = arap.U

    @property
    def within_tolerance(self) -> bool:
        """Whether the area of ``U`` is close enough to the area at rest."""
        return abs(self._area_error) <= self.tolerance

    def aim(self, targets: np.ndarray) -> None:
        """Hold the base at its ``targets``, and start the handle from its ``targets`` (k, 3)."""
        self._h = self.held = targets
        self._iteration = 0

    def iterate(self) -> None:
        """One ARAP iteration, corrected and blended; at the end of a round the handle may move."""
        self._arap.iterate(self._h)
        self._correct_and_blend()
        self._iteration += 1
        if self._iteration % self.ITERATIONS_A_ROUND == 0 and not self.within_tolerance:
            self._h = self.held

    def _correct_and_blend(self) -> None:
        arap = self._arap
        # A shape that has collapsed cannot be scaled back to its area.
        s = np.sqrt(self._rest_area / max(area(arap.U, arap.rest.F), 1e-6 * self._rest_area))
        base_centroid = self._h[~self._is_handle].mean(axis=0)
        handle_centroid = self._h[self._is_handle].mean(axis=0)
        self.held = self._h.copy()
        self.held[self._is_handle] += (s - 1.0) * (handle_centroid - base_centroid)

        c = base_centroid + s * (arap.U[arap.free] - base_centroid)
        pull = arap.right_hand_side(self.held)
        U = arap.U.copy()
        U[arap.fixed] = self.held
        U[arap.free] = self._blend.solve(self._m * c + self.KAPPA * pull)
        self.U = U
        self._area_error = area(U, arap.rest.F) / self._rest_area - 1.0
