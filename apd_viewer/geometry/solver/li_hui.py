"""Area-preserving deformation by the original method of the paper."""

import numpy as np
from scipy.sparse import diags_array

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.goals.goals import Goal, GoalMeasures
from apd_viewer.geometry.mesh.operators import area
from apd_viewer.geometry.solver.iterative_solver import SolverProgress


class LiHui:
    """Area-preserving deformation of Li & Hui.

    A round is (i) ARAP iterations with the handle at h, giving a shape of area A; (ii) free
    vertices scaled about the base's centroid B_c by ``s = sqrt(A0 / A)`` (Eqs. 2 and 6), the handle
    moved by ``(s - 1)(H_c - B_c)`` (Eq. 8); (iii) a blend (Eq. 9) towards those positions c,

        min_U  sum_i m_i |u_i - c_i|^2 + (kappa / 2) E(U; R),    m_i = vertex area / mean vertex area,

    with base and handle held. Rounds are repeated, from the moved handle, until the area is within
    the tolerance. Steps (ii) and (iii) are cheap, so they are applied after *every* ARAP iteration:
    each shape that is shown is the one that the round would end with, were it to end now.

    Parameters
    ----------
    surface : ElasticSurface
    handle_of : (k,) int array
        For each held vertex the number of its handle, from 1; 0 is base. Each handle moves as one.
    goals : (Goal,)
        The total area, with a tolerance.
    """

    # Taken literally (kappa = 0), Eq. 9 returns the corrected points and leaves a crease at the base.
    KAPPA = 1.0
    ITERATIONS_A_ROUND = 20

    def __init__(self, surface: ElasticSurface, handle_of: np.ndarray, goals: tuple[Goal, ...]) -> None:
        self.surface = surface
        self._base = np.flatnonzero(handle_of == 0)
        self._handles = [np.flatnonzero(handle_of == k) for k in np.unique(handle_of[handle_of > 0])]
        self._m = surface.rest.masses[surface.free][:, None]
        self._blend = surface.factorizer(
            lambda: (diags_array(self._m[:, 0]) + self.KAPPA * surface.K_ff).tocsr(),
            surface.rest.V[surface.free],
        )
        self.U = surface.U
        self.set_goals(goals)

    @property
    def progress(self) -> SolverProgress:
        """Current shape and readings; the goal is never given up."""
        return SolverProgress(self.U, self.held_positions, self.goal_values, self._has_met_goals)

    @property
    def _has_met_goals(self) -> bool:
        miss = self._area.relative_deviation(float(self.goal_values[0]))
        return abs(miss) <= self._area.tolerance * self._wanted

    @property
    def ready(self) -> bool:
        """True if a step need not wait for a factorization."""
        return self.surface.factor.ready and self._blend.ready

    @property
    def energy(self) -> float:
        """Energy of the current shape ``U``, near its minimiser."""
        return self.surface.energy_at(self.U)

    @property
    def equilibrium(self) -> None:
        """None: the method descends in no energy, so stability cannot be examined."""

    def set_goals(self, goals: tuple[Goal, ...]) -> None:
        """Set another target or tolerance of the total area."""
        (self._area,) = goals
        self._measures = GoalMeasures(goals)
        self._wanted = self._area.target / self._area.rest
        self.goal_values = self._measures.values(self.U)

    def set_tolerance(self, tolerance: float) -> None:
        """Do nothing: convergence is judged by step lengths."""

    def restart(self, U: np.ndarray) -> None:
        """Continue from the positions ``U`` (n, 3)."""
        self.surface.restart(U)
        self.U = U

    def set_targets(self, targets: np.ndarray) -> None:
        """Fix the base at ``targets`` (k, 3), and start the handles from their targets."""
        self._h = self.held_positions = targets
        self._iteration = 0

    def step(self) -> None:
        """Do an ARAP iteration with area correction; update the handle after each round."""
        self.surface.local_step(self.surface.global_step(self._h))
        self._correct_and_blend()
        self._iteration += 1
        if self._iteration % self.ITERATIONS_A_ROUND == 0 and not self._has_met_goals:
            self._h = self.held_positions

    def _correct_and_blend(self) -> None:
        surface, target = self.surface, self._area.target
        # Bounded, since a collapsed shape cannot be scaled back to its area.
        s = np.sqrt(target / max(area(surface.U, surface.rest.F), 1e-6 * target))
        base_centroid = self._h[self._base].mean(axis=0)
        self.held_positions = self._h.copy()
        for handle in self._handles:
            self.held_positions[handle] += (s - 1.0) * (self._h[handle].mean(axis=0) - base_centroid)

        c = base_centroid + s * (surface.U[surface.free] - base_centroid)
        pull = surface.right_hand_side(self.held_positions)
        self.U = surface.all_positions(
            self._blend.solve_refined(self._m * c + self.KAPPA * pull), self.held_positions
        )
        self.goal_values = self._measures.values(self.U)
