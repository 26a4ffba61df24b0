"""Active handle and active region, neither part of the document."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

if TYPE_CHECKING:
    from apd_viewer.session.model.document import Document
    from apd_viewer.session.session import Session


class ActiveParts(QObject):
    """The active handle and the active region.

    Parameters
    ----------
    session : Session
    parent : QObject

    Attributes
    ----------
    handle, region : int
        Their numbers, from 0. There may be no region yet.
    changed : Signal()
        Another one is active.
    """

    changed = Signal()

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self.handle = self.region = 0

    def follow(self, old: Document | None, new: Document) -> None:
        """Keep the active parts while they exist."""
        if old is None or old.mesh is not new.mesh:
            self.handle = self.region = 0
        self.handle = min(self.handle, len(new.handles) - 1)
        self.region = max(0, min(self.region, len(new.regions) - 1))

    def choose_handle(self, k: int) -> None:
        """Make handle ``k`` the active one."""
        self._choose(k, self.region)

    def choose_region(self, k: int) -> None:
        """Make region ``k`` the active one."""
        self._choose(self.handle, k)

    def next_handle(self) -> None:
        """Make the next handle active, after the last one the first."""
        state = self._session.store.state
        if state is not None:
            self.choose_handle((self.handle + 1) % len(state.document.handles))

    def add_handle(self) -> None:
        """Add a handle and make it active."""
        self.choose_handle(self._session.parts.add_handle())

    def add_region(self) -> None:
        """Add a region and make it active."""
        self.choose_region(self._session.parts.add_region())

    def remove_handle(self, k: int) -> None:
        """Remove handle ``k`` and keep the active one, if it is another."""
        if k < self.handle:
            self.handle -= 1
        self._session.parts.remove_handle(k)

    def remove_region(self, k: int) -> None:
        """Remove region ``k`` and keep the active one, if it is another."""
        if k < self.region:
            self.region -= 1
        self._session.parts.remove_region(k)

    def _choose(self, handle: int, region: int) -> None:
        if (handle, region) != (self.handle, self.region):
            self.handle, self.region = handle, region
            self.changed.emit()
