"""Timeline of the shapes that motions in steps came to, in bounded memory."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import State, shape_frame

# Limits of what is kept; beyond them the first steps go.
MOST_STEPS = 2000
MOST_BYTES = 512 * 2**20
# Parts of a document that say what is seen and measured of a shape, and not what shape it is.
OVER_IT = "member", "regions", "measurements", "target_shape", "missing_target_shape", "base", "poses"
_OF_IT = "mesh", "labels", "grip", "handles", "settings", "staying_components", "obstacles"


@dataclass(frozen=True, eq=False)
class TimelineStep:
    """State that a motion came to.

    Attributes
    ----------
    begins_run : bool
        It was there before the motion; the steps up to the next such state follow from it.
    """

    state: State
    begins_run: bool = False


@dataclass(frozen=True, eq=False)
class Timeline:
    """Steps of one or several motions of a mesh, in order.

    Attributes
    ----------
    steps : tuple of TimelineStep
    dropped : int
        Number of first steps left out, as they were too many.
    """

    steps: tuple[TimelineStep, ...] = ()
    dropped: int = 0

    def is_of(self, document: Document) -> bool:
        """True if the steps are shapes of the document's mesh, whatever its rest shape."""
        return bool(self.steps) and self.steps[-1].state.document.mesh.F is document.mesh.F

    def index_of(self, state: State) -> int | None:
        """Number of the last step with the shape of a state and all it depends on."""
        numbers = reversed(range(len(self.steps)))
        return next((k for k in numbers if _is_same_shape(self.steps[k].state, state)), None)

    def begun_at(self, state: State) -> Timeline:
        """Timeline with a run from a state, after those of the same mesh."""
        kept = self if self.is_of(state.document) else Timeline()
        if kept.steps and _is_same_shape(kept.steps[-1].state, state):
            return kept
        if kept.steps and kept.steps[-1].begins_run:  # of a run that never went on
            kept = replace(kept, steps=kept.steps[:-1])
        return kept.followed_by(state, begins_run=True)

    def followed_by(self, state: State, begins_run: bool = False) -> Timeline:
        """Timeline with one more step; the oldest are dropped beyond the limit."""
        steps = (*self.steps, TimelineStep(state, begins_run))
        most = max(2, min(MOST_STEPS, MOST_BYTES // max(1, state.frame.U.nbytes)))
        surplus = max(0, len(steps) - most)
        return replace(self, steps=steps[surplus:], dropped=self.dropped + surplus)

    def state_at(self, k: int, current: Document) -> State:
        """State of step ``k``, with regions and measurements of the current document."""
        state = self.steps[k].state
        own = {name: getattr(current, name) for name in OVER_IT}
        is_kept = all(value is getattr(state.document, name) for name, value in own.items())
        if is_kept or state.document.mesh is not current.mesh:
            return state
        return state.updated(replace(state.document, **own))


NO_TIMELINE = Timeline()


def timeline_of_shapes(state: State, shapes: Iterable[np.ndarray]) -> Timeline:
    """Timeline of given ``shapes`` (n, 3) of the mesh of a state that is at rest."""
    found = Timeline()
    for U in shapes:
        step = state
        if U is not state.frame.U:
            frame = shape_frame(state.document.mesh, state.inspection, U)
            step = state.updated(frame=replace(frame, energy=None))
        found = found.followed_by(step, begins_run=not found.steps)
    return found


def _is_same_shape(a: State, b: State) -> bool:
    same = all(getattr(a.document, name) is getattr(b.document, name) for name in _OF_IT)
    return same and a.frame.U is b.frame.U
