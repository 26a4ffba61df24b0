"""The user's verbs. Owns the history, and the stage on which all is answered; knows no window.

All methods are called on one thread.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from apd_viewer.files.meshes import check_target, open_mesh, save_mesh
from apd_viewer.files.samples import SAMPLES, open_sample
from apd_viewer.files.selection import Selection
from apd_viewer.files.selection_files import read_selection_file, write_selection
from apd_viewer.geometry.constraints import transform
from apd_viewer.geometry.mesh import Mesh, frozen
from apd_viewer.language import tr
from apd_viewer.session.autosave import Autosave, watched
from apd_viewer.session.baking import baked
from apd_viewer.session.by_numbers import chosen, place
from apd_viewer.session.document import State, opened, rest_frame
from apd_viewer.session.errand import Errand, Errands
from apd_viewer.session.examining import Examining
from apd_viewer.session.expressions import length
from apd_viewer.session.gestures import Gestures
from apd_viewer.session.history import History
from apd_viewer.session.named_parts import IDENTITY
from apd_viewer.session.part import Part
from apd_viewer.session.parts import Parts
from apd_viewer.session.posing import MOTIONS, Motion, amount_of, moved, names_of
from apd_viewer.session.reshaping import CHANGES, Change, reshaped
from apd_viewer.session.saved import open_session, save_session
from apd_viewer.session.sentences import (
    about_baking,
    about_export,
    about_findings,
    about_loaded_selection,
    about_selection,
    about_session,
)
from apd_viewer.session.settings import Settings
from apd_viewer.session.stage import Activity, Listener, Stage
from apd_viewer.session.trace import Trace
from apd_viewer.session.units import Unit
from apd_viewer.session.view import SUFFIX, View
from apd_viewer.session.worker import Worker

__all__ = ["Activity", "Listener", "Session"]


class Session:
    """One mesh, what is painted on it, what is asked of it, and the worker that answers.

    Attributes
    ----------
    autosave : Autosave
    examining : Examining
    parts : Parts
    settings : Settings
    unit : Unit
        Of lengths, for what is told; the mesh that is open is in it.
    """

    def __init__(self, listener: Listener) -> None:
        listener = watched(listener, lambda: self.examining.follow())
        self._listener = listener = watched(listener, lambda: self.autosave.follow())
        self._worker = Worker(listener.wake)
        self._stage = Stage(listener, self._worker)
        self._errands = Errands(listener.wake, listener.failed)
        self._kept: list[np.ndarray] = []
        self._gestures = Gestures(self._stage, listener)
        self.parts = Parts(self._stage, self._gestures, listener)
        self.settings = Settings(self._stage, self._gestures, listener)
        self.autosave = Autosave(self._stage, self._gestures, listener, self._open)
        self.examining = Examining(self._stage, self._gestures, listener)
        self.unit = Unit.NONE

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
    def errand(self) -> Errand | None:
        """The file that is being opened or written."""
        return self._errands.current

    # Opening and writing

    def open(self, path: str | Path) -> None:
        """Open a mesh or a session, in the background; what is open stays until the new one is there."""
        path = Path(path)
        saved = path.suffix.lower() == SUFFIX
        self._open(path.name, lambda: open_session(path) if saved else opened(open_mesh(path)))

    def open_sample(self, name: str) -> None:
        """Open a sample, painted, in the background."""
        self._open(SAMPLES[name], lambda: opened(*open_sample(name)))

    def show(self, mesh: Mesh) -> None:
        """Open a mesh that is in memory already."""
        self._open(mesh.name, lambda: opened(mesh))

    def _open(self, name: str, work: Callable[[], State | tuple[State, View]], kept: bool = True) -> None:
        self._send(
            tr("Opening {name}").format(name=name), work, lambda found: self._opened(found, name, kept)
        )

    def _opened(self, found: State | tuple[State, View], name: str, kept: bool) -> None:
        state, view = found if isinstance(found, tuple) else (found, None)
        before, self._gestures.before = self._gestures.before or self.state, None
        if before is not None:
            self.history.record(tr("Open {name}").format(name=name), before)
            if view is None:  # a session has settings of its own
                state = state.at(state.document.with_settings_of(before.document))
        self._stage.jump(state)
        if view is not None:
            self._kept += [state.frame.U] if kept else []
            self._listener.viewed(view)
        if findings := about_findings(state.inspection.findings):
            self._listener.told(findings)

    def export(self, path: str | Path) -> None:
        """Write the shape on screen, in the background."""
        path, state, unit = Path(path), self._stage.required(), self.unit

        def write() -> str:
            file = save_mesh(state.document.mesh, state.frame.U, check_target(path))
            return about_export(path.name, file.area, state.inspection.area, unit)

        self._write(tr("Writing {name}").format(name=path.name), write, state)

    def save(self, path: str | Path, view: View, embed: bool = False) -> None:
        """Save what was said and the shape as a session, in the background; no gesture that is under way."""
        path, state = Path(path), self._gestures.before or self._stage.required()

        def write() -> str:
            return about_session(path.name, save_session(path, state, view, embed))

        self._write(tr("Saving {name}").format(name=path.name), write, state)

    def load_selection(self, path: str | Path) -> None:
        """Paint the mesh as a file says, in the background; what was painted gives way."""
        path, mesh = Path(path), self._stage.required().document.mesh

        def loaded(selection: Selection) -> None:
            state = self._gestures.alone()
            if state.document.mesh is mesh:  # another one may have been opened meanwhile
                self._gestures.record(tr("Load selection"), state)
                self._stage.regrip(state.document, state.document.with_selection(selection))
                self._listener.told(about_loaded_selection(path.name, selection))

        self._send(
            tr("Loading {name}").format(name=path.name), lambda: read_selection_file(path, mesh), loaded
        )

    def save_selection(self, path: str | Path) -> None:
        """Write what is painted, in the background."""
        path, document = Path(path), self._stage.required().document

        def work() -> str:
            return about_selection(path.name, write_selection(path, document.mesh, document.selection))

        self._send(
            tr("Saving {name}").format(name=path.name), work, self._listener.told, can_be_cancelled=False
        )

    def _write(self, title: str, work: Callable[[], str], state: State) -> None:
        """Do the ``work``, which says what it has done, and remember that the shape is in a file."""

        def written(said: str) -> None:
            self._kept.append(state.frame.U)
            self._listener.told(said)

        self._send(title, work, written, can_be_cancelled=False)

    def _send(
        self,
        title: str,
        work: Callable[[], object],
        done: Callable[..., object],
        can_be_cancelled: bool = True,
    ) -> None:
        self._errands.send(title, work, done, can_be_cancelled)
        self._listener.status_changed()

    def cancel_errand(self) -> None:
        """Forget the file that is being opened; a file being written is left to finish, whole."""
        if cancelled := self._errands.cancel():
            self._listener.told(tr("{title}: cancelled.").format(title=cancelled.title))
            self._listener.status_changed()

    @property
    def unsaved(self) -> list[Mesh]:
        """The meshes, on screen or a few undos away, whose latest shape is in no file."""
        return self.history.unsaved(self.state, self._kept)

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
            asks = any(region.area is not None for region in document.regions)
            (self._stage.say if asks else self._stage.note)(document)

    def end_stroke(self, gesture: str) -> None:
        """Finish painting; under new labels, base and handles are gripped where they are now."""
        before, document = self._gestures.before, self._stage.required().document
        self.end_gesture(gesture)
        if before is not None and not np.array_equal(before.document.labels, document.labels):
            self._stage.regrip(before.document, document)

    def set_part(self, part: Part, wanted: np.ndarray, gesture: str) -> None:
        """Have the ``wanted`` vertices, (n,) bool, and no others, in a part: a step of undo."""
        document = part.become(self._gestures.alone().document, wanted)
        self.begin_gesture()
        asks = part.is_region and any(region.area is not None for region in document.regions)
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
        self.set_part(part, reshaped(self._gestures.alone(), part, Change[change]), CHANGES[Change[change]])

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

    def bake(self) -> None:
        """Take the shape on screen for the rest shape, in the background: its area is 100 % from then on."""
        shown = self._gestures.alone()

        def done(at_rest: State) -> None:
            state = self._gestures.alone()
            if state.document is not shown.document:
                self._listener.failed(tr("Something else has been asked for meanwhile; bake the new shape."))
                return
            self._gestures.record(tr("Bake as new rest"), state)
            self._stage.jump(at_rest)
            self._listener.told(about_baking(shown.frame.area, shown.inspection.area, self.unit))

        self._send(tr("Measuring the new rest shape"), lambda: baked(shown), done)

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
