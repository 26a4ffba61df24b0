"""Self-intersection and size checks of every shape at rest."""

from __future__ import annotations

from typing import TYPE_CHECKING

from apd_viewer.session.processes.shape_checker import Shape, ShapeChecker
from apd_viewer.session.store import Activity

if TYPE_CHECKING:
    import numpy as np

    from apd_viewer.geometry.analysis.shape_check import ShapeCheck
    from apd_viewer.geometry.mesh.mesh import Mesh
    from apd_viewer.session.gestures import Gestures
    from apd_viewer.session.listener import Listener
    from apd_viewer.session.store import Store


class ShapeChecks:
    """Checks the shape on screen once it rests, and tells the listener of the result.

    Parameters
    ----------
    store : Store
    gestures : Gestures
    listener : Listener

    Attributes
    ----------
    found : ShapeCheck or None
        Of the shape on screen; None while it moves, and until that has been checked.
    at_rest : ShapeCheck or None
        Of the mesh as it was opened.
    """

    def __init__(self, store: Store, gestures: Gestures, listener: Listener) -> None:
        self._store = store
        self._gestures = gestures
        self._listener = listener
        self._checker = ShapeChecker(listener.wake)
        self._mesh: Mesh | None = None
        self._last: tuple[np.ndarray, ShapeCheck] | None = None
        self._wanted: np.ndarray | None = None
        self.found: ShapeCheck | None = None
        self.at_rest: ShapeCheck | None = None

    @property
    def under_way(self) -> bool:
        """True while the shape on screen is being checked."""
        return self._wanted is not None

    def follow(self) -> None:
        """Start a check if another shape rests on screen; stop one if it moves."""
        state = self._store.state
        if state is None:
            return
        mesh, U = state.document.mesh, state.frame.U
        if mesh is not self._mesh:
            self._mesh, self.at_rest = mesh, None
        rests = self._gestures.before is None and self._store.activity is not Activity.REFINING
        found = self._known(U)
        wanted = U if found is None and rests else None
        if found is not self.found or wanted is not self._wanted:
            self.found = found
            self._ask(wanted)
            self._listener.measured()

    def receive(self) -> None:
        """Receive the result of a check."""
        answer = self._checker.take()
        if answer is None or self._mesh is None:
            return
        shape, found = answer
        if shape.U is self._mesh.V:
            self.at_rest = found
        self._last = shape.U, found
        if self._wanted is not None:
            self.found = self._known(self._wanted)
            self._ask(self._wanted if self.found is None else None)
        self._listener.measured()

    def close(self) -> None:
        """Stop the check under way."""
        self._checker.close()

    def _known(self, U: np.ndarray) -> ShapeCheck | None:
        """Result for ``U`` (n, 3), if it is at rest or was checked last."""
        if self._mesh is not None and U is self._mesh.V:
            return self.at_rest
        return self._last[1] if self._last is not None and U is self._last[0] else None

    def _ask(self, U: np.ndarray | None) -> None:
        """Check ``U`` (n, 3), or nothing; the mesh at rest comes first, for comparison."""
        self._wanted = U
        if U is None or self._mesh is None:
            self._checker.forget()
        else:
            self._checker.ask(Shape(self._mesh.V if self.at_rest is None else U, self._mesh.joined_F))
