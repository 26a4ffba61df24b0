"""Iteration of a deformation along a path of stops, and at its end."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.pose.held_path import ITERATIONS_A_STEP
from apd_viewer.geometry.solver.contact_descent import whole_path_frame
from apd_viewer.geometry.solver.deformation import Deformation


class PathStop(NamedTuple):
    """Arguments of :meth:`Deformation.aim` at a stop.

    Attributes
    ----------
    targets : (k, 3) float array
    soft_targets : (s, 3) float array or None
    shifts : (o, 3) float array or None
    """

    targets: np.ndarray
    soft_targets: np.ndarray | None = None
    shifts: np.ndarray | None = None


class PathIteration:
    """Iterations of a deformation, first along a path and then at its end.

    Parameters
    ----------
    solver : Deformation
    stops : sequence of PathStop
        Stops in order; the last one is the end of the path.
    U : (n, 3) float array, optional
        Shape to begin from; otherwise the solver's.
    start_shifts : (o, 3) float array, optional
        Displacements of the obstacles at ``U``; by default, those at the end of the path.
    is_path_hidden : bool
        The path only leads to where the shape on screen is already.

    Attributes
    ----------
    has_arrived : bool
        True once the handles are at their poses, or as far as contact lets them go.
    is_iterate_hidden : bool
        True before the end of a hidden path.
    """

    def __init__(
        self,
        solver: Deformation,
        stops: Sequence[PathStop],
        U: np.ndarray | None = None,
        start_shifts: np.ndarray | None = None,
        is_path_hidden: bool = False,
    ) -> None:
        self._solver, self._stops, self._leg, self._iterations = solver, stops, 0, 0
        self.has_arrived = len(stops) == 1
        self.is_iterate_hidden = is_path_hidden and not self.has_arrived
        self._aim(U, start_shifts)

    @property
    def is_on_its_way(self) -> bool:
        """True if held vertices or obstacles are still moving along the path."""
        return not self.has_arrived or self._solver.is_on_its_way

    @property
    def settled(self) -> bool:
        """True if further iterations would change nothing."""
        return not self.is_on_its_way and self._solver.settled

    def _aim(self, U: np.ndarray | None = None, start_shifts: np.ndarray | None = None) -> None:
        stop = self._stops[self._leg]
        self._solver.aim(stop.targets, U, stop.soft_targets, stop.shifts, start_shifts)

    def iterate(self) -> None:
        """Iterate once; advance to the next stop after enough iterations at this one."""
        self._solver.iterate()
        self._iterations += 1
        if self.has_arrived or self._iterations < ITERATIONS_A_STEP or self._solver.is_on_its_way:
            return
        self._iterations = 0
        if self._solver.share_reached < 1.0:
            self.has_arrived, self.is_iterate_hidden = True, False  # contact stops the handles
            return
        self._leg += 1
        self.has_arrived = self._leg == len(self._stops) - 1
        self.is_iterate_hidden = self.is_iterate_hidden and not self.has_arrived
        self._aim()

    def settle(self, most: int, tick: Callable[[int], object]) -> Frame:
        """Iterate to the end of the path, then at most ``most`` times until settled.

        ``tick`` is called after each iteration with the number of those at the end.
        """
        count = 0
        while self.is_on_its_way or (count < most and not self.settled):
            self.iterate()
            count += not self.is_on_its_way
            tick(count)
        return self.frame()

    def frame(self) -> Frame:
        """Frame of the last iteration, with the completed fraction of the whole path."""
        frame = self._solver.frame()
        if len(self._stops) == 1:
            return frame
        return whole_path_frame(frame, self._leg, len(self._stops), self._solver.contact)
