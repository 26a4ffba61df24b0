"""The user's verbs. Owns the history, and the stage on which all is answered; knows no window.

All methods are called on one thread.
"""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from apd_viewer.geometry.mesh.mesh import frozen
from apd_viewer.geometry.pose.constraints import transform
from apd_viewer.language import tr
from apd_viewer.session.autosave import Autosave, watched
from apd_viewer.session.file_jobs import Files
from apd_viewer.session.gestures import Gestures
from apd_viewer.session.model.document import State, rest_frame
from apd_viewer.session.model.history import History
from apd_viewer.session.model.named_parts import IDENTITY
from apd_viewer.session.model.painted_part import Part
from apd_viewer.session.model.trace import Trace
from apd_viewer.session.part_operations import Change, reshaped
from apd_viewer.session.parts import Parts
from apd_viewer.session.processes.worker import Worker
from apd_viewer.session.quantities.expressions import length
from apd_viewer.session.settings import Settings
from apd_viewer.session.shape_checks import Examining
from apd_viewer.session.store import Activity, Listener, Stage
from apd_viewer.session.typed_motion import MOTIONS, Motion, amount_of, moved, names_of
from apd_viewer.session.vertex_expression import chosen, place

__all__ = ["Activity", "Listener", "Session"]


class Session(Files):
    """One mesh, what is painted on it, what is asked of it, and the worker that answers.

    Attributes
    ----------
    autosave : Autosave
    examining : Examining
    parts : Parts
    settings : Settings
    """

    def __init__(self, listener: Listener) -> None:
        listener = watched(listener, lambda: self.examining.follow())
        self._listener = listener = watched(listener, lambda: self.autosave.follow())
        self._worker = Worker(listener.wake)
        self._stage = Stage(listener, self._worker)
        self._gestures = Gestures(self._stage, listener)
        super().__init__(self._stage, self._gestures, listener)
        self.parts = Parts(self._stage, self._gestures, listener)
        self.settings = Settings(self._stage, self._gestures, listener)
        self.autosave = Autosave(self._stage, self._gestures, listener, self._open)
        self.examining = Examining(self._stage, self._gestures, listener)

    @property
    def state(self) -> State | None:
        """What is open; None until there is something."""
        return self._stage.state

    @property
    def activity(self) -> Activity:
        """What the worker is doing about the shape on screen."""
        return self._stage.activity

    @property
    def preparing(self) -> bool:
        """Whether the first shape has to wait until the worker is ready for it."""
        return self._stage.preparing

    @property
    def seconds_per_iteration(self) -> float:
        """Time that the last iteration took."""
        return self._stage.seconds_per_iteration

    @property
    def trace(self) -> Trace:
        """The readings on the way to the shape on screen."""
        return self._stage.trace

    @property
    def moved(self) -> bool:
        """Whether anything is not as it was at rest, or asked not to be."""
        state = self._stage.required()
        document = state.document
        asks = any(percent not in (None, 100.0) for percent in document.targets)
        return state.frame.U is not document.mesh.V or document.posed or asks

    # Gestures

    def begin_gesture(self) -> None:
        """Start what will be one step of undo, such as a stroke, a drag or the sweep of a slider."""
        self._gestures.begin()

    def end_gesture(self, gesture: str) -> None:
        """Finish a drag or a sweep; the worker goes on until the shape has settled."""
        self._gestures.end(gesture)

    def cancel_gesture(self) -> None:
        """Go back to where the gesture began."""
        self._gestures.cancel()

    # Painting

    def paint(self, ids: np.ndarray, label: int) -> None:
        """Label the vertices ``ids`` within the current gesture; the shape stays as it is."""
        state = self._stage.required()
        if self._gestures.before is not None:  # undo may have ended the stroke
            self._stage.show(state.at(state.document.painted(ids, label)))

    def paint_region(self, ids: np.ndarray, number: int) -> None:
        """Put the vertices ``ids`` in region ``number``, from 1, within the current gesture; 0 erases.

        One number past the last makes a region: the first stroke needs none to be there.
        """
        state = self._stage.required()
        if self._gestures.before is not None:
            document = state.document
            if number > len(document.regions):
                document = document.with_next_region()
            document = document.painted_region(ids, number)
            (self._stage.say if document.asks_of_regions else self._stage.note)(document)

    def end_stroke(self, gesture: str) -> None:
        """Finish painting; under new labels, base and handles are gripped where they are now."""
        before, document = self._gestures.before, self._stage.required().document
        if before is not None and document.says_as(before.document):
            # What replaces a part by itself clears it first; there is nothing to take back.
            document = before.document
            self._stage.unsay(document)
        self.end_gesture(gesture)
        if before is not None and not np.array_equal(before.document.labels, document.labels):
            self._stage.regrip(before.document, document)

    def set_part(self, part: Part, wanted: np.ndarray, gesture: str) -> None:
        """Have the ``wanted`` vertices, (n,) bool, and no others, in a part: a step of undo."""
        document = part.become(self._gestures.alone().document, wanted)
        self.begin_gesture()
        asks = part.is_region and document.asks_of_regions
        (self._stage.say if asks else self._stage.note)(document)
        self.end_stroke(gesture)

    def chosen(self, text: str) -> np.ndarray:
        """The vertices that a text names by ids or coordinates; raises InputError with a sentence."""
        return chosen(text, self._stage.required(), self.unit)

    def length(self, text: str) -> float:
        """The length that a text says, mesh units; raises InputError with a sentence."""
        return length(text, self.unit, names_of(self._stage.required()))

    def place(self, text: str) -> np.ndarray:
        """The point (3,) that a text names by its coordinates; raises InputError with a sentence."""
        return place(text, self._stage.required(), self.unit)

    def reshape(self, part: Part, change: str) -> None:
        """Change a part as a whole, as a :class:`Change` by its name."""
        wanted = reshaped(self._gestures.alone(), part, Change[change])
        self.set_part(part, wanted, Change[change].value.title)

    # Handles

    def move_handle(self, pose: np.ndarray, which: int = 0) -> None:
        """Put a handle at ``pose`` (4, 4), measured from where it was gripped, within a gesture."""
        state = self._stage.required()
        if self._gestures.before is not None:  # another mesh may have ended the drag
            self._stage.say(state.document.moved(which, pose))

    def pose_handle(self, pose: np.ndarray, which: int, gesture: str, repeats: bool = False) -> None:
        """Put a handle at ``pose`` (4, 4) at once; what ``repeats`` the step before is part of it."""
        state = self._gestures.alone()
        if state.document.problem:
            self._listener.failed(state.document.problem)
        elif not np.array_equal(pose, state.document.handles[which].pose):
            self._gestures.record(gesture, state, repeats)
            self._stage.say(state.document.moved(which, pose))

    def type_motion(self, motion: str, text: str, which: int, line: np.ndarray | None = None) -> None:
        """Move a handle by what was typed; ``motion`` names a :class:`Motion`. Raises InputError.

        ``line`` (2, 3) is what a bend about a line is about.
        """
        state, kind = self._gestures.alone(), Motion[motion]
        amount = amount_of(kind, text, state, self.unit)
        self.pose_handle(moved(state.document, which, kind, amount, line), which, MOTIONS[kind])

    def set_pivot(self, point: np.ndarray | None, which: int) -> None:
        """Have a handle turn about a ``point`` (3,) of where it is now; None is its centre."""
        state = self._gestures.alone()
        handle = state.document.handles[which]
        if point is not None:
            point = frozen(transform(np.linalg.inv(handle.pose), np.asarray(point, dtype=float)[None])[0])
        elif handle.pivot is None:
            return
        self._gestures.record(tr("Move pivot"), state)
        self._stage.note(state.document.with_handle(which, replace(handle, pivot=point)))

    def put_back_handle(self, which: int) -> None:
        """Put one handle back where it was gripped; the mesh follows."""
        self.pose_handle(IDENTITY, which, tr("Put handle back"))

    def reset_handle(self) -> None:
        """Put the handles back and the mesh in its rest shape, asked for 100 % of all; the paint stays."""
        state = self._gestures.alone()
        if self.moved:
            self._gestures.record(tr("Reset handle"), state)
            rest = rest_frame(state.document.mesh, state.inspection)
            self._stage.jump(state.at(state.document.at_rest(), rest))

    # Going back

    @property
    def history(self) -> History:
        """What can be undone and redone."""
        return self._gestures.history

    def undo(self) -> None:
        """Take the last gesture back: the very document and shape that were there before it."""
        self._gestures.undo()

    def redo(self) -> None:
        """Do again what was undone last."""
        self._gestures.redo()

    def travel(self, steps: int) -> None:
        """Undo or redo until so many gestures are done."""
        self._gestures.travel(steps)

    # The other threads

    def receive(self) -> None:
        """Take in what the worker and the errands have left; call it when woken."""
        while self._errands.receive():
            self._listener.status_changed()
        self._stage.receive()
        self.autosave.receive()
        self.examining.receive()

    def wait_idle(self, timeout: float) -> bool:
        """Receive until nothing is under way any more; False if that took longer than ``timeout`` seconds."""
        until = time.monotonic() + timeout
        while time.monotonic() < until:
            self.receive()
            if self.errand is None and self.activity is not Activity.REFINING:
                return True
            time.sleep(0.002)
        return False

    def close(self) -> None:
        """Stop the worker; a file that is being written is finished first."""
        self._errands.close()
        self.autosave.close()
        self.examining.close()
        self._worker.close()
