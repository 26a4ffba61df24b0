"""Pictures of a driven window, with what a script draws over it; the same script gives the same picture."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from pathlib import Path

import ink
import numpy as np
from driven_window import DrivenWindow, Point, as_point
from picture_files import pixels
from PySide6.QtCore import QCoreApplication, QEvent, QPoint, QPointF, QRect, QRectF, QSize, Qt
from PySide6.QtGui import QImage, QPainter
from PySide6.QtWidgets import QLabel, QWidget

from apd_viewer.presentation.scales import Measure
from apd_viewer.ui.scene.scene_picture import scene_picture
from apd_viewer.ui.widgets.folding_section import reveal_widget

_TIME = re.compile(r", [\d.,]+ \S+ per iteration|, (?:about \d+ \S+|more than an hour) left")


class Stage(DrivenWindow):
    """A driven window, and the pictures of it.

    Parameters
    ----------
    folder, quick, smooth
        See :class:`~driven_window.DrivenWindow`.
    """

    def __init__(self, folder: Path, quick: bool = False, smooth: bool | None = None) -> None:
        super().__init__(folder, quick, smooth)
        self._over: list[Callable[[QPainter], None]] = []

    # What is drawn over it

    def place(self, at: Point | QWidget, widget: QWidget | None = None) -> QPointF:
        """Position in the window of a point in a widget, by itself the view; of a widget its middle."""
        if isinstance(at, QWidget):
            at, widget = QRectF(at.rect()).center(), at
        shell = self.window.shell
        return QPointF((widget or self.view).mapTo(shell, as_point(at)))

    def box(self, *widgets: QWidget, margin: float = 3.0) -> QRectF:
        """Box around widgets, in the window."""
        whole = QRect()
        for widget in widgets:
            whole |= QRect(widget.mapTo(self.window.shell, QPoint(0, 0)), widget.size())
        return QRectF(whole).adjusted(-margin, -margin, margin, margin)

    def cursor(self, at: Point, pressed: bool = False, widget: QWidget | None = None) -> None:
        """Draw the mouse there."""
        place = self.place(at, widget)
        self._over.append(lambda painter: ink.draw_cursor(painter, place, pressed))

    def trail(self, way: Sequence[Point]) -> None:
        """Draw the way of a drag in the view."""
        places = [self.place(point) for point in way]
        self._over.append(lambda painter: ink.draw_trail(painter, places))

    def mark(self, *widgets: QWidget, margin: float = 3.0) -> None:
        """Draw a frame around widgets."""
        box = self.box(*widgets, margin=margin)
        self._over.append(lambda painter: ink.draw_box(painter, box))

    def callout(self, text: str, target: Point | QWidget, by: Sequence[float]) -> None:
        """Say something beside a target in the view or a widget, ``by`` so many pixels from it."""
        place = self.place(target)
        where = place + QPointF(*by)
        self._over.append(lambda painter: ink.draw_callout(painter, text, place, where))

    def number(self, number: int, target: Point | QWidget, by: Sequence[float] = (0, 0)) -> None:
        """Put a number at a target, for a list below the picture."""
        place = self.place(target) + QPointF(*by)
        self._over.append(lambda painter: ink.draw_number(painter, number, place))

    # Pictures

    def look(self, right: float, up: float, front: float, margin: float = 0.0) -> None:
        """Look at the mesh from a direction, and frame it."""
        look = self.window.canvas.viewport.camera_controller
        stand = np.array([right, up, front]) / np.linalg.norm([right, up, front])
        look.camera = look.camera.seen_from(stand)
        state = self.state
        look.frame(np.concatenate([state.document.mesh.V, state.frame.U]), margin)
        self.settle()

    def overlay(self, measure: Measure | None) -> None:
        """Colour the mesh by a measure, or by its paint."""
        self.window.display_options.overlay.choose_measure(measure)
        self.settle()
        legend = self.window.display_options.legend
        self.wait(lambda: not any("Preparing" in label.text() for label in legend.findChildren(QLabel)))
        if measure is not None and not self.quick:
            self.wait(lambda: legend.fit.isEnabled())  # once the largest value is known
        self.settle()

    @property
    def view_box(self) -> QRectF:
        """The view, in the window."""
        return self.box(self.view, margin=0.0)

    def panel_box(self, *sections: QWidget, margin: float = 10.0) -> QRectF:
        """Sections of the panel, in the window; their page is shown, and scrolls to the first one."""
        panel = self.window.panel
        for section in reversed(sections):
            reveal_widget(section)
        self.pause(50)
        box = self.box(*sections, margin=margin)
        whole = self.box(panel, margin=0.0)
        return QRectF(whole.left(), max(box.top(), whole.top()), whole.width(), 1).united(
            QRectF(whole.left(), box.top(), whole.width(), min(box.bottom(), whole.bottom()) - box.top())
        )

    def picture(self, crop: QRectF | None = None) -> QImage:
        """The window as it is, with what is drawn over it.

        ``crop`` leaves all but a part of it out, and its title bar.
        """
        self.window.status.clearMessage()  # it would go in a moment
        image = self.grabbed(self.window.shell)
        with ink.begun(image) as painter:
            for draw in self._over:
                draw(painter)
        self._over.clear()
        if crop is not None:
            return ink.framed(_cut(image, crop), "")
        return ink.framed(image, self.window.shell.windowTitle().replace("[*]", ""), self.dark)

    def scene(self, width: int, height: int) -> QImage:
        """The shapes in the view, on nothing, without tools, as large as they fit into a box."""
        scale, view = (1 if self.quick else 2), self.window.canvas.viewport
        size = QSize(width, height) * scale
        image = scene_picture(view, view.size() * (2 * scale), transparent=True)
        alpha = pixels(image).getchannel("A").getbbox() or (0, 0, image.width(), image.height())
        left, top, right, bottom = alpha
        inner = image.copy(left, top, right - left, bottom - top)
        keep, smooth = Qt.AspectRatioMode.KeepAspectRatio, Qt.TransformationMode.SmoothTransformation
        return ink.centred(inner.scaled(size * 0.94, keep, smooth), width, height, scale)

    def dialog(self, dialog: QWidget) -> QImage:
        """A dialog by itself, with its title; nothing in it has the keys, as that may come late."""
        self.pause(150)
        focused = dialog.focusWidget()
        if focused is not None:
            focused.clearFocus()
        self.pause(50)
        return ink.framed(self.grabbed(dialog), dialog.windowTitle())

    def grabbed(self, widget: QWidget) -> QImage:
        """A widget as it is on the screen, without the times in it."""
        for label in widget.findChildren(QLabel):
            if _TIME.search(label.text()):
                label.setText(_TIME.sub("", label.text()))
        # What is beside a time moves up.
        QCoreApplication.sendPostedEvents(None, QEvent.Type.LayoutRequest.value)
        return widget.grab().toImage().convertToFormat(QImage.Format.Format_ARGB32_Premultiplied)


def _cut(image: QImage, box: QRectF) -> QImage:
    scale = image.devicePixelRatio()
    part = QRectF(box.topLeft() * scale, box.size() * scale).toAlignedRect().intersected(image.rect())
    cut = image.copy(part)
    cut.setDevicePixelRatio(scale)
    return cut
