"""Timeline of the shapes reached by motions in steps, in bounded memory."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

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
    """State reached by a step of a motion.

    Attributes
    ----------
    begins_run : bool
        Whether it precedes a motion; the steps up to the next such state follow from it.
    answer : State or None
        State of the method Wall at the same place of the obstacles, where it was solved as well.
    """

    state: State
    begins_run: bool = False
    answer: State | None = None

    @property
    def first(self) -> State | None:
        """State of the method that the motion was solved with; None if that is Wall."""
        return None if self.state.document.settings.traits.is_wall else self.state

    @property
    def wall(self) -> State | None:
        """State of the method Wall; None without one."""
        return self.answer or (self.state if self.first is None else None)

    def lacks_answer(self, settings: Mapping[str, Any]) -> bool:
        """True unless there is an answer of the wall with these settings."""
        own = self.state.document.with_settings(**settings).settings
        return self.first is not None and (self.answer is None or self.answer.document.settings != own)

    def has_shape_of(self, state: State) -> bool:
        """True if one of both states has the shape of a state and all it depends on."""
        return any(each is not None and _is_same_shape(each, state) for each in (self.state, self.answer))


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
        """Number of the last step with the shape of a state and the same inputs."""
        numbers = reversed(range(len(self.steps)))
        return next((k for k in numbers if self.steps[k].has_shape_of(state)), None)

    def run_of(self, k: int) -> range:
        """Numbers of the steps of the run that step ``k`` belongs to."""
        starts = [i for i, step in enumerate(self.steps) if step.begins_run]
        first = max((i for i in starts if i <= k), default=0)
        return range(first, min((i for i in starts if i > k), default=len(self.steps)))

    def unanswered(self, k: int, settings: Mapping[str, Any]) -> list[int]:
        """Numbers of the steps in the run of step ``k`` that lack an answer of the wall."""
        return [i for i in self.run_of(k) if self.steps[i].lacks_answer(settings)]

    def number_of(self, state: State) -> int | None:
        """Number of the step that a motion came to with just this state."""
        return next((k for k, step in enumerate(self.steps) if step.state is state), None)

    def with_answer(self, k: int, answer: State) -> Timeline:
        """Timeline with the answer of the wall at step ``k``."""
        step = replace(self.steps[k], answer=answer)
        return replace(self, steps=(*self.steps[:k], step, *self.steps[k + 1 :]))._bounded()

    def begun_at(self, state: State) -> Timeline:
        """Timeline with a new run from a state, after earlier runs of the same mesh."""
        kept = self if self.is_of(state.document) else Timeline()
        if kept.steps and _is_same_shape(kept.steps[-1].state, state):
            return kept
        if kept.steps and kept.steps[-1].begins_run:  # of a run that never went on
            kept = replace(kept, steps=kept.steps[:-1])
        known = kept.index_of(state)
        answer = None if known is None else kept.steps[known].answer
        return kept._with_step(TimelineStep(state, True, answer))

    def followed_by(self, state: State, begins_run: bool = False) -> Timeline:
        """Timeline with one more step; the oldest are dropped beyond the limit."""
        return self._with_step(TimelineStep(state, begins_run))

    def _with_step(self, step: TimelineStep) -> Timeline:
        return replace(self, steps=(*self.steps, step))._bounded()

    def _bounded(self) -> Timeline:
        """Timeline without its first steps beyond the limit."""
        answers = sum(step.answer is not None for step in self.steps)
        shapes = MOST_BYTES // max(1, self.steps[-1].state.frame.U.nbytes) - answers
        surplus = max(0, len(self.steps) - max(2, min(MOST_STEPS, shapes)))
        return replace(self, steps=self.steps[surplus:], dropped=self.dropped + surplus)

    def state_at(self, k: int, current: Document, of_wall: bool = False) -> State:
        """State of step ``k``, with regions and measurements of the current document.

        ``of_wall`` is that of the method Wall, where it is known.
        """
        state = (self.steps[k].wall if of_wall else None) or self.steps[k].state
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
