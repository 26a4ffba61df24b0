"""Clearing, locking and hiding parts by keys and menus."""

from __future__ import annotations

from collections.abc import Callable

from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.session.model.document_parts import PaintedPart
from apd_viewer.session.model.handles_and_regions import PartFlags
from apd_viewer.session.part_operations import PartOperation
from apd_viewer.session.session import Session
from apd_viewer.ui.tools.active_parts import ActiveParts
from apd_viewer.ui.tools.canvas import Canvas


class PartController:
    """Clears, locks and hides parts; none of it without a document.

    Parameters
    ----------
    canvas : Canvas
    session : Session
    parts : ActiveParts
    cancel_drag : callable
        Takes back the drag that is under way; True if there was one.
    """

    def __init__(
        self, canvas: Canvas, session: Session, parts: ActiveParts, cancel_drag: Callable[[], bool]
    ) -> None:
        self._canvas, self._session, self._parts = canvas, session, parts
        self._give_up = cancel_drag

    def clear_base(self) -> None:
        """Clear the base."""
        self._clear(PaintedPart(BASE))

    def clear_handle(self) -> None:
        """Clear the active handle."""
        self._clear(PaintedPart(HANDLE + self._parts.handle))

    def clear_region(self) -> None:
        """Clear the active region."""
        self._clear(PaintedPart(self._parts.region + 1, is_region=True))

    def clear_all(self) -> None:
        """Clear base, handles and regions."""
        if self._may_begin():
            self._session.painting.clear_all()

    def toggle_lock(self) -> None:
        """Lock the part of the current tool, or unlock it."""
        if (flags := self._flags) is not None:
            self._session.parts.lock(self._canvas.strokes.part, not flags.locked)

    def toggle_hidden(self) -> None:
        """Hide the part of the current tool, or show it."""
        if (flags := self._flags) is not None:
            self._session.parts.hide(self._canvas.strokes.part, not flags.hidden)

    def _may_begin(self) -> bool:
        return self._session.store.state is not None and not self._give_up()

    def _clear(self, part: PaintedPart) -> None:
        if self._may_begin():
            self._session.painting.apply_operation(part, PartOperation.CLEAR)

    @property
    def _flags(self) -> PartFlags | None:
        """Flags of the part of the current tool; None if there is none."""
        part, state = self._canvas.strokes.part, self._session.store.state
        if state is None or self._give_up() or not part.is_in(state.document):
            return None
        return part.flags(state.document)
