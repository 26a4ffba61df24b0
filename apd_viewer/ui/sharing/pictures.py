"""Pictures of the view: to a file or to the clipboard, at any size."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QByteArray, QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QGuiApplication, QImage, QPainter, QPen
from PySide6.QtSvg import QSvgRenderer

from apd_viewer.errors import InputError
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.language import tr
from apd_viewer.presentation.legend_svg import HEIGHT, WIDTH, legend_svg
from apd_viewer.session.background_job import Jobs
from apd_viewer.ui.overlays.display_options import DisplayOptions
from apd_viewer.ui.overlays.notice import Notice
from apd_viewer.ui.scene.scene_picture import check_picture_size, picture_scale, scene_picture
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.tools.gizmo import Gizmo
from apd_viewer.ui.widgets.theme import DARK, LIGHT

_MARGIN, _ROUND = 12.0, 8.0  # pixels of the window


@dataclass(frozen=True)
class PictureSettings:
    """Settings of a picture.

    Attributes
    ----------
    size : QSize
        Pixels.
    transparent : bool
        Whether the background is left out.
    legend, gizmo : bool
        What is drawn over it, where it is there.
    """

    size: QSize
    transparent: bool = False
    legend: bool = True
    gizmo: bool = False


class Pictures:
    """Takes pictures of a canvas.

    Parameters
    ----------
    canvas : Canvas
    display_options : DisplayOptions
    notice : Notice
    jobs : Jobs
    """

    def __init__(self, canvas: Canvas, display_options: DisplayOptions, notice: Notice, jobs: Jobs) -> None:
        self._canvas, self._looks, self._notice, self._jobs = canvas, display_options, notice, jobs

    @property
    def view_size(self) -> QSize:
        """Pixels of the view on its screen."""
        view = self._canvas.viewport
        return view.size() * view.devicePixelRatioF()

    @property
    def has_legend(self) -> bool:
        """True if an overlay with a legend is shown."""
        return self._looks.overlay.measure is not None

    @property
    def has_gizmo(self) -> bool:
        """True if a gizmo is shown."""
        return bool(self._gizmos)

    @property
    def _gizmos(self) -> list[Gizmo]:
        """The gizmo at the handle or at the obstacle in the hand, if it is shown."""
        return [tool for tool in self._canvas.viewport.tools if isinstance(tool, Gizmo) and tool.visible]

    def save(self, path: Path, settings: PictureSettings) -> None:
        """Write a picture as PNG; it is drawn now, and written in the background."""
        try:
            image = self.picture(settings)
        except InputError as error:
            self._notice.show_failure(str(error))
            return

        def work() -> str:
            with replacing_file(path) as scratch:
                if not image.save(str(scratch), "PNG"):
                    raise OSError(tr("the picture could not be encoded"))
            size = tr("{width:,} × {height:,} pixels").format(width=image.width(), height=image.height())
            return tr("Saved {name}: {size}.").format(name=path.name, size=size)

        title = tr("Writing {name}").format(name=path.name)
        self._jobs.run(title, work, self._notice.show_message, can_be_cancelled=False)

    def copy(self, settings: PictureSettings | None = None) -> None:
        """Bring a picture to the clipboard; the view as it is seen, without the gizmo."""
        try:
            image = self.picture(settings or PictureSettings(self.view_size))
        except InputError as error:
            self._notice.show_failure(str(error))
            return
        QGuiApplication.clipboard().setImage(image)
        said = tr("Copied a picture of {width:,} × {height:,} pixels.")
        self._notice.show_message(said.format(width=image.width(), height=image.height()))

    def check_size(self, size: QSize) -> None:
        """Raise InputError if a picture of this size cannot be drawn."""
        check_picture_size(self._canvas.viewport, size)

    def picture(self, settings: PictureSettings) -> QImage:
        """Picture; raises InputError if too large to be drawn."""
        view = self._canvas.viewport
        QGuiApplication.setOverrideCursor(Qt.CursorShape.WaitCursor)
        try:
            image = scene_picture(view, settings.size, settings.transparent)
        finally:
            QGuiApplication.restoreOverrideCursor()
        scale = picture_scale(view.size(), settings.size)
        with QPainter(image) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            # The view is centred in the picture.
            painter.translate(QPointF(settings.size.width(), settings.size.height()) / 2)
            painter.scale(scale, scale)
            painter.save()
            painter.translate(-QPointF(view.width(), view.height()) / 2)
            self._looks.ground.paint(painter)
            if settings.gizmo:
                self._canvas.inactive_handles.paint(painter)
                for gizmo in self._gizmos:
                    gizmo.paint(painter)
            painter.restore()
            if settings.legend and self.has_legend:
                painter.translate(-QPointF(settings.size.width(), -settings.size.height()) / (2 * scale))
                self._draw_legend(painter)
        return image

    def _draw_legend(self, painter: QPainter) -> None:
        """Draw a card above the painter's lower left corner."""
        heat, theme = self._looks.overlay, DARK if self._canvas.viewport.is_dark else LIGHT
        card = QRectF(_MARGIN, -_MARGIN - HEIGHT, WIDTH, HEIGHT)
        painter.setPen(QPen(QColor(theme.line), 1.0))
        painter.setBrush(QColor(theme.raised))
        painter.drawRoundedRect(card, _ROUND, _ROUND)
        svg = legend_svg(heat.scale, heat.unit, heat.reading.span, theme.ink)
        QSvgRenderer(QByteArray(svg.encode())).render(painter, card)
