"""Picture on a region of the mesh, such as a label."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QWidget

from apd_viewer.files.formats.texture_images import read_picture
from apd_viewer.files.storage.regular_files import read_content
from apd_viewer.geometry.mesh.texture import Texture, laid_picture
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.view import RegionImage
from apd_viewer.session.session import Session
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.overlays.display_options import DisplayOptions
from apd_viewer.ui.overlays.notice import Notice
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.tools.active_parts import ActiveParts
from apd_viewer.ui.tools.canvas import Canvas

LARGEST_IMAGE = 16 << 20  # bytes of an image in a session


class RegionPicture(QObject):
    """Lays a picture on the active region, and removes it.

    It stays on the triangles on which it was laid, also if the region is painted anew, until another mesh is
    opened. Sessions keep it.

    Parameters
    ----------
    window : QWidget
        Over which to ask.

    Attributes
    ----------
    changed : Signal(bool)
        Whether there is a picture.
    image : RegionImage or None
        The file for sessions; None without a picture, or with one too large.
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
        self.image: RegionImage | None = None

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
        up_axis = self._canvas.viewport.camera_controller.camera.up_axis
        self._lay(document, path.name, lambda: RegionImage(path.name, read_content(path), inside, up_axis))

    def restore(self, image: RegionImage | None) -> None:
        """Lay the image of an opened session, if it has one."""
        if image is not None:
            self._lay(self._session.store.required_state().document, image.name, lambda: image)

    def _lay(self, document: Document, name: str, read: Callable[[], RegionImage]) -> None:
        mesh = document.mesh

        def work() -> tuple[Texture, RegionImage]:
            image = read()
            pixels = read_picture(image.content, name)
            return laid_picture(mesh.V, mesh.F, image.inside, image.up_axis.frame, pixels), image

        title = tr("Reading {name}").format(name=name)
        self._session.jobs.run(title, work, lambda laid: self._show(*laid, mesh.F))

    def _region(self) -> np.ndarray | None:
        """Vertices of the active region, (n,) bool; None if it has none."""
        state = self._session.store.state
        if state is None:
            return None
        inside: np.ndarray = state.document.member == self._parts.region + 1
        return inside if inside.any() else None

    def _show(self, picture: Texture | None, image: RegionImage | None, F: np.ndarray | None) -> None:
        document = self._session.store.required_state().document
        if picture is None or document.mesh.F is F:  # no other mesh was opened in the meantime
            is_small = image is not None and len(image.content) <= LARGEST_IMAGE
            self._F, self._looks.picture, self.image = F, picture, image if is_small else None
            self._canvas.coloring.hide_regions_at(None if image is None else image.inside, document)
            self._looks.show_textures(self._looks.shows_textures)
            self.changed.emit(picture is not None)
            if image is not None and not is_small:
                said = tr("{name} has more than {most} MB: it is shown here, but sessions do not keep it.")
                self._notice.show_message(said.format(name=image.name, most=LARGEST_IMAGE >> 20))
            elif picture is not None and self._looks.overlay.measure is not None:
                said = tr("An overlay hides the picture; choose View > Overlay > No overlay to see it.")
                self._notice.show_message(said)

    def remove(self) -> None:
        """Remove the picture."""
        self._show(None, None, None)

    def follow_document(self, document: Document) -> None:
        """Drop the picture once another mesh is shown, before its own textures are."""
        if self._F is not None and document.mesh.F is not self._F:
            self._F = self._looks.picture = self.image = None
            self.changed.emit(False)
