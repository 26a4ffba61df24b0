"""Checks of the displayed shape, and findings about loose parts.

The shape is checked for self-intersections and size.
"""

from collections.abc import Iterator

import numpy as np

from apd_viewer.geometry.analysis.mesh_findings import Finding
from apd_viewer.geometry.analysis.shape_check import ShapeCheck
from apd_viewer.geometry.mesh.arrays import used_vertices
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import FREE
from apd_viewer.language import tr, trn
from apd_viewer.session.gestures import Gestures
from apd_viewer.session.model import memo
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.handle_paths import handle_turns
from apd_viewer.session.processes.shape_checker import ShapeChecker, ShapeQuery
from apd_viewer.session.state_store import Activity, Listener, StateStore

# Number of parts listed individually, the largest first; the first finding includes all.
_MOST = 100


class ShapeChecks:
    """Checks of the displayed shape while the solver is idle.

    Attributes
    ----------
    shape_check : ShapeCheck or None
        Of the shape on screen; None while it moves, and until that has been checked.
    rest_check : ShapeCheck or None
        Of the mesh as it was opened.
    """

    def __init__(self, store: StateStore, gestures: Gestures, listener: Listener) -> None:
        self._store = store
        self._gestures = gestures
        self._listener = listener
        self._checker = ShapeChecker(listener.wake)
        self._mesh: Mesh | None = None
        self._last: tuple[ShapeQuery, ShapeCheck] | None = None
        self._wanted: ShapeQuery | None = None
        self.shape_check: ShapeCheck | None = None
        self.rest_check: ShapeCheck | None = None

    @property
    def is_checking(self) -> bool:
        """True while the displayed shape is being checked."""
        return self._wanted is not None

    def follow_state(self) -> None:
        """Check a new displayed shape while the solver is idle; cancel otherwise."""
        state = self._store.state
        if state is None:
            return
        mesh, U = state.document.mesh, state.frame.U
        if mesh is not self._mesh:
            self._mesh, self.rest_check = mesh, None
        shape = ShapeQuery(U, mesh.joined_F, handle_turns(state.document))
        found = self._known_check(shape)
        # A stroke does not move the shape: a large mesh, checked in minutes, would never be between strokes.
        goes_on = self._gestures.state_before is None or _is_same_query(shape, self._wanted)
        rests = goes_on and self._store.activity is not Activity.REFINING
        wanted = shape if found is None and rests else None
        if found is not self.shape_check or not _is_same_query(wanted, self._wanted):
            self.shape_check = found
            self._ask(wanted)
            self._listener.measurements_changed()

    def receive_check(self) -> None:
        """Store the result of a check."""
        answer = self._checker.take()
        if answer is None or self._mesh is None:
            return
        shape, found = answer
        if shape.U is self._mesh.V:
            self.rest_check = found
        self._last = shape, found
        if self._wanted is not None:
            self.shape_check = self._known_check(self._wanted)
            self._ask(self._wanted if self.shape_check is None else None)
        self._listener.measurements_changed()

    def close(self) -> None:
        """Stop the running check."""
        self._checker.close()

    def _known_check(self, shape: ShapeQuery) -> ShapeCheck | None:
        """Result for the rest shape or the last checked shape; None for other shapes."""
        if self._mesh is not None and shape.U is self._mesh.V:
            return self.rest_check
        return self._last[1] if self._last is not None and _is_same_query(shape, self._last[0]) else None

    def _ask(self, shape: ShapeQuery | None) -> None:
        """Request a check of the rest shape, then of ``shape``; None cancels."""
        self._wanted = shape
        if shape is None or self._mesh is None:
            self._checker.cancel()
        else:
            self._checker.ask(ShapeQuery(self._mesh.V, shape.F) if self.rest_check is None else shape)


def _is_same_query(one: ShapeQuery | None, other: ShapeQuery | None) -> bool:
    if one is None or other is None:
        return one is other
    turning = one.handle_turns
    return one.U is other.U and (
        turning is other.handle_turns if turning is None else turning.has_equal_arrays(other.handle_turns)
    )


def loose_component_findings(document: Document) -> Iterator[tuple[Finding, tuple[int, ...]]]:
    """Findings about all loose parts, then about each with its lowest vertex ID.

    Before anything is painted, the largest part is left out, since it will probably be painted.
    """
    parts = document.loose_components
    if not (document.labels != FREE).any():
        parts = parts[1:]
    if len(parts) > 1:
        said = tr("All {n:,} loose parts").format(n=len(parts))
        yield _finding(document, said, tuple(part.first for part in parts))
    for part in parts[:_MOST]:
        said = trn("Loose part, {n:,} triangle", "Loose part, {n:,} triangles", part.triangles)
        yield _finding(document, said.format(n=part.triangles), (part.first,))


def _finding(document: Document, sentence: str, firsts: tuple[int, ...]) -> tuple[Finding, tuple[int, ...]]:
    mesh = document.mesh
    vertices = used_vertices(mesh.F[np.isin(memo.triangle_components(mesh.joined_F), firsts)])
    return Finding("loose part", sentence, vertices), firsts
