"""Saved and unsaved work: the last saved document of each opened mesh."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import numpy as np

    from apd_viewer.session.gestures import Gestures
    from apd_viewer.session.model.document import Document
    from apd_viewer.session.store import Store


class SavedDocument(NamedTuple):
    """A document as it was opened or saved, and its session file.

    Attributes
    ----------
    document : Document
    path : Path or None
        None where it came from a mesh and has never been saved.
    embeds : bool
        Whether the file has a copy of the mesh.
    """

    document: Document
    path: Path | None = None
    embeds: bool = False


class SavedWork:
    """Tells whether the document on screen is the one last saved.

    The shape is no work of its own: it follows from the document. Undo leads back to other meshes, so the
    last saved document of each opened mesh is kept; baking makes another mesh with the same triangles.

    Parameters
    ----------
    store : Store
    gestures : Gestures
    """

    def __init__(self, store: Store, gestures: Gestures) -> None:
        self._store, self._gestures = store, gestures
        self._saved: list[SavedDocument] = []

    def note(self, saved: SavedDocument) -> None:
        """Note a document as safe; those out of reach of undo are forgotten."""
        state, history = self._store.state, self._gestures.history
        documents = [each.document for each in (*history.states, *([state] if state else []))]
        within_reach = {id(document.mesh.F) for document in documents}
        others = [each for each in self._saved if id(_F(each)) in within_reach and _F(each) is not _F(saved)]
        self._saved = [*others, saved]

    @property
    def last(self) -> SavedDocument | None:
        """Last saved document of the mesh on screen; None if there is none."""
        state = self._store.state
        if state is None:
            return None
        return next((each for each in self._saved if _F(each) is state.document.mesh.F), None)

    @property
    def path(self) -> Path | None:
        """The session file of the mesh on screen."""
        return self.last.path if self.last else None

    @property
    def unsaved(self) -> bool:
        """True if anything was said since the mesh was opened or last saved."""
        state, last = self._store.state, self.last
        return state is not None and (last is None or last.document is not state.document)


def _F(saved: SavedDocument) -> np.ndarray:
    return saved.document.mesh.F
