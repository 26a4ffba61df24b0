"""Timeline of the shapes reached by motions in steps, in bounded memory."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import State, shape_frame
from apd_viewer.session.model.view import View

# Limits of a timeline; the oldest steps beyond them are dropped.
MOST_STEPS = 2000
MOST_BYTES = 512 * 2**20
# Fields of a document that affect its display and measurements but not its shape, and those that do.
MEASURING_FIELDS = (
    "member",
    "regions",
    "measurements",
    "closed_openings",
    "target_shape",
    "missing_target_shape",
    "base",
    "poses",
)
_SHAPE_FIELDS = (
    "mesh",
    "labels",
    "initial_positions",
    "handles",
    "settings",
    "immobile_components",
    "obstacles",
)


@dataclass(frozen=True, eq=False)
class TimelineStep:
    """State reached by a step of a motion.

    Attributes
    ----------
    begins_run : bool
        True for the state before a motion; the steps up to the next such state belong to its run.
    wall_result : State or None
        State solved by the Wall method with the obstacles at the same positions; None if not solved.
    """

    state: State
    begins_run: bool = False
    wall_result: State | None = None

    @property
    def non_wall_state(self) -> State | None:
        """State solved by a method other than Wall; None if only Wall has solved the step."""
        return None if self.state.document.settings.traits.is_wall else self.state

    @property
    def wall_state(self) -> State | None:
        """State solved by the Wall method; None if there is none."""
        return self.wall_result or (self.state if self.non_wall_state is None else None)

    def lacks_wall_result(self, settings: Mapping[str, Any]) -> bool:
        """True unless the Wall method has solved the step with these settings."""
        own = self.state.document.with_settings(**settings).settings
        return self.non_wall_state is not None and (
            self.wall_result is None or self.wall_result.document.settings != own
        )

    def has_own_shape_of(self, state: State) -> bool:
        """True if the step's own state has the shape of ``state`` and equal inputs."""
        return _is_same_shape(self.state, state)

    def has_shape_of(self, state: State) -> bool:
        """True if one of the step's states has the shape of ``state`` and equal inputs."""
        return any(
            each is not None and _is_same_shape(each, state) for each in (self.state, self.wall_result)
        )


@dataclass(frozen=True, eq=False)
class Timeline:
    """Steps of one or several motions of a mesh, in order.

    Attributes
    ----------
    steps : tuple of TimelineStep
    dropped : int
        Number of the oldest steps that were dropped beyond the limit.
    """

    steps: tuple[TimelineStep, ...] = ()
    dropped: int = 0

    def belongs_to(self, document: Document) -> bool:
        """True if the steps are shapes of the document's mesh; its rest shape may differ."""
        return bool(self.steps) and self.steps[-1].state.document.mesh.F is document.mesh.F

    def index_of(self, state: State) -> int | None:
        """Number of the last step with the shape of a state and the same inputs."""
        numbers = reversed(range(len(self.steps)))
        return next((k for k in numbers if self.steps[k].has_shape_of(state)), None)

    def run_of(self, k: int) -> range:
        """Numbers of the steps in the run that contains step ``k``."""
        starts = [i for i, step in enumerate(self.steps) if step.begins_run]
        first = max((i for i in starts if i <= k), default=0)
        return range(first, min((i for i in starts if i > k), default=len(self.steps)))

    def steps_without_wall_result(self, k: int, settings: Mapping[str, Any]) -> list[int]:
        """Numbers of steps in the run of step ``k`` that the Wall method has not solved."""
        return [i for i in self.run_of(k) if self.steps[i].lacks_wall_result(settings)]

    def index_of_recorded(self, state: State) -> int | None:
        """Number of the step recorded with this very state object; None if there is none."""
        return next((k for k, step in enumerate(self.steps) if step.state is state), None)

    def with_wall_result(self, k: int, result: State) -> Timeline:
        """Timeline with a state solved by the Wall method at step ``k``."""
        step = replace(self.steps[k], wall_result=result)
        return replace(self, steps=(*self.steps[:k], step, *self.steps[k + 1 :]))._within_limit()

    def with_run_from(self, state: State) -> Timeline:
        """Timeline with a new run from a state, after earlier runs of the same mesh."""
        kept = self if self.belongs_to(state.document) else Timeline()
        if kept.steps and _is_same_shape(kept.steps[-1].state, state):
            return kept
        if kept.steps and kept.steps[-1].begins_run:  # a run without any step
            kept = replace(kept, steps=kept.steps[:-1])
        known = kept.index_of(state)
        if known is None:
            return kept._with_added_step(TimelineStep(state, True))
        # A copy, as each step is known by its state.
        return kept._with_added_step(TimelineStep(replace(state), True, kept.steps[known].wall_result))

    def with_state(self, state: State, begins_run: bool = False) -> Timeline:
        """Timeline with a state as its next step; the oldest steps may be dropped."""
        return self._with_added_step(TimelineStep(state, begins_run))

    def _with_added_step(self, step: TimelineStep) -> Timeline:
        return replace(self, steps=(*self.steps, step))._within_limit()

    def _within_limit(self) -> Timeline:
        """Timeline without the oldest steps beyond the limit."""
        results = sum(step.wall_result is not None for step in self.steps)
        shapes = MOST_BYTES // max(1, self.steps[-1].state.frame.U.nbytes) - results
        surplus = max(0, len(self.steps) - max(2, min(MOST_STEPS, shapes)))
        return replace(self, steps=self.steps[surplus:], dropped=self.dropped + surplus)

    def state_at(self, k: int, current: Document, of_wall: bool = False) -> State:
        """State of step ``k``, with regions and measurements of the current document.

        With ``of_wall``, that of the Wall method, if there is one.
        """
        state = (self.steps[k].wall_state if of_wall else None) or self.steps[k].state
        own = {name: getattr(current, name) for name in MEASURING_FIELDS}
        is_kept = all(value is getattr(state.document, name) for name, value in own.items())
        if is_kept or state.document.mesh is not current.mesh:
            return state
        return state.updated(replace(state.document, **own))


NO_TIMELINE = Timeline()


def timeline_of_shapes(state: State, shapes: Iterable[np.ndarray]) -> Timeline:
    """Timeline of given ``shapes`` (n, 3) of the mesh of a state in equilibrium."""
    found = Timeline()
    for U in shapes:
        step = state
        if U is not state.frame.U:
            frame = shape_frame(state.document.mesh, state.inspection, U)
            step = state.updated(frame=replace(frame, energy=None))
        found = found.with_state(step, begins_run=not found.steps)
    return found


def _is_same_shape(a: State, b: State) -> bool:
    return a.frame.U is b.frame.U and all(
        getattr(a.document, name) is getattr(b.document, name) for name in _SHAPE_FIELDS
    )


class OpenedFile(NamedTuple):
    """State, view and timeline read from an opened file.

    Attributes
    ----------
    view : View or None
        None where only a session knows it.
    timeline : Timeline
        Empty where the file has one shape.
    animation : Path or None
        File to be opened for mesh and shapes together, if there are several.
    """

    state: State
    view: View | None = None
    timeline: Timeline = NO_TIMELINE
    animation: Path | None = None
