"""Saved and unsaved work: the last saved document of each opened mesh."""

import threading
from pathlib import Path
from typing import NamedTuple

import numpy as np

from apd_viewer.files.known_file import FileState, KnownFile
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.gestures import Gestures
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.status_text import lost_file_sentences
from apd_viewer.session.model.view import RegionImage
from apd_viewer.session.state_store import Listener, StateStore
from apd_viewer.session.storage.session_file import has_mesh

_PATIENCE = 1.0  # maximum wait in seconds for a slow disk


class SavedDocument(NamedTuple):
    """Document as opened or saved, and its session file.

    Attributes
    ----------
    file : KnownFile or None
        Session file; None for a mesh that was never saved.
    embeds_mesh : bool
        Whether the file has a copy of the mesh.
    title : str
        Title of an opened case or the like; empty to use the names of session and mesh.
    image : RegionImage or None
        Picture on a region in its session file; None without.
    """

    document: Document
    file: KnownFile | None = None
    embeds_mesh: bool = False
    title: str = ""
    image: RegionImage | None = None


class SavedWork:
    """Record of saved documents and of changes to their files.

    The shape is not work by itself, since it follows from the document. Undo can return to earlier meshes, so
    the last saved document of each opened mesh is kept; baking makes another mesh with the same triangles.
    """

    def __init__(self, store: StateStore, gestures: Gestures, listener: Listener) -> None:
        self._store, self._gestures, self._listener = store, gestures, listener
        self._saved: list[SavedDocument] = []
        self._looking: threading.Thread | None = None
        self._seen = threading.Event()

    def mark_saved(self, saved: SavedDocument) -> None:
        """Mark a document as saved."""
        self.forget_unreachable()
        self._saved = [*(each for each in self._saved if _triangles(each) is not _triangles(saved)), saved]

    def forget_unreachable(self) -> None:
        """Discard documents no longer reachable by undo, to release their meshes."""
        state, history = self._store.state, self._gestures.history
        documents = [each.document for each in (*history.reachable_states, *([state] if state else []))]
        within_reach = {id(document.mesh.F) for document in documents}
        self._saved = [each for each in self._saved if id(_triangles(each)) in within_reach]

    @property
    def last_saved(self) -> SavedDocument | None:
        """Last saved document of the displayed mesh; None if there is none."""
        state = self._store.state
        if state is None:
            return None
        return next((each for each in self._saved if _triangles(each) is state.document.mesh.F), None)

    @property
    def file(self) -> KnownFile | None:
        """Session file of the displayed mesh; None if there is none."""
        return self.last_saved.file if self.last_saved else None

    @property
    def path(self) -> Path | None:
        """Path of the session file of the displayed mesh; None if there is none."""
        return self.file.path if self.file else None

    def known_file_at(self, path: Path) -> KnownFile | None:
        """Session file of the displayed mesh if it is at ``path``; else None."""
        file = self.file
        return file if file is not None and file.path.absolute() == path.absolute() else None

    @property
    def is_unsaved(self) -> bool:
        """True if the displayed document is not in its file, as last checked."""
        state, last = self._store.state, self.last_saved
        if state is None:
            return False
        lost = last is not None and last.file is not None and last.file.state is not FileState.SAME
        return last is None or lost or last.document is not state.document

    def is_saved_with(self, image: RegionImage | None) -> bool:
        """True if the displayed mesh is saved with this picture on a region, or None."""
        return image is (None if self.last_saved is None else self.last_saved.image)

    # External changes to the file

    def check_file(self) -> None:
        """Check on a thread for external changes to the session file."""
        last, under_way = self.last_saved, self._looking is not None and self._looking.is_alive()
        if last is not None and last.file is not None and not under_way:
            args = last.file, last.document.mesh
            self._looking = threading.Thread(
                target=self._check_file, args=args, name="saved file", daemon=True
            )
            self._looking.start()

    def check_file_now(self) -> None:
        """Check the file now, waiting only briefly for the disk."""
        self.check_file()
        self.close()

    def receive_check(self) -> None:
        """Report the result of a check if it has changed."""
        if self._seen.is_set():
            self._seen.clear()
            if (file := self.file) is not None and file.state is not FileState.SAME:
                self._listener.message_sent(lost_file_sentences(file.path.name, file.state))
            self._listener.status_changed()

    def close(self) -> None:
        """Wait for a running check."""
        if self._looking is not None:
            self._looking.join(_PATIENCE)

    def _check_file(self, file: KnownFile, mesh: Mesh) -> None:
        before = file.state
        if file.check_content() is FileState.SAME and not has_mesh(file.path, mesh):
            file.state = FileState.INCOMPLETE
        if file.state is not before:
            self._seen.set()
            self._listener.wake()


def _triangles(saved: SavedDocument) -> np.ndarray:
    return saved.document.mesh.F
