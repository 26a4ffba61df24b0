"""Active handle, region and obstacle, which are not part of the document."""

from PySide6.QtCore import QObject, Signal

from apd_viewer.session.model.document import Document
from apd_viewer.session.session import Session


class ActiveParts(QObject):
    """Active handle and region, and the active obstacle if any.

    Attributes
    ----------
    handle, region : int
        Indices of the active parts, from 0. There may be no region yet.
    obstacle : int or None
        Number of the obstacle in the hand; None while the handle is.
    changed : Signal()
        Another one is active.
    """

    changed = Signal()

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self.handle = self.region = 0
        self.obstacle: int | None = None

    def follow_document(self, old: Document | None, new: Document) -> None:
        """Keep the active parts valid for a new document."""
        if old is None or old.mesh is not new.mesh:
            self.handle = self.region = 0
            self.obstacle = None
        self.handle = min(self.handle, len(new.handles) - 1)
        self.region = max(0, min(self.region, len(new.regions) - 1))
        if self.obstacle is not None and self.obstacle >= len(new.obstacles):
            self.obstacle = len(new.obstacles) - 1 if new.obstacles else None

    def choose_handle(self, k: int) -> None:
        """Make handle ``k`` active; no obstacle is active then."""
        self._choose(k, self.region)

    def choose_region(self, k: int) -> None:
        """Make region ``k`` the active one."""
        self._choose(self.handle, k, self.obstacle)

    def choose_obstacle(self, k: int | None) -> None:
        """Make obstacle ``k`` active; None returns to the active handle."""
        self._choose(self.handle, self.region, k)

    def activate_next_handle(self) -> None:
        """Activate the next handle, in cyclic order."""
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
        """Remove handle ``k``; another active handle stays active."""
        before = self.handle
        self.handle -= k < before
        if not self._session.parts.remove_handle(k):
            self.handle = before

    def remove_region(self, k: int) -> None:
        """Remove region ``k``; another active region stays active."""
        before = self.region
        self.region -= k < before
        if not self._session.parts.remove_region(k):
            self.region = before

    def remove_obstacle(self, k: int) -> None:
        """Remove obstacle ``k``; another active obstacle stays active."""
        if self.obstacle is not None and k < self.obstacle:
            self.obstacle -= 1
        self._session.obstacles.remove(k)

    def _choose(self, handle: int, region: int, obstacle: int | None = None) -> None:
        if (handle, region, obstacle) != (self.handle, self.region, self.obstacle):
            self.handle, self.region, self.obstacle = handle, region, obstacle
            self.changed.emit()
