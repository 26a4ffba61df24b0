"""Walk of a shape along the winding paths of its handles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.pose.constraints import Constraints
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.pose.held_path import ITERATIONS_A_STEP
from apd_viewer.geometry.solver.contact_descent import whole_path_frame
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import obstacle_shifts
from apd_viewer.session.model.handle_paths import intermediate_documents


class _Goal(NamedTuple):
    """Places of what is held, and of obstacles, as a document wants them."""

    held: Constraints
    shifts: np.ndarray

    @classmethod
    def of(cls, document: Document) -> _Goal:
        return cls(document.constraints(), obstacle_shifts(document))


class PathIteration:
    """Iterations of a deformation, first along the paths and then at their end.

    Paths beyond half a turn are walked from the grip in steps; otherwise the shape goes to the poses at once.
    So it depends on what is in the document, and not on the pace of the hand.

    Parameters
    ----------
    solver : Deformation
    document : Document
    U : (n, 3) float array or None
        The shape on screen, to go on from where there is nothing to walk; None goes on from the last
        iteration.
    along_paths : bool
        Otherwise go to the poses at once.
    start_shifts : (o, 3) float array or None
        How far the obstacles have come at ``U``; None, or of another number, is as far as they are moved.

    Attributes
    ----------
    has_arrived : bool
        True once the handles are at their poses, or as far as contact lets them go.
    is_iterate_hidden : bool
        True on the way to where the shape on screen is already.
    """

    def __init__(
        self,
        solver: Deformation,
        document: Document,
        U: np.ndarray | None = None,
        along_paths: bool = True,
        start_shifts: np.ndarray | None = None,
    ) -> None:
        self._solver, self._end, self._iterations = solver, _Goal.of(document), 0
        self._stops = [_Goal.of(stop) for stop in intermediate_documents(document)] if along_paths else []
        if start_shifts is not None and start_shifts.shape != self._end.shifts.shape:
            start_shifts = None
        self._legs, self._leg = len(self._stops) + 1, 0
        self.has_arrived = not self._stops
        self.is_iterate_hidden = not self.has_arrived and U is not None and self._is_in_place(U, start_shifts)
        if self.has_arrived:
            self._aim(self._goal, U, start_shifts)
        else:
            self._aim(self._goal, document.grip, np.zeros_like(self._end.shifts))

    @property
    def _goal(self) -> _Goal:
        return self._stops[self._leg] if self._leg < len(self._stops) else self._end

    def _is_in_place(self, U: np.ndarray, start_shifts: np.ndarray | None) -> bool:
        held, shifts = self._end
        if start_shifts is not None and not np.array_equal(start_shifts, shifts):
            return False
        away = float(np.abs(U[held.fixed] - held.targets).max(initial=0.0))
        return away <= self._solver.rest.in_place_tolerance

    @property
    def is_on_its_way(self) -> bool:
        """True if the held vertices or obstacles go on."""
        return not self.has_arrived or self._solver.is_on_its_way

    @property
    def settled(self) -> bool:
        """True if iterating further changes nothing."""
        return not self.is_on_its_way and self._solver.settled

    def _aim(self, goal: _Goal, U: np.ndarray | None = None, start_shifts: np.ndarray | None = None) -> None:
        held, shifts = goal
        self._solver.aim(held.targets, U, held.soft_targets, shifts, start_shifts)

    def iterate(self) -> None:
        """Iterate once, and go a step further when it is time."""
        self._solver.iterate()
        self._iterations += 1
        if self.has_arrived or self._iterations < ITERATIONS_A_STEP or self._solver.is_on_its_way:
            return
        self._iterations = 0
        if self._solver.share_reached < 1.0:
            self.has_arrived, self.is_iterate_hidden = True, False  # contact lets the handles go no farther
            return
        self._leg += 1
        self.has_arrived = self._leg == len(self._stops)
        self.is_iterate_hidden = self.is_iterate_hidden and not self.has_arrived
        self._aim(self._goal)

    def frame(self) -> Frame:
        """The frame of the last iteration, its share that of the whole way."""
        frame = self._solver.frame()
        if not self._stops:
            return frame
        return whole_path_frame(frame, self._leg, self._legs, self._solver.contact)
