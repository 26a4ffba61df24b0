"""Look at an end of a range on the mesh, and back again without a trace."""

from __future__ import annotations

from apd_viewer.session.model.document import Document
from apd_viewer.session.model.state import State
from apd_viewer.session.session import Session
from apd_viewer.ui.posing.motion_ghost import MotionGhost


class EndPreview:
    """Shows documents within a gesture that is taken back.

    Parameters
    ----------
    session : Session
    ghost : MotionGhost
        Shows the handles at once; the mesh follows.
    """

    def __init__(self, session: Session, ghost: MotionGhost) -> None:
        self._session, self._ghost = session, ghost
        self._before: State | None = None

    @property
    def is_showing(self) -> bool:
        """True while it shows anything."""
        return self._before is not None and self._session.gestures.state_before is self._before

    def show(self, document: Document) -> None:
        """Show a document, if its mesh is open and no other gesture is under way."""
        gestures, state = self._session.gestures, self._session.store.state
        if state is None or state.document.mesh is not document.mesh:
            return
        if not self.is_showing:
            if gestures.state_before is not None:
                return
            gestures.begin()
            self._before = gestures.state_before
        self._ghost.show_handles(document)
        self._session.handles.solve_poses(document)

    def hide(self) -> None:
        """Return to the state before."""
        self._ghost.hide()
        gestures, before, self._before = self._session.gestures, self._before, None
        if before is None:
            return
        if gestures.state_before is before:
            gestures.cancel()
        elif (
            gestures.state_before is not None and gestures.state_before.document.mesh is before.document.mesh
        ):
            gestures.state_before = before  # a drag that began on what was shown is undone to what was before
