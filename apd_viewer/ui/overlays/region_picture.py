"""Picture on a region of the mesh, such as a label."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple
from weakref import ref

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


class LaidPicture(NamedTuple):
    """Picture on triangles, with its file; the texture is None until it has been read."""

    triangles: ref[np.ndarray]
    image: RegionImage
    texture: Texture | None = None

    @property
    def is_kept(self) -> bool:
        """True if sessions keep its file."""
        return len(self.image.content) <= LARGEST_IMAGE


class RegionPicture(QObject):
    """Lays a picture on the active region, and removes it.

    It stays on the triangles on which it was laid, also if the region is painted anew, and comes back with
    them when another mesh is undone. Sessions keep it.

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
        self._laid: list[LaidPicture] = []
        self._shown: LaidPicture | None = None
        self._awaited: object = None  # the reading whose picture is to be shown

    @property
    def image(self) -> RegionImage | None:
        """The file for sessions; None without a picture, or with one too large."""
        return self._shown.image if self._shown is not None and self._shown.is_kept else None

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
            document = self._session.store.required_state().document
            # Sessions keep it even if it cannot be read, or if reading is cancelled.
            self._keep(document, LaidPicture(ref(document.mesh.F), image))
            self._lay(document, image.name, lambda: image)

    def _lay(self, document: Document, name: str, read: Callable[[], RegionImage]) -> None:
        mesh, reading = document.mesh, object()
        self._awaited = reading

        def work() -> LaidPicture:
            image = read()
            pixels = read_picture(image.content, name)
            texture = laid_picture(mesh.V, mesh.F, image.inside, image.up_axis.frame, pixels)
            return LaidPicture(ref(mesh.F), image, texture)

        def done(laid: LaidPicture) -> None:
            # Another mesh may have been opened, or the picture removed in the meantime.
            if self._awaited is reading and self._session.store.required_state().document.mesh.F is mesh.F:
                self._show_new(laid)

        self._session.jobs.run(tr("Reading {name}").format(name=name), work, done)

    def _region(self) -> np.ndarray | None:
        """Vertices of the active region, (n,) bool; None if it has none."""
        state = self._session.store.state
        if state is None:
            return None
        inside: np.ndarray = state.document.member == self._parts.region + 1
        return inside if inside.any() else None

    def _show_new(self, laid: LaidPicture) -> None:
        self._keep(self._session.store.required_state().document, laid)
        if not laid.is_kept:
            said = tr("{name} has more than {most} MB: it is shown here, but sessions do not keep it.")
            self._notice.show_message(said.format(name=laid.image.name, most=LARGEST_IMAGE >> 20))
        elif self._looks.overlay.measure is not None:
            said = tr("An overlay hides the picture; choose View > Overlay > No overlay to see it.")
            self._notice.show_message(said)

    def remove(self) -> None:
        """Remove the picture, also one that is being read."""
        self._awaited = None
        self._keep(self._session.store.required_state().document, None)

    def _keep(self, document: Document, laid: LaidPicture | None) -> None:
        """Show a picture in place of that on the document's mesh; None shows none."""
        F = document.mesh.F
        others = (each for each in self._laid if (own := each.triangles()) is not None and own is not F)
        self._laid = [*others, *([] if laid is None else [laid])]
        self._show(document, laid)

    def _show(self, document: Document, laid: LaidPicture | None) -> None:
        self._shown, self._looks.picture = laid, None if laid is None else laid.texture
        is_seen = self._looks.picture is not None
        inside = laid.image.inside if laid is not None and is_seen else None
        self._canvas.coloring.hide_regions_at(inside, document)
        self._looks.show_textures(self._looks.shows_textures)
        self.changed.emit(laid is not None)

    def follow_document(self, document: Document) -> None:
        """Show the picture that was laid on a mesh, once another mesh is shown."""
        F = document.mesh.F
        if self._shown is not None and self._shown.triangles() is F:
            return
        laid = next((each for each in self._laid if each.triangles() is F), None)
        if laid is not self._shown:
            self._show(document, laid)
