"""Picture on a region of the mesh, such as a label; kept by the window only."""

from pathlib import Path

import numpy as np
from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QWidget

from apd_viewer.files.formats.texture_images import read_picture
from apd_viewer.geometry.mesh.texture import Texture, laid_picture
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.session import Session
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.overlays.display_options import DisplayOptions
from apd_viewer.ui.overlays.notice import Notice
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.tools.active_parts import ActiveParts
from apd_viewer.ui.tools.canvas import Canvas


class RegionPicture(QObject):
    """Lays a picture on the active region, and removes it.

    It stays on the triangles on which it was laid, also if the region is painted anew, until another mesh is
    opened.

    Parameters
    ----------
    window : QWidget
        Over which to ask.

    Attributes
    ----------
    changed : Signal(bool)
        Whether there is a picture.
    """

    changed = Signal(bool)

    def __init__(
        self,
        window: QWidget,
        canvas: Canvas,
        display_options: DisplayOptions,
        preferences: Preferences,
        notice: Notice,
        session: Session,
        parts: ActiveParts,
    ) -> None:
        super().__init__(window)
        self._window, self._canvas, self._looks = window, canvas, display_options
        self._memory, self._notice = preferences, notice
        self._session, self._parts = session, parts
        self._F: np.ndarray | None = None

    def ask_for_picture(self) -> None:
        """Ask for an image file, and lay it on the active region."""
        if self._region() is None:
            said = tr(
                "Paint a region first, with the tool “Paint region”: the picture goes on the active one."
            )
            self._notice.show_failure(said)
            return
        path = file_dialogs.ask_for_image(self._window, self._memory.last_folder)
        if path is not None:
            self.lay(path)

    def lay(self, path: Path) -> None:
        """Lay an image file on the active region."""
        document, inside = self._session.store.required_state().document, self._region()
        if inside is None:
            return
        mesh, frame = document.mesh, self._canvas.viewport.camera_controller.camera.up_axis.frame

        def work() -> Texture:
            return laid_picture(mesh.V, mesh.F, inside, frame, read_picture(path))

        title = tr("Reading {name}").format(name=path.name)
        self._session.jobs.run(title, work, lambda picture: self._show(picture, mesh.F, inside))

    def _region(self) -> np.ndarray | None:
        """Vertices of the active region, (n,) bool; None if it has none."""
        state = self._session.store.state
        if state is None:
            return None
        inside: np.ndarray = state.document.member == self._parts.region + 1
        return inside if inside.any() else None

    def _show(self, picture: Texture | None, F: np.ndarray | None, inside: np.ndarray | None) -> None:
        document = self._session.store.required_state().document
        if picture is None or document.mesh.F is F:  # no other mesh was opened in the meantime
            self._F, self._looks.picture = F, picture
            self._canvas.coloring.hide_regions_at(inside, document)
            self._looks.show_textures(self._looks.shows_textures)
            self.changed.emit(picture is not None)
            if picture is not None and self._looks.overlay.measure is not None:
                said = tr("An overlay hides the picture; choose View > Overlay > No overlay to see it.")
                self._notice.show_message(said)

    def remove(self) -> None:
        """Remove the picture."""
        self._show(None, None, None)

    def follow_document(self, document: Document) -> None:
        """Drop the picture once another mesh is shown, before its own textures are."""
        if self._F is not None and document.mesh.F is not self._F:
            self._F = self._looks.picture = None
            self.changed.emit(False)
