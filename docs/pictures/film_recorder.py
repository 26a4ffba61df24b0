"""Films a driven window, with the mouse, clicks and keys, and a line below that says what is done."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import pairwise
from typing import NamedTuple

import ink
import numpy as np
from driven_window import Point
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QImage, QPainter, QPen
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QToolBar, QWidget
from stage import Stage

from apd_viewer.session.state_store import Activity

RATE = 15  # pictures a second
SCALE = 1.5  # pixels of the film for one of the window
_MARGIN, _LINE = 10.0, 50.0  # around the window, and the height of the line below it
_FADE = 5  # pictures in which a line comes, and a click fades
_DOWN = 0.13  # s that a button is held down
_BEND = 0.05  # how far the mouse leaves a straight way, of its length


class Line(NamedTuple):
    """What stands below the window: words, and the key that does the same."""

    words: str
    key: str = ""


class Recorder:
    """Films a stage.

    Parameters
    ----------
    stage : Stage
        Whose window is driven. If that is quick, a motion has a few pictures, each shown longer.
    take : callable
        Takes a picture, and for how many pictures of the film it is shown.

    Attributes
    ----------
    pointer : QPointF
        The mouse, in the window.
    count : int
        Pictures of the film so far.
    lines : list of Line
        Those that stood below the window so far.
    chapters : dict
        First picture of each part of the film, and the one after its last, by name.
    """

    def __init__(self, stage: Stage, take: Callable[[QImage, int], object]) -> None:
        self.stage, self._take = stage, take
        self.pointer, self.count = QPointF(), 0
        self.lines: list[Line] = [Line("")]
        self.chapters: dict[str, tuple[int, int]] = {}
        self._line_began = self._click_began = -_FADE
        self._is_down, self._carried = False, ""
        self._marked: list[QRectF] = []
        self._window: QImage | None = None

    # What is seen

    def say(self, words: str, key: str = "") -> None:
        """Put a line below the window."""
        self.lines.append(Line(words, key))
        self._line_began = self.count

    def carry(self, name: str) -> None:
        """Give the mouse a file to carry; an empty name lets it go."""
        self._carried = name

    def mark(self, *widgets: QWidget, margin: float = 4.0) -> None:
        """Draw a frame around widgets, or around nothing any more."""
        self._marked = [self.stage.box(*widgets, margin=margin)] if widgets else []

    @contextmanager
    def chapter(self, name: str) -> Iterator[None]:
        """Remember which pictures are taken within."""
        begin = self.count
        yield
        self.chapters[name] = begin, self.count

    # Pictures

    def refresh(self) -> None:
        """Look at the window again: something in it has changed."""
        self._window = None

    def rest(self) -> None:
        """Wait for the shape, and look at the window again."""
        session, stage = self.stage.window.session, self.stage
        stage.pause(30)
        stage.wait(lambda: session.jobs.current is None and session.store.activity is not Activity.REFINING)
        stage.pause(30)
        self.refresh()

    def hold(self, seconds: float) -> None:
        """Show the window for a while."""
        for _, count in self._beats(seconds):
            self._show(count)

    def picture(self) -> QImage:
        """The picture at this moment."""
        if self._window is None:
            self._window = self._grabbed()
        picture = self._window.copy()
        with ink.begun(picture) as painter:
            self._draw_line(painter)
            painter.translate(_MARGIN, _MARGIN + ink.BAR)
            for box in self._marked:
                ink.draw_box(painter, box)
            self._draw_click(painter)
            if self._carried:
                _draw_file(painter, self._carried, self.pointer)
            ink.draw_cursor(painter, self.pointer, self._is_down)
        return picture

    def _show(self, count: int) -> None:
        self._take(self.picture(), count)
        self.count += count

    def _beats(self, seconds: float) -> Iterator[tuple[float, int]]:
        """Share of the time that is over at each picture, and for how many it is shown."""
        total = max(1, round(seconds * RATE))
        ends = np.linspace(0, total, 1 + (min(2, total) if self.stage.quick else total)).round().astype(int)
        for begin, end in pairwise(ends.tolist()):
            yield end / total, end - begin

    def _grabbed(self) -> QImage:
        view, shell = self.stage.window.canvas.viewport, self.stage.window.shell
        if self.stage.smooth and view.is_stale:
            view.antialiasing.smooths_next_draw = True
        self.stage.window.status.clearMessage()
        image = self.stage.grabbed(shell)
        size = image.deviceIndependentSize().toSize()
        image = image.scaled(
            size * SCALE, Qt.AspectRatioMode.IgnoreAspectRatio, Qt.TransformationMode.SmoothTransformation
        )
        image.setDevicePixelRatio(SCALE)
        framed = ink.framed(image, shell.windowTitle().replace("[*]", ""))
        whole = QImage(_even(self._size(size) * SCALE), QImage.Format.Format_RGB32)
        whole.setDevicePixelRatio(SCALE)
        whole.fill(ink.INK)
        with ink.begun(whole) as painter:
            painter.drawImage(QPointF(_MARGIN, _MARGIN), framed)
        return whole

    @staticmethod
    def _size(window: QSize) -> QSize:
        return window + QSize(round(2 * _MARGIN), round(_MARGIN + ink.BAR + _LINE))

    # What is drawn over the window

    def _draw_line(self, painter: QPainter) -> None:
        words, key = self.lines[-1]
        painter.setOpacity(min(1.0, (self.count - self._line_began + 1) / _FADE))
        painter.setFont(ink.font(13.0, bold=True))
        wide, whole = QFontMetricsF(painter.font()).horizontalAdvance(words), self.stage.window.shell.size()
        metrics = QFontMetricsF(ink.font(10.5, bold=True))
        cap = metrics.horizontalAdvance(key) + 20 if key else 0.0
        top = _MARGIN + ink.BAR + whole.height()
        left = _MARGIN + (whole.width() - wide - (cap + 14 if key else 0.0)) / 2
        painter.setPen(ink.PAPER)
        painter.drawText(QRectF(left, top, wide + 4, _LINE), Qt.AlignmentFlag.AlignVCenter, words)
        if key:
            box = QRectF(left + wide + 14, top + _LINE / 2 - 13, cap, 26)
            painter.setFont(ink.font(10.5, bold=True))
            painter.setPen(QPen(QColor("#8d96a5"), 1.2))
            painter.setBrush(QColor("#333a46"))
            painter.drawRoundedRect(box, 5, 5)
            painter.setPen(ink.PAPER)
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, key)
        painter.setOpacity(1.0)

    def _draw_click(self, painter: QPainter) -> None:
        """A ring that grows and fades where a button was let go."""
        share = (self.count - self._click_began + 1) / (_FADE + 1)
        if self._is_down or share >= 1.0:
            return
        color = QColor(ink.ACCENT)
        color.setAlphaF(0.8 * (1.0 - share))
        painter.setPen(QPen(color, 2.5))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawEllipse(self.pointer, 15 + 12 * share, 15 + 12 * share)

    # The mouse

    def glide(
        self, to: Point | QWidget, seconds: float = 0.9, hovers: bool = False, widget: QWidget | None = None
    ) -> None:
        """Move the mouse to a point of a widget, by itself the view, or to the middle of one.

        ``hovers`` lets the view follow what the mouse passes.
        """
        begin, end = QPointF(self.pointer), self.stage.place(to, widget)
        way = end - begin
        for share, count in self._beats(seconds):
            done = _eased(share)
            aside = QPointF(-way.y(), way.x()) * (_BEND * float(np.sin(np.pi * done)))
            self.pointer = begin + way * done + aside
            if hovers:
                self._send(pressed=False)
                self.rest()
            self._show(count)

    def drag(self, way: list[QPointF], seconds: float) -> None:
        """Drag along points of the view, and see the shape follow at each picture."""
        self.stage.press(way[0])
        self._is_down = True
        shares = np.linspace(0.0, 1.0, len(way))
        for share, count in self._beats(seconds):
            x, y = (np.interp(_eased(share), shares, [getattr(p, c)() for p in way]) for c in ("x", "y"))
            self.pointer = self.stage.place(QPointF(x, y))
            self._send(pressed=True)
            self.rest()
            self._show(count)
        self.stage.release(way[-1])
        self._let_go()

    def slide(self, widget: QWidget, places: list[QPointF], seconds: float) -> None:
        """Drag the knob of a slider from the first place to the others, so long for each."""
        self.stage.press(places[0], widget=widget)
        self._is_down = True
        for begin, end in pairwise(places):
            for share, count in self._beats(seconds):
                at = begin + (end - begin) * _eased(share)
                self.pointer = self.stage.place(at, widget)
                self.stage.move(at, widget, pressed=True)
                self.rest()
                self._show(count)
        self.stage.release(places[-1], widget=widget)
        self._let_go()

    def click(self, widget: QWidget, rests: bool = True) -> None:
        """Go to a button, click it, and wait for the shape unless told otherwise."""
        self.glide(widget)
        self._is_down = True
        self.hold(_DOWN)
        QTest.mouseClick(widget, Qt.MouseButton.LeftButton)
        self._let_go(rests)

    def _let_go(self, rests: bool = True) -> None:
        self._is_down = False
        self._click_began = self.count
        if rests:
            self.rest()

    def _send(self, pressed: bool) -> None:
        self.stage.move(self.stage.view.mapFrom(self.stage.window.shell, self.pointer), pressed=pressed)

    def button(self, action: object) -> QWidget:
        """The visible button of an action in a bar of tools."""
        bars = self.stage.window.shell.findChildren(QToolBar)
        buttons = (bar.widgetForAction(action) for bar in bars)
        return next(button for button in buttons if button is not None and button.isVisible())


def _eased(share: float) -> float:
    """Way of a calm motion that begins and ends at rest."""
    return share**3 * (10.0 - 15.0 * share + 6.0 * share**2)


def _even(size: QSize) -> QSize:
    """A size of even pixels, as encoders need it."""
    return QSize(size.width() // 2 * 2, size.height() // 2 * 2)


def _draw_file(painter: QPainter, name: str, at: QPointF) -> None:
    """A file that the mouse carries."""
    painter.setFont(ink.font(10.0, bold=True))
    wide = QFontMetricsF(painter.font()).horizontalAdvance(name)
    box = QRectF(at.x() + 14, at.y() + 12, wide + 44, 34)
    painter.setPen(QPen(ink.ACCENT, 1.5))
    painter.setBrush(QColor(255, 255, 255, 235))
    painter.drawRoundedRect(box, 6, 6)
    sheet = QRectF(box.left() + 11, box.top() + 8, 14, 18)
    painter.setBrush(QColor("#dbe6fb"))
    painter.drawRoundedRect(sheet, 2, 2)
    for k in range(3):
        y = sheet.top() + 5 + 4 * k
        painter.drawLine(QPointF(sheet.left() + 3, y), QPointF(sheet.right() - 3, y))
    painter.setPen(ink.INK)
    painter.drawText(box.adjusted(33, 0, 0, 0), Qt.AlignmentFlag.AlignVCenter, name)
