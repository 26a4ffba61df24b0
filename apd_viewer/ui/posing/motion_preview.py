"""Preview of the motion typed in the panel, until it is made or given up."""

from __future__ import annotations

from apd_viewer.errors import InputError
from apd_viewer.session.model.state import State
from apd_viewer.session.posing.motion import Motion
from apd_viewer.session.session import Session
from apd_viewer.ui.panel.motion_field import MotionField
from apd_viewer.ui.posing.motion_ghost import MotionGhost
from apd_viewer.ui.tools.active_parts import ActiveParts
from apd_viewer.ui.tools.canvas import Canvas


class MotionPreview:
    """Shows where the active handle would go while an amount is typed.

    It also shows where handles were asked to be that contact has stopped on their way, and where they are
    to be while the first shape waits for its kernels.

    Parameters
    ----------
    canvas : Canvas
    field : MotionField
    session : Session
    parts : ActiveParts

    Attributes
    ----------
    ghost, requested_ghost : MotionGhost
    """

    def __init__(self, canvas: Canvas, field: MotionField, session: Session, parts: ActiveParts) -> None:
        self._canvas, self._field = canvas, field
        self._session, self._parts = session, parts
        self.ghost, self.requested_ghost = MotionGhost(canvas.viewport), MotionGhost(canvas.viewport)
        field.edited.connect(self._preview)
        field.editing_ended.connect(self.ghost.hide)

    def follow(self, old: State | None, new: State) -> None:
        """Begin from another document, if an amount is being typed."""
        if self._field.amount.hasFocus() and old is not None and old.document is not new.document:
            self._field.request_preview()

    def show_requested(self) -> None:
        """Show where the handles are to be while they wait or were stopped."""
        state = self._session.store.state
        if state is None:
            return
        stopped = state.frame.share_reached < 1.0 and state.frame.settled
        if stopped or self._session.store.is_previewing:
            self.requested_ghost.show_handles(state.document)
        else:
            self.requested_ghost.hide()

    def _preview(self, motion: Motion, text: str, to: bool) -> None:
        if (state := self._session.store.state) is None:
            return
        try:
            step = self._session.handles.plan_motion(
                motion, text, self._parts.handle, self._canvas.bend_line, to
            )
            way = step.intermediate_documents(state.document)
        except InputError as error:
            self.ghost.hide()
            self._field.show_error_later(str(error) if text.strip() else "")
        else:
            self._field.show_error_later("")
            self.ghost.show_motion(state.document, way)
