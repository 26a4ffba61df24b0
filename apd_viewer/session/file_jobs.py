"""Opening and writing files in the background."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.files.fe_deck import write_deck
from apd_viewer.files.known_file import KnownFile
from apd_viewer.files.mesh_writing import check_target, save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.samples import SAMPLES, open_sample
from apd_viewer.files.scalar_files import Rows, write_scalars
from apd_viewer.files.selections.selection import Selection
from apd_viewer.files.selections.selection_files import read_selection_file, write_selection
from apd_viewer.geometry.mesh.arrays import diagonal, frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.solver.methods import passing_walls
from apd_viewer.language import tr
from apd_viewer.session.model.document_selection import selection_of, with_selection
from apd_viewer.session.model.state import State, opened
from apd_viewer.session.model.status_text import (
    about_deck,
    about_export,
    about_findings,
    about_loaded_selection,
    about_missing_target,
    about_selection,
    about_session,
)
from apd_viewer.session.model.view import SUFFIX, View
from apd_viewer.session.quantities.deck_wall import WallWords, deck_wall
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.saved_work import SavedDocument
from apd_viewer.session.storage.checked_save import FileChangedError, save_over
from apd_viewer.session.storage.session_file import open_session
from apd_viewer.session.studies.deck_setup import deck_of

if TYPE_CHECKING:
    from apd_viewer.session.gestures import Gestures
    from apd_viewer.session.jobs.background_job import Jobs
    from apd_viewer.session.listener import Listener
    from apd_viewer.session.model.document import Document
    from apd_viewer.session.saved_work import SavedWork
    from apd_viewer.session.store import Store


class Files:
    """Opens and writes meshes, sessions and selections, one at a time.

    Parameters
    ----------
    store : Store
    gestures : Gestures
    saved_work : SavedWork
    jobs : Jobs
    listener : Listener
    """

    def __init__(
        self, store: Store, gestures: Gestures, saved_work: SavedWork, jobs: Jobs, listener: Listener
    ) -> None:
        self._store = store
        self._gestures = gestures
        self._saved_work = saved_work
        self._jobs = jobs
        self._listener = listener

    def open(self, path: str | Path) -> None:
        """Open a mesh or a session, in the background; the old one stays until then."""
        path = Path(path)
        if path.suffix.lower() == SUFFIX:
            self.open_with(path.name, lambda: open_session(path), path)
        else:
            self.open_with(path.name, lambda: opened(open_mesh(path)))

    def open_sample(self, name: str) -> None:
        """Open a sample, painted, in the background."""
        self.open_with(SAMPLES[name].title, lambda: opened_sample(name))

    def open_mesh(self, mesh: Mesh) -> None:
        """Open a mesh from memory."""
        self.open_with(mesh.name, lambda: opened(mesh))

    def open_with(
        self,
        name: str,
        work: Callable[[], State | tuple[State, View]],
        path: Path | None = None,
        saved: bool = True,
    ) -> None:
        """Open the result of ``work()``, in the background.

        ``path`` is the session file that it is in; ``saved`` is False for work in no file.
        """
        title = tr("Opening {name}").format(name=name)

        def parsed() -> tuple[State | tuple[State, View], KnownFile | None]:
            # First: what is written between the two is then taken for a change, and asked about.
            file = None if path is None else KnownFile(path)
            found = work()
            state = found[0] if isinstance(found, tuple) else found
            # Seconds in a large file; kept from now on.
            _ = state.document.mesh.colors, state.document.mesh.texture
            return found, file

        self._jobs.run(title, parsed, lambda done: self._opened(name, saved, *done))

    def _opened(
        self, name: str, saved: bool, found: State | tuple[State, View], file: KnownFile | None
    ) -> None:
        state, view = found if isinstance(found, tuple) else (found, None)
        before, self._gestures.before = self._gestures.before or self._store.state, None
        if before is not None:
            self._gestures.history.record(tr("Open {name}").format(name=name), before)
        if saved:
            self._saved_work.note(SavedDocument(state.document, file))
        self._store.jump(state)
        if view is not None:
            self._listener.viewed(view)
        about = (
            about_findings(state.inspection.findings),
            about_missing_target(state.document),
            "" if found is not state else _passing(state.document),
            state.document.mesh.texture[1],
        )
        if any(about):
            self._listener.told(" ".join(sentence for sentence in about if sentence))

    def export(self, path: str | Path, then: Callable[[], object] = lambda: None) -> None:
        """Write the shape on screen, in the background.

        ``then()`` follows if all went well.
        """
        path, state, unit = Path(path), self._store.required(), self._store.unit

        def write() -> str:
            known = "" if unit.is_guess else unit.symbol
            file = save_mesh(state.document.mesh, state.frame.U, check_target(path), known)
            return about_export(path.name, file.area, state.inspection.area, unit)

        self._write(tr("Writing {name}").format(name=path.name), write, then)

    def export_scalars(self, path: str | Path, rows: Rows) -> None:
        """Write the scalars of the shape on screen, in the background."""
        path, state = Path(path), self._store.required()

        def write() -> str:
            # Here, because numba need not be loaded for the first picture.
            from apd_viewer.geometry.analysis.scalars import scalars_of

            document, U = state.document, state.frame.U
            scalars = scalars_of(document.mesh, U, document.labels, document.member, document.target)
            write_scalars(path, document.mesh, U, scalars, rows)
            return tr("Exported scalars to {name}.").format(name=path.name)

        title = tr("Writing {name}").format(name=path.name)
        self._jobs.run(title, write, self._listener.told, can_be_cancelled=False)

    def export_deck(self, path: str | Path, view: View) -> None:
        """Write an FE deck that moves the rest shape to the poses, in the background."""
        path, document = Path(path), self._store.required().document

        def write() -> str:
            size, unit = diagonal(document.mesh.V), Unit(view.unit)
            deck = deck_of(document, deck_wall(WallWords(view.wall), unit, size))
            write_deck(path, deck)
            return about_deck(path.name, deck)

        self._write(tr("Writing {name}").format(name=path.name), write)

    def save(
        self,
        path: str | Path,
        view: View,
        embed: bool = False,
        then: Callable[[], object] = lambda: None,
        picture: bytes = b"",
        changed: Callable[[KnownFile], object] | None = None,
        over: KnownFile | None = None,
    ) -> None:
        """Save a session, in the background, without the gesture under way.

        Its own file is replaced only if that still holds what was opened or saved last. ``then()`` follows
        if all went well.

        Parameters
        ----------
        path, view, embed
            See :func:`apd_viewer.session.storage.session_file.save_session`.
        then : callable
        picture : bytes
            A PNG file of it, if there is one.
        changed : callable
            ``changed(file)``: somebody else has changed the file, and nothing was written. None says so in
            a sentence.
        over : KnownFile or None
            What may be replaced besides: such a file.
        """
        path, state = Path(path), self._gestures.before or self._store.required()
        known = over or self._saved_work.known_at(path)

        def write() -> tuple[bool, KnownFile] | FileChangedError:
            try:
                return save_over(known, path, state, view, embed, picture)
            except FileChangedError as error:
                return error

        def written(done: tuple[bool, KnownFile] | FileChangedError) -> None:
            if isinstance(done, tuple):
                embedded, file = done
                self._saved_work.note(SavedDocument(state.document, file, embed))
                self._listener.told(about_session(path.name, embedded))
                then()
            elif changed is None:
                self._listener.failed(str(done))
            else:
                changed(done.now)

        self._jobs.run(tr("Saving {name}").format(name=path.name), write, written, can_be_cancelled=False)

    def load_selection(self, path: str | Path) -> None:
        """Replace the paint by a selection file, in the background.

        Refused while a part is locked.
        """
        path, mesh = Path(path), self._store.required().document.mesh

        def loaded(selection: Selection) -> None:
            state = self._gestures.alone()
            if any(locked.any() for locked in state.document.flags.locked):
                self._listener.failed(tr("A selection replaces all parts; unlock them first."))
            elif state.document.mesh is mesh:  # another mesh may have been opened meanwhile
                self._gestures.record(tr("Load selection"), state)
                self._store.regrip(state.document, with_selection(state.document, selection))
                self._listener.told(about_loaded_selection(path.name, selection))

        self._jobs.run(
            tr("Loading {name}").format(name=path.name), lambda: read_selection_file(path, mesh), loaded
        )

    def save_selection(self, path: str | Path) -> None:
        """Write the paint to a selection file, in the background."""
        path, document = Path(path), self._store.required().document

        def work() -> str:
            return about_selection(path.name, write_selection(path, document.mesh, selection_of(document)))

        self._write(tr("Saving {name}").format(name=path.name), work)

    def _write(self, title: str, work: Callable[[], str], then: Callable[[], object] = lambda: None) -> None:
        """Write in the background; the sentence from ``work()`` is told at the end."""

        def written(said: str) -> None:
            self._listener.told(said)
            then()

        self._jobs.run(title, work, written, can_be_cancelled=False)


def _passing(document: Document) -> str:
    """Sentence on new work too large for contact by default; mostly empty."""
    return passing_walls(document.method, len(document.mesh.V), tr("“Contact” in the section Method"))


def opened_sample(name: str) -> State:
    """A sample at rest, painted and with its settings."""
    sample, state = SAMPLES[name], opened(*open_sample(name))
    pivot = None if sample.pivot is None else frozen(np.array(sample.pivot))
    document = state.document.with_handle(0, replace(state.document.handles[0], pivot=pivot))
    return state.at(replace(document, **sample.settings))  # type: ignore[arg-type]
