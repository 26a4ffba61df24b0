"""The rest shape: going back to it, replacing it, and welding its seams."""

from __future__ import annotations

from dataclasses import replace

from apd_viewer.language import tr
from apd_viewer.session.document_editor import DocumentEditor
from apd_viewer.session.gestures import Gestures
from apd_viewer.session.jobs.background_job import Jobs
from apd_viewer.session.listener import Listener
from apd_viewer.session.model.baking import baked_state
from apd_viewer.session.model.state import State, rest_frame, welded_state
from apd_viewer.session.model.status_text import about_baking
from apd_viewer.session.posing.named_poses import rebased_poses
from apd_viewer.session.posing.obstacle_placement import reset_obstacles
from apd_viewer.session.state_store import StateStore


class RestShape(DocumentEditor):
    """Restores and replaces the rest shape; each is a step of undo.

    Parameters
    ----------
    store : StateStore
    gestures : Gestures
    jobs : Jobs
    listener : Listener
    """

    def __init__(self, store: StateStore, gestures: Gestures, jobs: Jobs, listener: Listener) -> None:
        super().__init__(store, gestures, listener)
        self._jobs = jobs

    def restore(self) -> None:
        """Reset handles, obstacles, shape and percentages; the paint stays."""
        state = self._gestures.state_without_gesture()
        if not state.is_at_rest:
            self._gestures.record(tr("Reset all handles"), state)
            rest = rest_frame(state.document.mesh, state.inspection)
            state = state.updated(state.document.at_rest(), rest)
            self._store.jump_to(state.updated(replace(state.document, obstacles=reset_obstacles(state))))

    def bake(self) -> None:
        """Make the shape on screen the rest shape, in the background."""
        shown = self._gestures.state_without_gesture()

        def done(at_rest: State) -> None:
            state = self._gestures.state_without_gesture()
            if state.document is not shown.document:
                self._listener.failed(tr("The shape changed in the meantime; bake it again."))
                return
            self._gestures.record(tr("Bake as rest shape"), state)
            self._store.jump_to(at_rest)
            self._listener.message_sent(
                about_baking(shown.frame.area, shown.inspection.area, self._store.unit)
            )

        self._jobs.run(tr("Measuring the new rest shape"), lambda: _baked(shown), done)

    def weld(self) -> None:
        """Weld nearly meeting seams; the vertices of the file stay."""
        shown = self._gestures.state_without_gesture()

        def done(state: State) -> None:
            before = self._gestures.state_without_gesture()
            if before.document is not shown.document:
                self._listener.failed(tr("The shape changed in the meantime; weld it again."))
                return
            self._gestures.record(tr("Weld seams"), before)
            self._store.jump_to(state)

        self._jobs.run(tr("Welding the seams"), lambda: welded_state(shown), done)


def _baked(state: State) -> State:
    """The state with its shape as the rest shape, and its named poses from there."""
    at_rest = baked_state(state)
    return replace(at_rest, document=replace(at_rest.document, poses=rebased_poses(state.document)))
