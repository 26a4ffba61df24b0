"""The target shape: loading and clearing it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.language import tr
from apd_viewer.session.document_editor import DocumentEditor
from apd_viewer.session.gestures import Gestures
from apd_viewer.session.jobs.background_job import Jobs
from apd_viewer.session.listener import Listener
from apd_viewer.session.model.status_text import about_target
from apd_viewer.session.state_store import StateStore


class TargetShapes(DocumentEditor):
    """Loads and clears the target shape; each is a step of undo.

    Parameters
    ----------
    store : StateStore
    gestures : Gestures
    jobs : Jobs
    listener : Listener
    """

    def __init__(self, store: StateStore, gestures: Gestures, jobs: Jobs, listener: Listener) -> None:
        super().__init__(store, gestures, listener)
        self._jobs = jobs

    def load(self, path: str | Path, on_success: Callable[[], object] = lambda: None) -> None:
        """Compare with the mesh in a file, opened in the background.

        ``on_success()`` follows if all went well.
        """
        path, mesh = Path(path), self._store.required_state().document.mesh

        def loaded(target: TargetShape) -> None:
            if self._store.required_state().document.mesh.F is not mesh.F:
                return  # another mesh has been opened meanwhile
            self._set(tr("Load target shape"), target)
            self._listener.message_sent(about_target(target, mesh))
            on_success()

        title = tr("Opening {name}").format(name=path.name)
        self._jobs.run(title, lambda: TargetShape(open_mesh(path)), loaded)

    def clear(self) -> None:
        """Compare with no other mesh any more."""
        document = self._store.required_state().document
        if document.target_shape is not None or document.missing_target_shape is not None:
            self._set(tr("Clear target shape"), None)

    def _set(self, gesture: str, target: TargetShape | None) -> None:
        self._replace(gesture, target_shape=target, missing_target_shape=None)
