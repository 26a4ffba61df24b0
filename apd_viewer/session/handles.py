"""Poses and pivots of the handles: dragged, typed, nudged or reset."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.pose.constraints import transform
from apd_viewer.language import tr
from apd_viewer.session.model.handle_paths import without_last_digits
from apd_viewer.session.posing.motion_plan import MotionPlan, planned
from apd_viewer.session.posing.motion_titles import title_between
from apd_viewer.session.posing.symmetry import both_put_back, moved
from apd_viewer.session.quantities.clear_numbers import as_typed

if TYPE_CHECKING:
    from apd_viewer.geometry.mesh.mesh import Mesh
    from apd_viewer.session.gestures import Gestures
    from apd_viewer.session.listener import Listener
    from apd_viewer.session.model.document import Document
    from apd_viewer.session.model.motions import TypedMotion
    from apd_viewer.session.model.named_parts import Handle
    from apd_viewer.session.store import Store


class Handles:
    """Moves the handles; the mesh follows.

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
        self._warned: Mesh | None = None

    def drag(self, pose: np.ndarray, which: int = 0) -> None:
        """Move a handle on to a pose (4, 4), relative to its grip, within a gesture."""
        state = self._store.required()
        if self._gestures.before is not None:  # another mesh may have ended the drag
            self._store.solve(moved(state.document, which, pose))

    def release(self, which: int = 0) -> None:
        """End the drag of a handle; the shape of a winding path is solved anew along it.

        The hand came there at its own pace, and a shape with many minima would tell.
        """
        before, document = self._gestures.before, self._store.required().document
        if before is not None:  # another mesh may have ended the drag
            self._gestures.end(title_between(before.document, document, which, self._store.unit))
            if document.winds:
                self._walk(document)

    def pose(self, pose: np.ndarray, which: int, gesture: str, repeats: bool = False) -> None:
        """Move a handle on to a pose (4, 4) as one step, or as part of the last."""
        self.go(moved(self._gestures.alone().document, which, pose), gesture, repeats)

    def plan(
        self, motion: TypedMotion, text: str, which: int, line: np.ndarray | None = None, to: bool = False
    ) -> MotionPlan:
        """Motion of a handle by a typed amount, or to that total, without making it.

        ``line`` (2, 3) is the axis of a bend about a line. Raises InputError if the text is none.
        """
        return planned(self._store.required(), which, motion, as_typed(text), self._store.unit, line, to)

    def move_by(
        self, motion: TypedMotion, text: str, which: int, line: np.ndarray | None = None, to: bool = False
    ) -> None:
        """Move a handle by a typed amount, or to that total; raises InputError."""
        self._gestures.cancel()
        plan = self.plan(motion, text, which, line, to)
        end = plan.end()
        self.go(end, plan.title(end, self._store.unit))

    def reset(self, which: int) -> None:
        """Bring one handle back to where it is at rest; the mesh follows."""
        state = self._gestures.alone()
        if state.document.problem or state.is_away(which):
            self.go(both_put_back(state.document, which), tr("Reset handle"))

    def go(self, document: Document, gesture: str, repeats: bool = False) -> None:
        """Go on to a document with other poses of its handles, as one step."""
        state = self._store.required()
        pairs = zip(state.document.handles, document.handles, strict=True)
        if state.document.problem:
            self._listener.failed(state.document.problem)
        elif document.grip is not state.document.grip or any(_differ(*pair) for pair in pairs):
            self._gestures.record(gesture, state, repeats)
            self.advance(document)

    def advance(self, document: Document) -> None:
        """Solve a document, along the paths of its handles if they wind.

        Anew too if they wound before: the shortest way back would leave the shape wound by a full turn.
        """
        before = self._store.required().document
        regripped = document.grip is not before.grip
        if document.winds or before.winds or (regripped and before.from_rest.winds):
            self._walk(document)
        else:
            self._store.solve(document)

    def _walk(self, document: Document) -> None:
        """Solve a document along its winding paths, and say once what may come of it."""
        kept_apart = document.contact and document.traits.may_touch
        if document.winds and not kept_apart and document.mesh is not self._warned:
            self._warned = document.mesh
            self._listener.told(
                tr(
                    "Beyond half a turn a thin wall may pass through itself and unwind; "
                    "the handle keeps its turns."
                )
            )
        self._store.walk(without_last_digits(document))

    def set_pivot(self, point: np.ndarray | None, which: int) -> None:
        """Set a handle's pivot to a ``point`` (3,) on screen; None is its centre."""
        state = self._gestures.alone()
        handle = state.document.handles[which]
        if point is not None:
            point = frozen(transform(np.linalg.inv(handle.pose), np.asarray(point, dtype=float)[None])[0])
        elif handle.pivot is None:
            return
        self._gestures.record(tr("Move pivot"), state)
        self._store.set_document(state.document.with_handle(which, replace(handle, pivot=point)))


def _differ(before: Handle, after: Handle) -> bool:
    return not np.array_equal(before.pose, after.pose) or len(before.waypoints) != len(after.waypoints)
