"""Painting of base, handles and regions: strokes, and parts replaced as a whole."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.language import tr
from apd_viewer.session.model.document_parts import asks_of_regions, cleared, with_next_region
from apd_viewer.session.model.status_text import about_lock
from apd_viewer.session.selecting.part_operation import PartOperation
from apd_viewer.session.selecting.part_operations import reshaped

if TYPE_CHECKING:
    from apd_viewer.session.gestures import Gestures
    from apd_viewer.session.listener import Listener
    from apd_viewer.session.model.document import Document
    from apd_viewer.session.model.painted_part import Part
    from apd_viewer.session.store import Store


class Painting:
    """Assigns vertices to the base, the handles and the regions.

    Parameters
    ----------
    store : Store
    gestures : Gestures
    listener : Listener
    """

    def __init__(self, store: Store, gestures: Gestures, listener: Listener) -> None:
        self._store = store
        self._gestures = gestures
        self._listener = listener

    def paint(self, ids: np.ndarray, label: int) -> None:
        """Label the vertices ``ids`` within the current gesture; the shape stays as it is."""
        state = self._store.required()
        if self._gestures.before is not None:  # undo may have ended the stroke
            self._store.set_document(state.document.painted(ids, label))

    def paint_region(self, ids: np.ndarray, number: int) -> None:
        """Put the vertices ``ids`` in region ``number`` (from 1; 0 erases), in a gesture.

        One number past the last makes a region: the first stroke needs none to be there.
        """
        state = self._store.required()
        if self._gestures.before is not None:
            document = state.document
            if number > len(document.regions):
                document = with_next_region(document)
            document = document.painted_region(ids, number)
            (self._store.solve if asks_of_regions(document) else self._store.set_document)(document)

    def end_stroke(self, gesture: str) -> None:
        """Finish painting; relabelled base and handles are gripped at the current shape."""
        before, document = self._gestures.before, self._store.required().document
        if before is not None and document.equals(before.document):
            # Replacing a part by itself clears it first; there is nothing to undo.
            document = before.document
            self._store.revert(document)
        self._gestures.end(gesture)
        if before is not None and not np.array_equal(before.document.labels, document.labels):
            self._store.regrip(before.document, document)

    def set_part(self, part: Part, wanted: np.ndarray, gesture: str) -> None:
        """Set the members of a part, (n,) bool, as one step of undo."""
        self._repaint(part.become(self._gestures.alone().document, wanted), gesture)

    def reshape(self, part: Part, operation: PartOperation) -> None:
        """Apply an operation to a part as a whole; a locked one is refused."""
        state = self._gestures.alone()
        if part.exists(state.document) and part.flags(state.document).locked:
            self._listener.failed(about_lock(part.name(state.document)))
        else:
            self.set_part(part, reshaped(state, part, operation), operation.value)

    def clear_all(self) -> None:
        """Erase all paint but that of locked parts."""
        self._repaint(cleared(self._gestures.alone().document), tr("Clear all"))

    def _repaint(self, document: Document, gesture: str) -> None:
        before = self._store.required().document
        self._gestures.begin()
        asks = document.member is not before.member and asks_of_regions(document)
        (self._store.solve if asks else self._store.set_document)(document)
        self.end_stroke(gesture)
