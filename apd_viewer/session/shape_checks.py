"""Has every shape that has come to rest examined, and knows what was found of the one on screen."""

from __future__ import annotations

from typing import TYPE_CHECKING

from apd_viewer.session.processes.shape_checker import Examiner, Shape
from apd_viewer.session.store import Activity

if TYPE_CHECKING:
    import numpy as np

    from apd_viewer.geometry.analysis.shape_check import Examination
    from apd_viewer.geometry.mesh.mesh import Mesh
    from apd_viewer.session.gestures import Gestures
    from apd_viewer.session.listener import Listener
    from apd_viewer.session.store import Store


class ShapeChecks:
    """Follows the store, and tells the listener when more or less is known.

    Parameters
    ----------
    store : Store
    gestures : Gestures
    listener : Listener

    Attributes
    ----------
    found : Examination or None
        Of the shape on screen; None while it moves, and until that has been examined.
    at_rest : Examination or None
        Of the mesh as it was opened.
    """

    def __init__(self, store: Store, gestures: Gestures, listener: Listener) -> None:
        self._store = store
        self._gestures = gestures
        self._listener = listener
        self._examiner = Examiner(listener.wake)
        self._mesh: Mesh | None = None
        self._last: tuple[np.ndarray, Examination] | None = None
        self._wanted: np.ndarray | None = None
        self.found: Examination | None = None
        self.at_rest: Examination | None = None

    @property
    def under_way(self) -> bool:
        """Whether the shape on screen is at rest, and will be known."""
        return self._wanted is not None

    def follow(self) -> None:
        """Look whether there is another shape on screen, and whether it rests."""
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
            self._listener.examined()

    def receive(self) -> None:
        """Take in what was found."""
        answer = self._examiner.take()
        if answer is None or self._mesh is None:
            return
        shape, found = answer
        if shape.U is self._mesh.V:
            self.at_rest = found
        self._last = shape.U, found
        if self._wanted is not None:
            self.found = self._known(self._wanted)
            self._ask(self._wanted if self.found is None else None)
        self._listener.examined()

    def close(self) -> None:
        """End what is under way."""
        self._examiner.close()

    def _known(self, U: np.ndarray) -> Examination | None:
        """What was found of the shape ``U`` (n, 3), if that was the mesh at rest or the last one."""
        if self._mesh is not None and U is self._mesh.V:
            return self.at_rest
        return self._last[1] if self._last is not None and U is self._last[0] else None

    def _ask(self, U: np.ndarray | None) -> None:
        """Have ``U`` (n, 3) examined, or nothing; before the first one the mesh at rest, to compare with."""
        self._wanted = U
        if U is None or self._mesh is None:
            self._examiner.forget()
        else:
            self._examiner.ask(Shape(self._mesh.V if self.at_rest is None else U, self._mesh.joined_F))
