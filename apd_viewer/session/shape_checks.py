"""Self-intersection and size checks of every shape at rest."""

from __future__ import annotations

from typing import TYPE_CHECKING

from apd_viewer.session.model.handle_paths import turning_of
from apd_viewer.session.processes.shape_checker import Shape, ShapeChecker
from apd_viewer.session.store import Activity

if TYPE_CHECKING:
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
        self._last: tuple[Shape, ShapeCheck] | None = None
        self._wanted: Shape | None = None
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
        shape = Shape(U, mesh.joined_F, turning_of(state.document))
        found = self._known(shape)
        wanted = shape if found is None and rests else None
        if found is not self.found or not _alike(wanted, self._wanted):
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
        self._last = shape, found
        if self._wanted is not None:
            self.found = self._known(self._wanted)
            self._ask(self._wanted if self.found is None else None)
        self._listener.measured()

    def close(self) -> None:
        """Stop the check under way."""
        self._checker.close()

    def _known(self, shape: Shape) -> ShapeCheck | None:
        """Result for a shape, if it is at rest or was checked last."""
        if self._mesh is not None and shape.U is self._mesh.V:
            return self.at_rest
        return self._last[1] if self._last is not None and _alike(shape, self._last[0]) else None

    def _ask(self, shape: Shape | None) -> None:
        """Check a shape, or nothing; the mesh at rest comes first, for comparison."""
        self._wanted = shape
        if shape is None or self._mesh is None:
            self._checker.forget()
        else:
            self._checker.ask(Shape(self._mesh.V, shape.F) if self.at_rest is None else shape)


def _alike(one: Shape | None, other: Shape | None) -> bool:
    if one is None or other is None:
        return one is other
    turning = one.turning
    return one.U is other.U and (turning is other.turning if turning is None else turning.same(other.turning))
