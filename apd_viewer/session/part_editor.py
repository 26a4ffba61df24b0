"""Adding, removing, renaming, locking and hiding parts; each is an undo step."""

from dataclasses import fields, replace

import numpy as np

from apd_viewer.files.selections.selection import MOST_REGIONS
from apd_viewer.geometry.pose.constraints import HANDLE, MOST_HANDLES
from apd_viewer.language import tr
from apd_viewer.session.gestures import DocumentEditor
from apd_viewer.session.model import document_parts
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import PaintedPart
from apd_viewer.session.model.handles_and_regions import Handle
from apd_viewer.session.model.status_text import lock_sentence
from apd_viewer.session.part_operations import PartOperation, members_after
from apd_viewer.session.posing.named_poses import with_handle_renamed


class PartEditor(DocumentEditor):
    """Editor of handles and regions; also locks and hides parts."""

    def add_handle(self) -> int:
        """Add an empty handle; return its index, or the last one at the limit."""
        state = self._gestures.state_without_gesture()
        handles = state.document.handles
        if len(handles) >= MOST_HANDLES:
            self._listener.failed(
                tr("The limit is {most} handles; remove one first.").format(most=MOST_HANDLES)
            )
            return len(handles) - 1
        self._gestures.record(tr("Add handle"), state)
        name = document_parts.next_name(tr("Handle"), [handle.name for handle in handles])
        self._store.set_document(state.document.with_handle(len(handles), Handle(name)))
        return len(handles)

    def remove_handle(self, k: int) -> bool:
        """Remove handle ``k``, unless it is locked, and return whether it was removed.

        The others then move from their displayed positions.
        """
        state = self._gestures.state_without_gesture()
        if self._refuse_if_locked(PaintedPart(HANDLE + k)):
            return False
        self._gestures.record(tr("Remove handle"), state)
        self._store.restart_motions(state.document, document_parts.without_handle(state.document, k))
        return True

    def rename_handle(self, k: int, name: str) -> None:
        """Rename handle ``k``; a name in use gets a number."""
        handles = self._store.required_state().document.handles
        name = document_parts.unique_name(name, handles[k].name, [handle.name for handle in handles])
        if name != handles[k].name:
            document = self._record_state(tr("Rename")).document
            handle = document.handles[k]
            document = with_handle_renamed(document, handle.name, name)
            self._store.set_document(document.with_handle(k, replace(handle, name=name)))

    def add_region(self) -> int:
        """Add an empty region; return its index, or the last one at the limit."""
        state = self._gestures.state_without_gesture()
        regions = state.document.regions
        if len(regions) >= MOST_REGIONS:
            self._listener.failed(
                tr("The limit is {most} regions; remove one first.").format(most=MOST_REGIONS)
            )
            return len(regions) - 1
        self._gestures.record(tr("Add region"), state)
        self._store.set_document(document_parts.with_next_region(state.document))
        return len(regions)

    def remove_region(self, k: int) -> bool:
        """Remove region ``k`` with its target, unless it is locked; return whether."""
        state = self._gestures.state_without_gesture()
        if self._refuse_if_locked(PaintedPart(k + 1, is_region=True)):
            return False
        self._gestures.record(tr("Remove region"), state)
        asked = state.document.regions[k].area is not None
        (self._store.solve if asked else self._store.set_document)(
            document_parts.without_region(state.document, k)
        )
        return True

    def rename_region(self, k: int, name: str) -> None:
        """Rename region ``k``; a name in use gets a number."""
        regions = self._store.required_state().document.regions
        name = document_parts.unique_name(name, regions[k].name, [region.name for region in regions])
        if name != regions[k].name:
            document = self._record_state(tr("Rename")).document
            region = replace(document.regions[k], name=name)
            self._store.set_document(document.with_region(k, region))

    def lock(self, part: PaintedPart, on: bool) -> None:
        """Lock or unlock a part against painting."""
        self._flag(part, tr("Lock") if on else tr("Unlock"), locked=on)

    def hide(self, part: PaintedPart, on: bool) -> None:
        """Hide or show the colour of a part."""
        self._flag(part, tr("Hide") if on else tr("Show"), hidden=on)

    def _flag(self, part: PaintedPart, gesture: str, **on: bool) -> None:
        state = self._gestures.state_without_gesture()
        if part.exists_in(state.document):
            before = part.flags(state.document)
            if (flags := before._replace(**on)) != before:
                self._gestures.record(gesture, state)
                self._store.set_document(part.document_with_flags(state.document, flags))

    def _refuse_if_locked(self, part: PaintedPart) -> bool:
        """Report a locked part; return True if it is locked."""
        document = self._store.required_state().document
        locked = part.flags(document).locked
        if locked:
            self._listener.failed(lock_sentence(part.name(document)))
        return locked


class PaintEditor(DocumentEditor):
    """Editor assigning vertices to the base, the handles and the regions."""

    def paint(self, ids: np.ndarray, label: int) -> None:
        """Label the vertices ``ids`` within the current gesture; the shape is unchanged."""
        state = self._store.required_state()
        if self._gestures.state_before is not None:  # the stroke may have been ended by undo
            self._store.set_document(state.document.with_label(ids, label))

    def paint_region(self, ids: np.ndarray, number: int) -> None:
        """Assign vertices ``ids`` to region ``number`` (from 1; 0 erases) in a gesture.

        The first number past the last creates a region, for a first stroke without any.
        """
        state = self._store.required_state()
        if self._gestures.state_before is not None:
            document = state.document
            if number > len(document.regions):
                document = document_parts.with_next_region(document)
            document = document.with_region_number(ids, number)
            (self._store.solve if document_parts.has_region_targets(document) else self._store.set_document)(
                document
            )

    def end_stroke(self, gesture: str) -> None:
        """End a stroke; after a change of labels, motions start from the displayed shape."""
        before, document = self._gestures.state_before, self._store.required_state().document
        if before is not None and _have_equal_paint(document, before.document):
            # Replacing a part by itself clears it first, but leaves nothing to undo.
            document = before.document
            self._store.revert_to(document)
        self._gestures.end(gesture)
        if before is not None and not np.array_equal(before.document.labels, document.labels):
            self._store.restart_motions(before.document, document)

    def set_members(self, part: PaintedPart, members: np.ndarray, gesture: str) -> None:
        """Set the members of a part, (n,) bool, as one undo step."""
        self._repaint(
            part.document_with_members(self._gestures.state_without_gesture().document, members), gesture
        )

    def apply_operation(self, part: PaintedPart, operation: PartOperation) -> None:
        """Apply an operation to a whole part, unless it is locked."""
        state = self._gestures.state_without_gesture()
        if part.exists_in(state.document) and part.flags(state.document).locked:
            self._listener.failed(lock_sentence(part.name(state.document)))
        else:
            self.set_members(part, members_after(state, part, operation), operation.value)

    def clear_all(self) -> None:
        """Erase all paint except on locked parts."""
        self._repaint(
            document_parts.without_paint(self._gestures.state_without_gesture().document), tr("Clear all")
        )

    def _repaint(self, document: Document, gesture: str) -> None:
        before = self._store.required_state().document
        self._gestures.begin()
        asks = document.member is not before.member and document_parts.has_region_targets(document)
        (self._store.solve if asks else self._store.set_document)(document)
        self.end_stroke(gesture)


def _have_equal_paint(one: Document, other: Document) -> bool:
    """True if the paint is equal and all other fields are identical objects."""
    others = (each.name for each in fields(one) if each.name not in ("labels", "member"))
    if any(getattr(one, name) is not getattr(other, name) for name in others):
        return False
    return np.array_equal(one.labels, other.labels) and np.array_equal(one.member, other.member)
