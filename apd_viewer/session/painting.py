"""Painting of base, handles and regions: strokes, and parts replaced as a whole."""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from apd_viewer.language import tr
from apd_viewer.session.document_editor import DocumentEditor
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import has_region_targets, with_next_region, without_paint
from apd_viewer.session.model.painted_part import PaintedPart
from apd_viewer.session.model.status_text import about_lock
from apd_viewer.session.selecting.part_operations import PartOperation, members_after


class Painting(DocumentEditor):
    """Assigns vertices to the base, the handles and the regions."""

    def paint(self, ids: np.ndarray, label: int) -> None:
        """Label the vertices ``ids`` within the current gesture; the shape stays as it is."""
        state = self._store.required_state()
        if self._gestures.state_before is not None:  # undo may have ended the stroke
            self._store.set_document(state.document.with_label(ids, label))

    def paint_region(self, ids: np.ndarray, number: int) -> None:
        """Put the vertices ``ids`` in region ``number`` (from 1; 0 erases), in a gesture.

        One number past the last makes a region: the first stroke needs none to be there.
        """
        state = self._store.required_state()
        if self._gestures.state_before is not None:
            document = state.document
            if number > len(document.regions):
                document = with_next_region(document)
            document = document.with_region_number(ids, number)
            (self._store.solve if has_region_targets(document) else self._store.set_document)(document)

    def end_stroke(self, gesture: str) -> None:
        """Finish painting; relabelled base and handles are gripped at the current shape."""
        before, document = self._gestures.state_before, self._store.required_state().document
        if before is not None and _are_alike(document, before.document):
            # Replacing a part by itself clears it first; there is nothing to undo.
            document = before.document
            self._store.revert_to(document)
        self._gestures.end(gesture)
        if before is not None and not np.array_equal(before.document.labels, document.labels):
            self._store.regrip(before.document, document)

    def set_members(self, part: PaintedPart, members: np.ndarray, gesture: str) -> None:
        """Set the members of a part, (n,) bool, as one step of undo."""
        self._repaint(
            part.document_with_members(self._gestures.state_without_gesture().document, members), gesture
        )

    def apply_operation(self, part: PaintedPart, operation: PartOperation) -> None:
        """Apply an operation to a part as a whole; a locked one is refused."""
        state = self._gestures.state_without_gesture()
        if part.is_in(state.document) and part.flags(state.document).locked:
            self._listener.failed(about_lock(part.name(state.document)))
        else:
            self.set_members(part, members_after(state, part, operation), operation.value)

    def clear_all(self) -> None:
        """Erase all paint but that of locked parts."""
        self._repaint(without_paint(self._gestures.state_without_gesture().document), tr("Clear all"))

    def _repaint(self, document: Document, gesture: str) -> None:
        before = self._store.required_state().document
        self._gestures.begin()
        asks = document.member is not before.member and has_region_targets(document)
        (self._store.solve if asks else self._store.set_document)(document)
        self.end_stroke(gesture)


def _are_alike(one: Document, other: Document) -> bool:
    """True if all fields are the same objects, and the paint equal."""
    others = (each.name for each in fields(one) if each.name not in ("labels", "member"))
    if any(getattr(one, name) is not getattr(other, name) for name in others):
        return False
    return np.array_equal(one.labels, other.labels) and np.array_equal(one.member, other.member)
