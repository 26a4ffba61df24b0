"""Dialog for a picture, with a preview."""

from __future__ import annotations

from PySide6.QtCore import QRect, QSize, Qt, QTimer
from PySide6.QtGui import QColor, QImage, QPainter, QPaintEvent
from PySide6.QtWidgets import QDialog, QGridLayout, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.ui.sharing.pictures import Pictures, PictureSettings
from apd_viewer.ui.widgets.fields import CheckBox, ComboBox, NumberField
from apd_viewer.ui.widgets.help_button import HelpButton

_LEAST, _MOST = 16, 32_768  # pixels per side; a hint tells what cannot be drawn
_TIMES = (1, 2, 3, 4)
_PREVIEW = QSize(360, 270)
_SOON = 40  # ms
_SQUARE = 8  # px


class _Preview(QWidget):
    """Preview on squares for transparency."""

    def __init__(self) -> None:
        super().__init__(accessibleName=tr("Preview"))
        self.setFixedSize(_PREVIEW)
        self.image = QImage()

    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw it."""
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
    """Size, background and overlays of a picture.

    Parameters
    ----------
    parent : QWidget
    pictures : Pictures
    settings : PictureSettings
        To begin with.

    Attributes
    ----------
    times : ComboBox
        Multiples of the view, and a size of one's own.
    width_, height_ : NumberField
        Pixels.
    transparent, legend, gizmo : CheckBox
    save, copy : QPushButton
    """

    def __init__(self, parent: QWidget, pictures: Pictures, settings: PictureSettings) -> None:
        super().__init__(parent, objectName="picture")
        self.setWindowTitle(tr("Save picture"))
        self._pictures = pictures
        self.preview = _Preview()
        self._make_fields(settings)
        self._lay_out()
        self._soon = QTimer(self, singleShot=True, interval=_SOON)
        self._soon.timeout.connect(self._show)
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
        self._put(wish.size)
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
        sides = QHBoxLayout(spacing=8)
        for part in (self.width_, QLabel("×"), self.height_):
            sides.addWidget(part)
        sides.addStretch(1)
        grid.addWidget(QLabel(tr("Size"), buddy=self.times), 0, 0)
        grid.addWidget(self.times, 0, 1)
        grid.addLayout(sides, 1, 1)
        for row, check in enumerate((self.transparent, self.legend, self.gizmo), start=2):
            grid.addWidget(check, row, 1)
        self.problem = QLabel("", objectName="problem", wordWrap=True)
        grid.addWidget(self.problem, 5, 0, 1, 2)
        grid.setRowStretch(6, 1)
        top = QHBoxLayout(spacing=20)
        top.addWidget(self.preview)
        top.addLayout(grid)
        self.help = HelpButton()
        buttons = QHBoxLayout(spacing=8)
        buttons.addWidget(self.help)
        buttons.addStretch(1)
        for button in (self._cancel, self.copy, self.save):
            buttons.addWidget(button)
        column = QVBoxLayout(self, spacing=16)
        column.setContentsMargins(16, 16, 16, 16)
        column.addLayout(top)
        column.addLayout(buttons)
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
        """Chosen settings."""
        size = QSize(int(self.width_.value()), int(self.height_.value()))
        return PictureSettings(
            size, self.transparent.isChecked(), self.legend.isChecked(), self.gizmo.isChecked()
        )

    def _take_times(self) -> None:
        if times := self.times.currentData():
            self._put(self._pictures.view_size * times)
        else:
            self.width_.setFocus(Qt.FocusReason.OtherFocusReason)
            self.width_.selectAll()
        self._soon.start()

    def _put(self, size: QSize) -> None:
        self.width_.show_value(size.width())
        self.height_.show_value(size.height())

    def _take_size(self) -> None:
        self._show_times()
        self._soon.start()

    def _show_times(self) -> None:
        """Name the multiple of the view's size."""
        size = self.settings.size
        found = [times for times in _TIMES if self._pictures.view_size * times == size]
        self.times.setCurrentIndex(self.times.findData(found[0] if found else 0))

    def _show(self) -> None:
        """Preview the picture, and tell if its size cannot be drawn."""
        wish = self.settings
        small = wish.size.scaled(_PREVIEW, Qt.AspectRatioMode.KeepAspectRatio).expandedTo(QSize(1, 1))
        try:
            self.preview.image = self._pictures.picture(
                PictureSettings(small, wish.transparent, wish.legend, wish.gizmo)
            )
            self._pictures.check_size(wish.size)
            self._say("")
        except InputError as error:
            self._say(str(error))
        self.preview.update()

    def _say(self, problem: str) -> None:
        self.problem.setText(problem)
        self.problem.setVisible(bool(problem))
        for button in (self.save, self.copy):
            button.setEnabled(not problem)

    def _copy(self) -> None:
        self._pictures.copy(self.settings)
        self.reject()
