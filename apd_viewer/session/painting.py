"""Painting of base, handles and regions: strokes, and parts replaced as a whole."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.session.model.document_parts import with_next_region
from apd_viewer.session.model.part_operation import PartOperation
from apd_viewer.session.part_operations import reshaped

if TYPE_CHECKING:
    from apd_viewer.session.gestures import Gestures
    from apd_viewer.session.model.painted_part import Part
    from apd_viewer.session.store import Store


class Painting:
    """Assigns vertices to the base, the handles and the regions.

    Parameters
    ----------
    store : Store
    gestures : Gestures
    """

    def __init__(self, store: Store, gestures: Gestures) -> None:
        self._store = store
        self._gestures = gestures

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
            (self._store.solve if document.asks_of_regions else self._store.set_document)(document)

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
        document = part.become(self._gestures.alone().document, wanted)
        self._gestures.begin()
        asks = part.is_region and document.asks_of_regions
        (self._store.solve if asks else self._store.set_document)(document)
        self.end_stroke(gesture)

    def reshape(self, part: Part, operation: PartOperation) -> None:
        """Apply an operation to a part as a whole."""
        wanted = reshaped(self._gestures.alone(), part, operation)
        self.set_part(part, wanted, operation.value)
