"""Opening and writing files in the background."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from weakref import WeakSet

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.fe_deck import write_deck
from apd_viewer.files.formats.polygon_mesh import PartsOrigin
from apd_viewer.files.known_file import KnownFile
from apd_viewer.files.mesh_formats import GLTF_FORMATS, POINT_CACHES, SERIES
from apd_viewer.files.mesh_writing import check_mesh_path, save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.samples import SAMPLES, open_sample
from apd_viewer.files.scalar_files import ScalarRows, write_scalars
from apd_viewer.files.selections.selection import Selection
from apd_viewer.files.selections.selection_files import read_selection_file, write_selection
from apd_viewer.geometry.mesh.arrays import diagonal, frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.solver.methods import no_contact_warning
from apd_viewer.language import tr
from apd_viewer.session.background_job import Jobs
from apd_viewer.session.deck_setup import deck_of, deck_wall
from apd_viewer.session.gestures import Gestures
from apd_viewer.session.model import status_text
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import selection_of, with_selection
from apd_viewer.session.model.state import State, initial_state, rest_frame
from apd_viewer.session.model.timeline import OpenedFile, Timeline, timeline_of_shapes
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.session.model.view import SESSION_SUFFIX, View
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.saved_work import SavedDocument, SavedWork
from apd_viewer.session.state_store import Listener, StateStore
from apd_viewer.session.storage.session_file import ChangedFileError, open_session_file, save_if_unchanged
from apd_viewer.session.storage.timeline_json import saved_timeline
from apd_viewer.session.timeline_player import TimelinePlayer


class FileJobs:
    """Background jobs opening or writing meshes, sessions and selections."""

    def __init__(
        self,
        store: StateStore,
        gestures: Gestures,
        player: TimelinePlayer,
        saved_work: SavedWork,
        jobs: Jobs,
        listener: Listener,
    ) -> None:
        self._store = store
        self._gestures = gestures
        self._player = player
        self._saved_work = saved_work
        self._jobs = jobs
        self._listener = listener
        self._saved_results: WeakSet[State] = WeakSet()  # by the Wall method, in session files

    @property
    def unsaved_wall_count(self) -> int:
        """Number of Wall results that saving would add to the session file."""
        state, timeline = self._store.state, self._player.timeline
        if state is None or not timeline.belongs_to(state.document):
            return 0
        results = _wall_results(saved_timeline(timeline, state))
        return sum(result not in self._saved_results for result in results)

    def open(self, path: str | Path) -> None:
        """Open a mesh, animation or session in the background.

        The current one stays until it is loaded. The shapes of a point cache are those of the open mesh.
        """
        path, state = Path(path), self._store.state
        suffix = path.suffix.lower()
        if suffix == SESSION_SUFFIX:
            self.open_result(path.name, lambda: open_session_file(path), path)
        elif suffix in POINT_CACHES:
            self.open_result(path.name, lambda: _opened_point_cache(path, state), is_saved=False)
        else:
            may_move, is_series = suffix in (SERIES, *GLTF_FORMATS), suffix == SERIES
            load = _opened_animation if may_move else _opened_mesh
            self.open_result(path.name, lambda: load(path), is_named=is_series)

    def open_sample(self, name: str) -> None:
        """Open a painted sample in the background."""
        self.open_result(SAMPLES[name].title, lambda: sample_state(name))

    def open_mesh(self, mesh: Mesh) -> None:
        """Open a mesh from memory."""
        self.open_result(mesh.name, lambda: initial_state(mesh))

    def can_remesh(self) -> bool:
        """Tell which library is missing for even triangles; True if none is."""
        # Imported here so that the first picture does not wait for it.
        from apd_viewer.files.formats.cad import check_remeshing

        try:
            check_remeshing()
        except InputError as error:
            self._listener.failed(str(error))
            return False
        return True

    def remesh(self, path: Path, edge: float) -> None:
        """Write the rest shape with even triangles to a file, and open it.

        Parameters
        ----------
        edge : float
            Edge length, mesh units.
        """
        mesh, unit = self._store.required_state().document.mesh, self._store.unit
        known = mesh.unit if unit.is_guess else unit.symbol

        def load() -> OpenedFile:
            # Imported here for the same reason.
            from apd_viewer.files.formats.cad import even_triangles

            V, F, _ = even_triangles(mesh.V, mesh.joined_F, edge)
            save_mesh(Mesh(V, F, path, unit=known), V, check_mesh_path(path))
            return _opened_mesh(path)

        self.open_result(path.name, load)

    def open_result(
        self,
        name: str,
        load: Callable[[], State | tuple[State, View] | OpenedFile],
        path: Path | None = None,
        is_saved: bool = True,
        is_named: bool = False,
    ) -> None:
        """Run ``load()`` in the background and open its result.

        ``path`` is its session file; ``is_saved`` is False for work without a file. ``is_named`` is True for
        a title other than the name of the mesh.
        """
        title = tr("Opening {name}").format(name=name)

        def parsed() -> tuple[OpenedFile, KnownFile | None]:
            # Recorded before loading, so that a write in between counts as a change.
            file = None if path is None else KnownFile(path)
            found = load()
            opened = OpenedFile(*found) if isinstance(found, tuple) else OpenedFile(found)
            mesh = opened.state.document.mesh
            # Computed on this thread, since it takes seconds for a large file; cached afterwards.
            _ = mesh.colors, mesh.texture
            return opened, file

        title_name = name if is_named else ""
        self._jobs.run(title, parsed, lambda done: self._show_opened(name, title_name, is_saved, *done))

    def _show_opened(
        self,
        name: str,
        title: str,
        is_saved: bool,
        opened: OpenedFile,
        file: KnownFile | None,
    ) -> None:
        state, view, timeline, animation = opened
        before, self._gestures.state_before = self._gestures.state_before or self._store.state, None
        if before is not None:
            self._gestures.history.record(tr("Open {name}").format(name=name), before)
        if is_saved:
            image = None if view is None else view.image
            self._saved_work.mark_saved(SavedDocument(state.document, file, title=title, image=image))
        if timeline.steps:
            self._player.set_timeline(timeline)
            self._saved_results.update(_wall_results(timeline))
        self._store.jump_to(state)
        if view is not None:
            self._listener.view_opened(view)
        elif timeline.steps:
            self._listener.animation_opened(animation)
        about = (
            status_text.findings_sentences(state.inspection.findings),
            status_text.missing_target_sentence(state.document),
            "" if view is not None else _contact_warning(state.document),
            state.document.mesh.texture[1],
        )
        if any(about):
            self._listener.message_sent(" ".join(sentence for sentence in about if sentence))

    def is_still_open(self, mesh: Mesh) -> bool:
        """True if ``mesh`` is displayed; otherwise say that nothing was written."""
        is_open = self._store.required_state().document.mesh is mesh
        if not is_open:
            self._listener.failed(tr("Another mesh was opened meanwhile; nothing was written."))
        return is_open

    def export(self, path: str | Path, on_success: Callable[[], object] = lambda: None) -> None:
        """Export the displayed shape in the background.

        ``on_success()`` follows if all went well.
        """
        path, state, unit = Path(path), self._store.required_state(), self._store.unit

        def write() -> str:
            known = "" if unit.is_guess else unit.symbol
            file = save_mesh(state.document.mesh, state.frame.U, check_mesh_path(path), known)
            return status_text.export_sentence(path.name, file.area, state.inspection.area, unit)

        self._write(path, write, on_success)

    def export_scalars(self, path: str | Path, rows: ScalarRows) -> None:
        """Export the scalars of the displayed shape in the background."""
        path, state = Path(path), self._store.required_state()

        def write() -> str:
            # Imported here so that the first picture does not wait for numba.
            from apd_viewer.geometry.analysis.scalars import shape_scalars

            document, U = state.document, state.frame.U
            scalars = shape_scalars(document.mesh, U, document.labels, document.member, document.target_shape)
            write_scalars(path, document.mesh, U, scalars, rows)
            return tr("Exported scalars to {name}.").format(name=path.name)

        self._write(path, write)

    def export_timeline(
        self,
        path: str | Path,
        timeline: Timeline,
        newtons: Sequence[tuple[float, float]],
        of_wall: bool = False,
        up_axis: UpAxis = UpAxis.PLUS_Y,
    ) -> None:
        """Export a timeline as a table or an animation, in the background.

        ``newtons`` are newtons per load at each step, of the press and of the wall, NaN if unknown;
        ``of_wall`` takes the shapes of the wall.
        """
        path, unit = Path(path), self._store.unit

        def write() -> str:
            # Imported here so that the first picture does not wait for numba.
            from apd_viewer.session.storage.timeline_file import write_timeline

            write_timeline(timeline, path, newtons, of_wall, unit, up_axis)
            return tr("Saved {name}.").format(name=path.name)

        self._write(path, write)

    def export_deck(self, path: str | Path, view: View) -> None:
        """Write an FE deck of the motion from rest to the poses, in the background."""
        path, document = Path(path), self._store.required_state().document

        def write() -> str:
            size, unit = diagonal(document.mesh.V), Unit(view.unit)
            deck = deck_of(document, deck_wall(view.wall, unit, size))
            write_deck(path, deck)
            return status_text.deck_sentence(path.name, deck)

        self._write(path, write)

    def save(
        self,
        path: str | Path,
        view: View,
        embed: bool = False,
        on_success: Callable[[], object] = lambda: None,
        picture: bytes = b"",
        on_file_changed: Callable[[KnownFile], object] | None = None,
        replaceable: KnownFile | None = None,
    ) -> None:
        """Save a session in the background, without an unfinished gesture.

        Its own file is replaced only if that still holds what was opened or saved last. ``on_success()``
        follows if all went well.

        Parameters
        ----------
        path, view, embed
            See :func:`apd_viewer.session.storage.session_file.save_session`.
        picture : bytes
            A PNG file of it, if there is one.
        on_file_changed : callable
            ``on_file_changed(file)``: somebody else has changed the file, and nothing was written. None
            says so in a sentence.
        replaceable : KnownFile or None
            Known file that may be replaced, instead of the session file of the displayed mesh.
        """
        path, state = Path(path), self._gestures.state_before or self._store.required_state()
        known = replaceable or self._saved_work.known_file_at(path)
        steps = saved_timeline(self._player.timeline, state)
        left_out = len(self._player.timeline.steps) - len(steps.steps) if steps.steps else 0

        def write() -> tuple[bool, KnownFile] | ChangedFileError:
            try:
                return save_if_unchanged(known, path, state, view, embed, picture, steps)
            except ChangedFileError as error:
                return error

        def written(done: tuple[bool, KnownFile] | ChangedFileError) -> None:
            if isinstance(done, tuple):
                embedded, file = done
                self._saved_work.mark_saved(SavedDocument(state.document, file, embed, image=view.image))
                self._saved_results.update(_wall_results(steps))
                said = status_text.saved_session_sentence(path.name, embedded, left_out)
                self._listener.message_sent(said)
                on_success()
            elif on_file_changed is None:
                self._listener.failed(str(done))
            else:
                on_file_changed(done.current_file)

        self._jobs.run(tr("Saving {name}").format(name=path.name), write, written, can_be_cancelled=False)

    def load_selection(self, path: str | Path) -> None:
        """Replace all paint with a selection file, in the background.

        Refused while a part is locked.
        """
        path, mesh = Path(path), self._store.required_state().document.mesh

        def loaded(selection: Selection) -> None:
            state = self._gestures.state_without_gesture()
            if any(locked.any() for locked in state.document.flags.locked):
                self._listener.failed(tr("A selection replaces all parts; unlock them first."))
            elif state.document.mesh is not mesh:
                self._listener.failed(status_text.LOAD_AGAIN)
            else:
                self._gestures.record(tr("Load selection"), state)
                self._store.restart_motions(state.document, with_selection(state.document, selection))
                self._listener.message_sent(status_text.loaded_selection_sentence(path.name, selection))

        self._jobs.run(
            tr("Loading {name}").format(name=path.name), lambda: read_selection_file(path, mesh), loaded
        )

    def save_selection(self, path: str | Path) -> None:
        """Save the paint as a selection file, in the background."""
        path, document = Path(path), self._store.required_state().document

        def work() -> str:
            return status_text.saved_selection_sentence(
                path.name, write_selection(path, document.mesh, selection_of(document))
            )

        self._write(path, work)

    def _write(
        self, path: Path, work: Callable[[], str], on_success: Callable[[], object] = lambda: None
    ) -> None:
        """Write a file in the background; the listener gets the sentence from ``work()``."""

        def written(said: str) -> None:
            self._listener.message_sent(said)
            self._listener.file_written(path)
            on_success()

        title = tr("Writing {name}").format(name=path.name)
        self._jobs.run(title, work, written, can_be_cancelled=False)


def _wall_results(timeline: Timeline) -> list[State]:
    """Results of the Wall method on a timeline, except for the rest shape."""
    found = [step.wall_result for step in timeline.steps]
    return [state for state in found if state is not None and state.frame.U is not state.document.mesh.V]


def _opened_mesh(path: Path) -> OpenedFile:
    """Mesh of a file, whose parts are regions."""
    state = initial_state(mesh := open_mesh(path))
    if not isinstance(mesh.origin, PartsOrigin):
        return OpenedFile(state)
    selection = Selection.with_default_names(state.document.labels, mesh.origin.member, (), mesh.origin.names)
    return OpenedFile(state.updated(with_selection(state.document, selection)))


def _opened_animation(path: Path) -> OpenedFile:
    """Mesh of a file, with its shapes if there are several; raises InputError."""
    # Imported here so that the first picture does not wait for numba.
    from apd_viewer.files.animations.animation_reading import open_animation

    mesh, shapes = open_animation(path)
    state = initial_state(mesh)
    timeline = timeline_of_shapes(state, shapes)
    if len(timeline.steps) < 2:
        return OpenedFile(state)
    return OpenedFile(timeline.steps[0].state, timeline=timeline, animation=path)


def _opened_point_cache(path: Path, state: State | None) -> OpenedFile:
    """Shapes of a point cache for the open mesh; raises InputError."""
    if state is None:
        said = tr("{name} has shapes and no mesh; open the mesh that it was written of first.")
        raise InputError(said.format(name=path.name))
    # Imported here so that the first picture does not wait for numba.
    from apd_viewer.files.animations.animation_reading import read_point_cache

    mesh = state.document.mesh
    document = state.document if state.is_at_rest else state.document.at_rest()
    rest = state.updated(document, rest_frame(mesh, state.inspection))
    timeline = timeline_of_shapes(rest, read_point_cache(path, mesh))
    return OpenedFile(timeline.steps[0].state, timeline=timeline)


def _contact_warning(document: Document) -> str:
    """Warning that a new mesh is too large for contact by default; else empty."""
    return no_contact_warning(
        document.settings.method, len(document.mesh.V), tr("“Contact” in the section Method")
    )


def sample_state(name: str) -> State:
    """Initial state of a sample, painted and with its settings."""
    sample, state = SAMPLES[name], initial_state(*open_sample(name))
    pivot = None if sample.pivot is None else frozen(np.array(sample.pivot))
    document = state.document.with_handle(0, replace(state.document.handles[0], pivot=pivot))
    return state.updated(document.with_settings(**sample.settings))
