"""What is opened and written: one errand at a time, in the background."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.files.meshes import check_target, open_mesh, save_mesh
from apd_viewer.files.samples import SAMPLES, open_sample
from apd_viewer.files.selections.selection import Selection
from apd_viewer.files.selections.selection_files import read_selection_file, write_selection
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr
from apd_viewer.session.jobs.background_job import Errand, Errands
from apd_viewer.session.model.baking import baked
from apd_viewer.session.model.document import State, opened
from apd_viewer.session.model.status_text import (
    about_baking,
    about_export,
    about_findings,
    about_loaded_selection,
    about_selection,
    about_session,
)
from apd_viewer.session.model.view import SUFFIX, View
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.storage.session_file import open_session, save_session

if TYPE_CHECKING:
    from apd_viewer.session.gestures import Gestures
    from apd_viewer.session.store import Listener, Stage


class Files:
    """The verbs of a session that take their time.

    Parameters
    ----------
    stage : Stage
    gestures : Gestures
    listener : Listener

    Attributes
    ----------
    unit : Unit
        Of lengths, for what is told; the mesh that is open is in it.
    """

    def __init__(self, stage: Stage, gestures: Gestures, listener: Listener) -> None:
        self._stage = stage
        self._gestures = gestures
        self._listener = listener
        self._errands = Errands(listener.wake, listener.failed)
        self._kept: list[np.ndarray] = []
        self.unit = Unit.NONE

    @property
    def errand(self) -> Errand | None:
        """The file that is being opened or written."""
        return self._errands.current

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
        self.send(tr("Opening {name}").format(name=name), work, lambda found: self._opened(found, name, kept))

    def _opened(self, found: State | tuple[State, View], name: str, kept: bool) -> None:
        state, view = found if isinstance(found, tuple) else (found, None)
        before, self._gestures.before = self._gestures.before or self._stage.state, None
        if before is not None:
            self._gestures.history.record(tr("Open {name}").format(name=name), before)
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

        self.send(
            tr("Loading {name}").format(name=path.name), lambda: read_selection_file(path, mesh), loaded
        )

    def save_selection(self, path: str | Path) -> None:
        """Write what is painted, in the background."""
        path, document = Path(path), self._stage.required().document

        def work() -> str:
            return about_selection(path.name, write_selection(path, document.mesh, document.selection))

        self.send(
            tr("Saving {name}").format(name=path.name), work, self._listener.told, can_be_cancelled=False
        )

    def _write(self, title: str, work: Callable[[], str], state: State) -> None:
        """Do the ``work``, which says what it has done, and remember that the shape is in a file."""

        def written(said: str) -> None:
            self._kept.append(state.frame.U)
            self._listener.told(said)

        self.send(title, work, written, can_be_cancelled=False)

    def send(
        self,
        title: str,
        work: Callable[[], object],
        done: Callable[..., object],
        can_be_cancelled: bool = True,
    ) -> None:
        """Do ``work`` in the background, and call ``done`` with its value; a failure is told."""
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
        return self._gestures.history.unsaved(self._stage.state, self._kept)

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

        self.send(tr("Measuring the new rest shape"), lambda: baked(shown), done)
