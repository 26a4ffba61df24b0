"""Restarts of a converged multilevel solver from its coarse level.

They continue as long as each ends lower; then the lowest one is converged fully.

A buckling surface has many minima, and its coarse level has fewer: led by it from a converged shape, the fine
surface opens folds it cannot open by itself. Such trials are hidden: the best shape so far is shown until
a trial is better.
"""

import numpy as np

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.goals.goals import Goal
from apd_viewer.geometry.solver.adaptive_metric import gains_from_hessian
from apd_viewer.geometry.solver.constrained_descent import LATE_TOLERANCE, ConstrainedDescent
from apd_viewer.geometry.solver.iterative_solver import IterativeSolver, SolverProgress
from apd_viewer.geometry.solver.li_hui import LiHui
from apd_viewer.geometry.solver.methods import Method
from apd_viewer.geometry.solver.multilevel import (
    MultilevelDescent,
    gains_from_coarse_level,
    multilevel_descent,
)
from apd_viewer.geometry.solver.quasi_newton_descent import Equilibrium

# Smallest relative energy reduction for a minimum to count as better and be shown.
_GAIN = 1e-3
# Tolerance of minima during trials: ten steps reduce the energy by less than this fraction. Only the best
# is converged further, at the end. With a coarser tolerance of 1e-3 the folds found are worse.
_TRIAL_TOLERANCE = 1e-4
# Number of successive minima that may be higher than the best.
_PATIENCE = 1
# Descents with a Hessian take longer, so the first trial with a higher minimum is the last. A trial ends if
# its coarse surface converges to a higher energy than before or, if to about the same one, as soon as a
# Hessian would be factored for it.
_PATIENCE_BY_HESSIAN, _BEFORE_HESSIAN = 0, LATE_TOLERANCE
# Relative distance below which coarse shapes are the same, and lead to no other minimum.
_SAME = 5e-3


def make_solver(
    surface: ElasticSurface, goals: tuple[Goal, ...], method: Method, handle_of: np.ndarray, plain: bool
) -> IterativeSolver:
    """Solver of a method.

    ``handle_of`` (k + s,) is the handle of each held or soft vertex, counted from 1; 0 for the base.
    """
    if method.moves_handles:
        return LiHui(surface, handle_of, goals)
    if plain or method.is_plain_only or not len(surface.fixed):
        return ConstrainedDescent(surface, goals, plain=True)
    return minimizer(surface, goals)


def minimizer(surface: ElasticSurface, goals: tuple[Goal, ...]) -> IterativeSolver:
    """Minimising solver, with coarse levels and restarts where useful."""
    if gains_from_coarse_level(surface):
        return Restarts(multilevel_descent(surface, goals))
    return ConstrainedDescent(surface, goals)


def prepare_previews(solver: IterativeSolver) -> None:
    """Compute what the first preview of a solver waits for, if it shows any."""
    if isinstance(solver, Restarts):
        solver.inner.prepare_previews()


class Restarts:
    """Multilevel solver restarted from each of its minima.

    Parameters
    ----------
    inner : MultilevelDescent

    Attributes
    ----------
    surface : ElasticSurface
        The fine surface.
    inner : MultilevelDescent
    """

    def __init__(self, inner: MultilevelDescent) -> None:
        self.surface = inner.surface
        self.inner = inner
        self._by_hessian = gains_from_hessian(inner.surface)
        self._patience = _PATIENCE_BY_HESSIAN if self._by_hessian else _PATIENCE
        self._reset()

    @property
    def progress(self) -> SolverProgress:
        """Readings of the best shape so far during a trial.

        It has converged once no further restart promises a lower minimum.
        """
        progress = self.inner.progress._replace(converged=self._done)
        if self._minima:
            progress = progress._replace(seconds_left=None)
        if self._on_trial:
            return progress._replace(U=self._best[1][0], is_iterate_hidden=True, convergence_ratio=0.0)
        if self._finishing:
            return progress._replace(convergence_ratio=self.inner.fine.progress.convergence_ratio)
        return progress

    @property
    def energy(self) -> float | None:
        """Energy of the displayed shape; None if unknown."""
        return self._best[0] if self._on_trial else self.inner.energy

    @property
    def ready(self) -> bool:
        """True if a step need not wait for a factorization."""
        return self.inner.ready

    @property
    def equilibrium(self) -> Equilibrium | None:
        """Fine surface in equilibrium, for the stability search."""
        return self.inner.equilibrium

    def set_tolerance(self, tolerance: float) -> None:
        """Set the tolerance of minima on the relative energy decrease over ten steps."""
        self._end_trial()
        self.inner.set_tolerance(tolerance)
        self._reset()

    def set_goals(self, goals: tuple[Goal, ...]) -> None:
        """Replace the goals."""
        self._end_trial()
        self.inner.set_goals(goals)
        self._reset()

    def set_targets(self, targets: np.ndarray) -> None:
        """Set the target positions (k + s, 3) of the held and soft vertices."""
        self._end_trial()
        self.inner.set_targets(targets)
        self._reset()

    def restart(self, U: np.ndarray) -> None:
        """Continue from the positions ``U`` (n, 3)."""
        self.inner.restart(U)
        self._reset()

    def _reset(self) -> None:
        # Energy, shapes of all levels and multipliers of the best minimum.
        self._best: tuple[float, list[np.ndarray], np.ndarray] = (np.inf, [], np.zeros(0))
        self._minima: list[float] = []
        # Lowest coarse energy, whether the coarse level has converged in this trial, and without lowering it.
        self._coarse_minimum, self._led, self._doubtful = np.inf, False, False
        self._on_trial = self._finishing = self._done = False

    def step(self) -> None:
        """Do a step of the multilevel solver, and restart it where it stalls."""
        inner = self.inner.fine if self._finishing else self.inner
        inner.step()
        progress = inner.progress
        energy = self.surface.energy if self._on_trial else np.inf
        gain = 0.0 if self._finishing else _GAIN
        # Once shown, the shape of a trial stays: switching back would flicker.
        self._on_trial = self._on_trial and not energy < (1.0 - gain) * self._best[0]
        if self._finishing:
            if progress.stuck or progress.converged:
                self._end()
        elif self._is_hopeless() or (self._on_trial and (progress.stuck or self._is_last(energy, progress))):
            (self._end if self._by_hessian else self._converge_best)()
        elif progress.stuck:
            self._done = True
        elif progress.converged or ((self._on_trial or not self._by_hessian) and self._stagnates(energy)):
            self._begin_trial()

    def _is_hopeless(self) -> bool:
        """True if a trial's coarse level has converged without prospect of a new minimum."""
        coarse = self.inner.coarse
        if self._led or not coarse.converged:
            return False
        self._led, lowest = True, self._coarse_minimum
        if self._by_hessian:
            energy = coarse.energy
            self._coarse_minimum = min(energy, lowest)
            self._doubtful = not energy < (1.0 - _GAIN) * lowest
            if self._on_trial and energy > (1.0 + _GAIN) * lowest:
                return True
        if not self._on_trial:
            return False
        before, now = self._coarse_start, coarse.shapes()[0]
        return float(np.abs(now - before).max()) <= _SAME * float(np.ptp(before, axis=0).max())

    def _is_last(self, energy: float, progress: SolverProgress) -> bool:
        """True if the trial has converged and was the last worthwhile one."""
        if not (progress.converged or self._stagnates(energy)):
            return False
        known = any(abs(energy - minimum) <= _GAIN * minimum for minimum in self._minima)
        return known or len(self._minima) - int(np.argmin(self._minima)) > self._patience

    def _stagnates(self, energy: float) -> bool:
        """True if steps of the trial gain too little at this energy."""
        soon = self._by_hessian and self._doubtful and not energy < self._best[0]
        return self.inner.has_stalled(_BEFORE_HESSIAN if soon else _TRIAL_TOLERANCE)

    def _begin_trial(self) -> None:
        """Follow the coarse level from the minimum; show the best shape meanwhile."""
        inner, energy, best, minima = self.inner, self.surface.energy, self._best, self._minima
        if energy < best[0]:
            best = energy, inner.shapes(), inner.fine.multipliers
        inner.follow_coarse_again()
        self._coarse_start, self._led = inner.coarse.shapes()[0], False
        self._best, self._minima, self._on_trial = best, [*minima, energy], True

    def _converge_best(self) -> None:
        """Start converging the best shape; show it once its energy is the lowest."""
        best, minima = self._best, self._minima
        self._end_trial()
        self._best, self._minima = best, minima
        self._finishing = self._on_trial = True

    def _end(self) -> None:
        """End with the best shape."""
        self._end_trial()
        self._done = True

    def _end_trial(self) -> None:
        """Restore the best shape, if a trial is in progress."""
        if self._on_trial:
            _, shapes, multipliers = self._best
            self.inner.restore(shapes)
            self.inner.fine.multipliers = multipliers
            self._reset()
