"""Walk of a shape along the winding paths of its handles."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from apd_viewer.geometry.pose.held_path import ITERATIONS_A_STEP
from apd_viewer.geometry.solver.contact_descent import whole_way
from apd_viewer.session.model.document_parts import shifts_of
from apd_viewer.session.model.handle_paths import on_the_way

if TYPE_CHECKING:
    from apd_viewer.geometry.pose.constraints import Constraints
    from apd_viewer.geometry.pose.frame import Frame
    from apd_viewer.geometry.solver.deformation import Deformation
    from apd_viewer.session.model.document import Document


class _Goal(NamedTuple):
    """Places of what is held, and of obstacles, as a document wants them."""

    held: Constraints
    shifts: np.ndarray

    @classmethod
    def of(cls, document: Document) -> _Goal:
        return cls(document.constraints(), shifts_of(document))


class Walk:
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
    walks : bool
        Otherwise go to the poses at once.
    begin : (o, 3) float array or None
        How far the obstacles have come at ``U``; None, or of another number, is as far as they are moved.

    Attributes
    ----------
    arrived : bool
        True once the handles are at their poses, or as far as contact lets them go.
    hides : bool
        True on the way to where the shape on screen is already.
    """

    def __init__(
        self,
        solver: Deformation,
        document: Document,
        U: np.ndarray | None = None,
        walks: bool = True,
        begin: np.ndarray | None = None,
    ) -> None:
        self._solver, self._end, self._iterations = solver, _Goal.of(document), 0
        self._stops = [_Goal.of(stop) for stop in on_the_way(document)] if walks else []
        if begin is not None and begin.shape != self._end.shifts.shape:
            begin = None
        self._legs, self._leg = len(self._stops) + 1, 0
        self.arrived = not self._stops
        self.hides = not self.arrived and U is not None and self._is_in_place(U, begin)
        if self.arrived:
            self._aim(self._goal, U, begin)
        else:
            self._aim(self._goal, document.grip, np.zeros_like(self._end.shifts))

    @property
    def _goal(self) -> _Goal:
        return self._stops[self._leg] if self._leg < len(self._stops) else self._end

    def _is_in_place(self, U: np.ndarray, come: np.ndarray | None) -> bool:
        held, shifts = self._end
        if come is not None and not np.array_equal(come, shifts):
            return False
        away = float(np.abs(U[held.fixed] - held.targets).max(initial=0.0))
        return away <= self._solver.rest.in_place

    @property
    def is_on_its_way(self) -> bool:
        """True if the held vertices or obstacles go on."""
        return not self.arrived or self._solver.is_on_its_way

    @property
    def settled(self) -> bool:
        """True if iterating further changes nothing."""
        return not self.is_on_its_way and self._solver.settled

    def _aim(self, goal: _Goal, U: np.ndarray | None = None, begin: np.ndarray | None = None) -> None:
        held, shifts = goal
        self._solver.aim(held.targets, U, held.soft_targets, shifts, begin)

    def iterate(self) -> None:
        """Iterate once, and go a step further when it is time."""
        self._solver.iterate()
        self._iterations += 1
        if self.arrived or self._iterations < ITERATIONS_A_STEP or self._solver.is_on_its_way:
            return
        self._iterations = 0
        if self._solver.share_reached < 1.0:
            self.arrived, self.hides = True, False  # contact lets the handles go no farther
            return
        self._leg += 1
        self.arrived = self._leg == len(self._stops)
        self.hides = self.hides and not self.arrived
        self._aim(self._goal)

    def frame(self) -> Frame:
        """The frame of the last iteration, its share that of the whole way."""
        frame = self._solver.frame()
        if not self._stops:
            return frame
        return whole_way(frame, self._leg, self._legs, self._solver.contact)
