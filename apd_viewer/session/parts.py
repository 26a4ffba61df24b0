"""The handles and the regions: one more, one fewer, another name; each is a step of undo."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from apd_viewer.files.selections.selection import MOST_REGIONS
from apd_viewer.geometry.pose.constraints import MOST_HANDLES
from apd_viewer.language import tr
from apd_viewer.session.model.named_parts import Handle
from apd_viewer.session.model.names import new_name, next_name

if TYPE_CHECKING:
    from apd_viewer.session.gestures import Gestures
    from apd_viewer.session.listener import Listener
    from apd_viewer.session.store import Store


class Parts:
    """The verbs that change which parts there are.

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

    def add_handle(self) -> int:
        """One more handle, not painted yet; its number, or that of the last where there can be no more."""
        state = self._gestures.alone()
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
        """Remove handle ``k``: what it held is free, and the others are gripped where they are now."""
        state = self._gestures.alone()
        self._gestures.record(tr("Remove handle"), state)
        self._store.regrip(state.document, state.document.without_handle(k))

    def rename_handle(self, k: int, name: str) -> None:
        """Give handle ``k`` a name of its own."""
        handles = self._store.required().document.handles
        name = new_name(name, handles[k].name, [handle.name for handle in handles])
        if name != handles[k].name:
            state = self._gestures.alone()
            self._gestures.record(tr("Rename"), state)
            handle = state.document.handles[k]
            self._store.set_document(state.document.with_handle(k, replace(handle, name=name)))

    def add_region(self) -> int:
        """One more region, without a vertex; its number, or that of the last where there can be no more."""
        state = self._gestures.alone()
        regions = state.document.regions
        if len(regions) >= MOST_REGIONS:
            self._listener.failed(
                tr("The limit is {most} regions; remove one first.").format(most=MOST_REGIONS)
            )
            return len(regions) - 1
        self._gestures.record(tr("Add region"), state)
        self._store.set_document(state.document.with_next_region())
        return len(regions)

    def remove_region(self, k: int) -> None:
        """Remove region ``k``, and what is asked of its area."""
        state = self._gestures.alone()
        self._gestures.record(tr("Remove region"), state)
        asked = state.document.regions[k].area is not None
        (self._store.solve if asked else self._store.set_document)(state.document.without_region(k))

    def rename_region(self, k: int, name: str) -> None:
        """Give region ``k`` a name of its own."""
        regions = self._store.required().document.regions
        name = new_name(name, regions[k].name, [region.name for region in regions])
        if name != regions[k].name:
            state = self._gestures.alone()
            self._gestures.record(tr("Rename"), state)
            region = state.document.regions[k]
            self._store.set_document(state.document.with_region(k, replace(region, name=name)))
