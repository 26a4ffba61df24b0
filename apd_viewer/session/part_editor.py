"""Adding, removing, renaming, locking and hiding parts; each is a step of undo."""

from __future__ import annotations

from dataclasses import replace

from apd_viewer.files.selections.selection import MOST_REGIONS
from apd_viewer.geometry.pose.constraints import HANDLE, MOST_HANDLES
from apd_viewer.language import tr
from apd_viewer.session.document_editor import DocumentEditor
from apd_viewer.session.model.document_parts import (
    next_name,
    unique_name,
    with_next_region,
    without_handle,
    without_region,
)
from apd_viewer.session.model.handles_and_regions import Handle
from apd_viewer.session.model.painted_part import PaintedPart
from apd_viewer.session.model.status_text import about_lock
from apd_viewer.session.posing.named_poses import with_handle_renamed


class PartEditor(DocumentEditor):
    """Adds, removes and renames handles and regions; locks and hides parts."""

    def add_handle(self) -> int:
        """Add a handle without vertices; returns its number, or the last at the limit."""
        state = self._gestures.state_without_gesture()
        handles = state.document.handles
        if len(handles) >= MOST_HANDLES:
            self._listener.failed(
                tr("The limit is {most} handles; remove one first.").format(most=MOST_HANDLES)
            )
            return len(handles) - 1
        self._gestures.record(tr("Add handle"), state)
        name = next_name(tr("Handle"), [handle.name for handle in handles])
        self._store.set_document(state.document.with_handle(len(handles), Handle(name)))
        return len(handles)

    def remove_handle(self, k: int) -> None:
        """Remove handle ``k`` and free its vertices; the others are gripped anew."""
        state = self._gestures.state_without_gesture()
        if self._refused(PaintedPart(HANDLE + k)):
            return
        self._gestures.record(tr("Remove handle"), state)
        self._store.regrip(state.document, without_handle(state.document, k))

    def rename_handle(self, k: int, name: str) -> None:
        """Rename handle ``k``; a name in use gets a number."""
        handles = self._store.required_state().document.handles
        name = unique_name(name, handles[k].name, [handle.name for handle in handles])
        if name != handles[k].name:
            document = self._recorded(tr("Rename")).document
            handle = document.handles[k]
            document = with_handle_renamed(document, handle.name, name)
            self._store.set_document(document.with_handle(k, replace(handle, name=name)))

    def add_region(self) -> int:
        """Add a region without vertices; returns its number, or the last at the limit."""
        state = self._gestures.state_without_gesture()
        regions = state.document.regions
        if len(regions) >= MOST_REGIONS:
            self._listener.failed(
                tr("The limit is {most} regions; remove one first.").format(most=MOST_REGIONS)
            )
            return len(regions) - 1
        self._gestures.record(tr("Add region"), state)
        self._store.set_document(with_next_region(state.document))
        return len(regions)

    def remove_region(self, k: int) -> None:
        """Remove region ``k`` with its target."""
        state = self._gestures.state_without_gesture()
        if self._refused(PaintedPart(k + 1, is_region=True)):
            return
        self._gestures.record(tr("Remove region"), state)
        asked = state.document.regions[k].area is not None
        (self._store.solve if asked else self._store.set_document)(without_region(state.document, k))

    def rename_region(self, k: int, name: str) -> None:
        """Rename region ``k``; a name in use gets a number."""
        regions = self._store.required_state().document.regions
        name = unique_name(name, regions[k].name, [region.name for region in regions])
        if name != regions[k].name:
            document = self._recorded(tr("Rename")).document
            region = replace(document.regions[k], name=name)
            self._store.set_document(document.with_region(k, region))

    def lock(self, part: PaintedPart, on: bool) -> None:
        """Protect a part from being painted, or no longer."""
        self._flag(part, tr("Lock") if on else tr("Unlock"), locked=on)

    def hide(self, part: PaintedPart, on: bool) -> None:
        """Hide or show the colour of a part."""
        self._flag(part, tr("Hide") if on else tr("Show"), hidden=on)

    def _flag(self, part: PaintedPart, gesture: str, **on: bool) -> None:
        state = self._gestures.state_without_gesture()
        if part.is_in(state.document):
            before = part.flags(state.document)
            if (flags := before._replace(**on)) != before:
                self._gestures.record(gesture, state)
                self._store.set_document(part.document_with_flags(state.document, flags))

    def _refused(self, part: PaintedPart) -> bool:
        """True if the part is locked, and say so."""
        document = self._store.required_state().document
        locked = part.flags(document).locked
        if locked:
            self._listener.failed(about_lock(part.name(document)))
        return locked
