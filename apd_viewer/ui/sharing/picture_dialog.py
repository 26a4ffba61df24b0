"""Pictures of the view at any size, and their dialog with a preview."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path

from PySide6.QtCore import QByteArray, QPointF, QRect, QRectF, QSize, Qt, QTimer
from PySide6.QtGui import QColor, QGuiApplication, QImage, QPainter, QPaintEvent, QPen
from PySide6.QtSvg import QSvgRenderer
from PySide6.QtWidgets import QDialog, QGridLayout, QLabel, QPushButton, QVBoxLayout, QWidget

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
from apd_viewer.ui.widgets.box_layouts import STRETCH, column_layout, row_layout
from apd_viewer.ui.widgets.fields import CheckBox, ComboBox, NumberField
from apd_viewer.ui.widgets.help_button import HelpButton
from apd_viewer.ui.widgets.theme import DARK, LIGHT

_LEAST, _MOST = 16, 32_768  # pixels per side; a message reports sizes too large to render
_TIMES = (1, 2, 3, 4)
_PREVIEW = QSize(360, 270)
_SOON = 40  # ms; delay of the preview
_SQUARE = 8  # px; squares of the checkerboard


class _Preview(QWidget):
    """Preview on a checkerboard indicating transparency."""

    def __init__(self) -> None:
        super().__init__(accessibleName=tr("Preview"))
        self.setFixedSize(_PREVIEW)
        self.image = QImage()

    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw the checkerboard and the picture."""
        painter = QPainter(self)
        size = self.image.size()
        room = QRect(0, 0, size.width(), size.height())
        room.moveCenter(self.rect().center())
        if not self.image.isNull():
            light, dark = QColor("#ffffff"), QColor("#e2e4e8")
            painter.fillRect(room, light)
            painter.setClipRect(room)
            for y in range(0, room.height(), _SQUARE):
                for x in range((y // _SQUARE) % 2 * _SQUARE, room.width(), 2 * _SQUARE):
                    painter.fillRect(room.left() + x, room.top() + y, _SQUARE, _SQUARE, dark)
            painter.drawImage(room.topLeft(), self.image)
        painter.setClipping(False)
        painter.setPen(self.palette().mid().color())
        painter.drawRect(
            room.adjusted(0, 0, -1, -1) if room.isValid() else self.rect().adjusted(0, 0, -1, -1)
        )


class PictureDialog(QDialog):
    """Dialog for size, background and overlays of a picture.

    Parameters
    ----------
    settings : PictureSettings
        To begin with.

    Attributes
    ----------
    times : ComboBox
        Multiples of the view, and a size of one's own.
    width_, height_ : NumberField
        Pixels.
    """

    def __init__(self, parent: QWidget, pictures: PictureRenderer, settings: PictureSettings) -> None:
        super().__init__(parent, objectName="picture")
        self.setWindowTitle(tr("Save picture"))
        self._pictures = pictures
        self.preview = _Preview()
        self._make_fields(settings)
        self._lay_out()
        self._soon = QTimer(self, singleShot=True, interval=_SOON, timeout=self._show)
        self._connect()
        self._show_times()
        self._show()

    def _make_fields(self, wish: PictureSettings) -> None:
        self.times = ComboBox(accessibleName=tr("Size"))
        for times in _TIMES:
            title = tr("Same as view") if times == 1 else tr("{times} × the view").format(times=times)
            self.times.addItem(title, times)
        self.times.addItem(tr("Custom size"), 0)
        self.width_ = NumberField(accessibleName=tr("Width"), toolTip=tr("Picture width"), decimals=0)
        self.height_ = NumberField(accessibleName=tr("Height"), toolTip=tr("Picture height"), decimals=0)
        for field in (self.width_, self.height_):
            field.setRange(_LEAST, _MOST)
            field.setSuffix(tr(" px"))
        self._show_size(wish.size)
        tip = tr("Save only the mesh, to place on any background")
        self.transparent = CheckBox(tr("Transparent background"), toolTip=tip, checked=wish.transparent)
        self.legend = CheckBox(tr("Overlay legend"), checked=wish.legend and self._pictures.has_legend)
        self.legend.setEnabled(self._pictures.has_legend)
        self.legend.setToolTip("" if self.legend.isEnabled() else tr("No overlay is shown"))
        self.gizmo = CheckBox(tr("Gizmo"), checked=wish.gizmo and self._pictures.has_gizmo)
        self.gizmo.setEnabled(self._pictures.has_gizmo)
        self.gizmo.setToolTip("" if self.gizmo.isEnabled() else tr("No gizmo is shown"))
        self.save = QPushButton(tr("Save…"), objectName="primary", default=True)
        self.copy = QPushButton(tr("Copy"), toolTip=tr("Copy this picture to the clipboard"))
        self._cancel = QPushButton(tr("Cancel"))

    def _lay_out(self) -> None:
        grid = QGridLayout(horizontalSpacing=8, verticalSpacing=12)
        sides = row_layout(self.width_, QLabel("×"), self.height_, STRETCH)
        grid.addWidget(QLabel(tr("Size"), buddy=self.times), 0, 0)
        grid.addWidget(self.times, 0, 1)
        grid.addLayout(sides, 1, 1)
        for row, check in enumerate((self.transparent, self.legend, self.gizmo), start=2):
            grid.addWidget(check, row, 1)
        self.problem = QLabel("", objectName="problem", wordWrap=True)
        grid.addWidget(self.problem, 5, 0, 1, 2)
        grid.setRowStretch(6, 1)
        top = row_layout(self.preview, grid, spacing=20)
        self.help = HelpButton()
        buttons = row_layout(self.help, STRETCH, self._cancel, self.copy, self.save)
        column = column_layout(top, buttons, spacing=16, margins=(20, 16, 20, 16), parent=self)
        column.setSizeConstraint(QVBoxLayout.SizeConstraint.SetFixedSize)

    def _connect(self) -> None:
        self.times.activated.connect(self._take_times)
        for field in (self.width_, self.height_):
            field.valueChanged.connect(self._take_size)
        for check in (self.transparent, self.legend, self.gizmo):
            check.toggled.connect(self._soon.start)
        self.save.clicked.connect(self.accept)
        self._cancel.clicked.connect(self.reject)
        self.copy.clicked.connect(self._copy)

    @property
    def settings(self) -> PictureSettings:
        """Settings currently chosen."""
        size = QSize(int(self.width_.value()), int(self.height_.value()))
        return PictureSettings(
            size, self.transparent.isChecked(), self.legend.isChecked(), self.gizmo.isChecked()
        )

    def _take_times(self) -> None:
        if times := self.times.currentData():
            self._show_size(self._pictures.view_size * times)
        else:
            self.width_.setFocus(Qt.FocusReason.OtherFocusReason)
            self.width_.selectAll()
        self._soon.start()

    def _show_size(self, size: QSize) -> None:
        self.width_.show_value(size.width())
        self.height_.show_value(size.height())

    def _take_size(self) -> None:
        self._show_times()
        self._soon.start()

    def _show_times(self) -> None:
        """Select the size entry matching the typed width and height."""
        size = self.settings.size
        found = [times for times in _TIMES if self._pictures.view_size * times == size]
        self.times.setCurrentIndex(self.times.findData(found[0] if found else 0))

    def _show(self) -> None:
        """Update the preview, and report a size too large to render."""
        wish = self.settings
        small = wish.size.scaled(_PREVIEW, Qt.AspectRatioMode.KeepAspectRatio).expandedTo(QSize(1, 1))
        try:
            self.preview.image = self._pictures.picture(
                PictureSettings(small, wish.transparent, wish.legend, wish.gizmo)
            )
            self._pictures.check_size(wish.size)
            self._show_problem("")
        except InputError as error:
            self._show_problem(str(error))
        self.preview.update()

    def _show_problem(self, problem: str) -> None:
        self.problem.setText(problem)
        self.problem.setVisible(bool(problem))
        for button in (self.save, self.copy):
            button.setEnabled(not problem)

    def _copy(self) -> None:
        self._pictures.copy(self.settings)
        self.reject()


_MARGIN, _ROUND = 12.0, 8.0  # pixels of the window


@dataclass(frozen=True)
class PictureSettings:
    """Size, background and overlays of a picture.

    Attributes
    ----------
    size : QSize
        Pixels.
    transparent : bool
        Whether the background is left out.
    legend, gizmo : bool
        Whether to draw the legend and the gizmo, if shown.
    """

    size: QSize
    transparent: bool = False
    legend: bool = True
    gizmo: bool = False


class PictureRenderer:
    """Renderer of pictures of a canvas."""

    def __init__(self, canvas: Canvas, display_options: DisplayOptions, notice: Notice, jobs: Jobs) -> None:
        self._canvas, self._looks, self._notice, self._jobs = canvas, display_options, notice, jobs

    @property
    def view_size(self) -> QSize:
        """Size of the view in device pixels."""
        view = self._canvas.viewport
        return view.size() * view.devicePixelRatioF()

    @property
    def has_legend(self) -> bool:
        """True if an overlay with a legend is shown."""
        return self._looks.overlay.measure is not None

    @property
    def has_gizmo(self) -> bool:
        """True if any gizmo is shown."""
        return bool(self._gizmos)

    @property
    def _gizmos(self) -> list[Gizmo]:
        """Gizmos shown, of the active handle or obstacle."""
        return [tool for tool in self._canvas.viewport.tools if isinstance(tool, Gizmo) and tool.visible]

    def save(self, path: Path, settings: PictureSettings) -> None:
        """Render a picture now, and write it as PNG in the background."""
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
        self._jobs.run(title, work, partial(self._notice.show_message, file=path), can_be_cancelled=False)

    def copy(self, settings: PictureSettings | None = None) -> None:
        """Copy a picture to the clipboard, by default the view without the gizmo."""
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
        """Picture with these settings; raises InputError if too large to render."""
        view = self._canvas.viewport
        QGuiApplication.setOverrideCursor(Qt.CursorShape.WaitCursor)
        try:
            image = scene_picture(view, settings.size, settings.transparent)
        finally:
            QGuiApplication.restoreOverrideCursor()
        scale = picture_scale(view.size(), settings.size)
        with QPainter(image) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            # Origin at the centre, as the free part of the view is centred in the picture.
            painter.translate(QPointF(settings.size.width(), settings.size.height()) / 2)
            painter.scale(scale, scale)
            painter.save()
            painter.translate(-QPointF(*view.camera_controller.camera.middle))
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
        """Draw the legend above the painter's origin, the lower left corner."""
        heat, theme = self._looks.overlay, DARK if self._canvas.viewport.is_dark else LIGHT
        card = QRectF(_MARGIN, -_MARGIN - HEIGHT, WIDTH, HEIGHT)
        painter.setPen(QPen(QColor(theme.line), 1.0))
        painter.setBrush(QColor(theme.raised))
        painter.drawRoundedRect(card, _ROUND, _ROUND)
        svg = legend_svg(heat.scale, heat.unit, heat.reading.span, theme.ink)
        QSvgRenderer(QByteArray(svg.encode())).render(painter, card)
