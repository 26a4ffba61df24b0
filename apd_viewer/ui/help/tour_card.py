"""Card of the tour: sentence, buttons, and a pointer to its target."""

from PySide6.QtCore import QEvent, QPoint, QPointF, QRect, QSize, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QFrame, QLabel, QMainWindow, QPushButton, QWidget

from apd_viewer.language import tr, trc
from apd_viewer.ui.widgets.box_layouts import STRETCH, column_layout, row_layout
from apd_viewer.ui.widgets.theme import LIGHT, Theme

_WIDTH = 288
_BETWEEN = 8  # spacing between the buttons
_GAP = 12  # distance between the card and its target, for the pointer
_MARGIN = 8  # distance to the edge of the window
_HALF = 9  # half the width of the pointer
_CORNER = 20  # smallest distance of the pointer from a corner of the card
SIDES = {"left": (-1, 0), "right": (1, 0), "below": (0, 1), "above": (0, -1)}


def card_placement(size: QSize, target: QRect, available: QRect, uncovered: QRect) -> tuple[QRect, str]:
    """Rectangle of the card with the least overlap, and its side of the target."""
    found = []
    for side, (dx, dy) in SIDES.items():
        away = QPoint(
            dx * (_GAP + (target.width() + size.width()) // 2),
            dy * (_GAP + (target.height() + size.height()) // 2),
        )
        rect = QRect(QPoint(), size)
        rect.moveCenter(target.center() + away)
        found.append((_moved_inside(rect, available), side))
    return min(found, key=lambda place: _overlap_area(place[0], target) + _overlap_area(place[0], uncovered))


def _moved_inside(rect: QRect, room: QRect) -> QRect:
    left = max(room.left(), min(rect.left(), room.right() - rect.width() + 1))
    top = max(room.top(), min(rect.top(), room.bottom() - rect.height() + 1))
    return QRect(QPoint(left, top), rect.size())


def _overlap_area(rect: QRect, other: QRect) -> int:
    both = rect & other
    return both.width() * both.height() if both.isValid() else 0


class _Tip(QWidget):
    """Triangular pointer at an edge of the card, transparent to the mouse."""

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self._side = "left"
        self.theme = LIGHT
        self.hide()

    def attach(self, card: QRect, target: QRect, side: str) -> None:
        """Move to the card's edge facing the target, overlapping its border by 1 px."""
        if side != self._side:
            self._side = side
            self.update()
        level = side in ("left", "right")
        self.setFixedSize(_GAP, 2 * _HALF) if level else self.setFixedSize(2 * _HALF, _GAP)
        aim = target.center()
        x = max(card.left() + _CORNER, min(aim.x(), card.right() - _CORNER)) - _HALF
        y = max(card.top() + _CORNER, min(aim.y(), card.bottom() - _CORNER)) - _HALF
        places = {
            "left": QPoint(card.right(), y),
            "right": QPoint(card.left() - _GAP + 1, y),
            "below": QPoint(x, card.top() - _GAP + 1),
            "above": QPoint(x, card.bottom()),
        }
        self.move(places[side])

    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw a triangle with a border on two sides, open towards the card."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.translate(QPointF(self.rect().center()) + QPointF(0.5, 0.5))
        painter.rotate({"left": 90, "right": -90, "below": 0, "above": 180}[self._side])
        low = _GAP / 2  # base of the pointer, before its rotation
        way = QPolygonF([QPointF(-_HALF, low), QPointF(0, 1.5 - low), QPointF(_HALF, low)])
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(self.theme.raised))
        painter.drawPolygon(way)
        painter.setPen(QPen(QColor(self.theme.accent), 1))
        painter.drawPolyline(way)


class TourCard(QFrame):
    """Card showing one step of the tour.

    Attributes
    ----------
    step_requested : Signal(int)
        1 asks for the next step, -1 for the one before.
    skipped : Signal()
        Skip, or Esc.
    """

    step_requested = Signal(int)
    skipped = Signal()

    def __init__(self, window: QMainWindow) -> None:
        super().__init__(window, objectName="tour")
        self._window = window
        self.tip = _Tip(window)
        self.sentence = QLabel(wordWrap=True)
        self._number = QLabel(objectName="quiet")
        self.skip = QPushButton(tr("Skip"), objectName="flat", toolTip=tr("End the tour (Esc)"))
        self.back = QPushButton(trc("button", "Back"), clicked=lambda: self.step_requested.emit(-1))
        self.next = QPushButton(tr("Next"), objectName="primary", clicked=lambda: self.step_requested.emit(1))
        self.skip.clicked.connect(self.skipped)
        row = row_layout(self._number, STRETCH, self.skip, self.back, self.next, spacing=_BETWEEN)
        self._column = column_layout(self.sentence, row, spacing=12, margins=(16, 12, 12, 12), parent=self)
        self.hide()

    def show_step(self, number: int, count: int, sentence: str) -> None:
        """Show a step of the tour, counted from 0."""
        self._number.setText(tr("{step} of {count}").format(step=number + 1, count=count))
        self.setAccessibleName(tr("Tour, step {step}").format(step=self._number.text()))
        self.back.setVisible(number > 0)
        self.skip.setVisible(number < count - 1)
        self.next.setText(tr("Next") if number < count - 1 else tr("Done"))
        self.setFixedWidth(self._width_for_buttons())
        self.show_sentence(sentence)
        self.show()
        self.raise_()

    def _width_for_buttons(self) -> int:
        """Width of the card for all buttons side by side."""
        edges = self._column.contentsMargins()
        width = edges.left() + edges.right()
        for part in (self._number, self.skip, self.back, self.next):
            part.ensurePolished()
            width += part.sizeHint().width() + _BETWEEN
        return max(_WIDTH, width)

    def show_sentence(self, sentence: str) -> None:
        """Replace the sentence and adjust the height."""
        if sentence != self.sentence.text():
            self.sentence.setText(sentence)
            # heightForWidth never returns less than the minimum height set by the previous text.
            self.sentence.setMinimumHeight(0)
            self.sentence.setFixedHeight(self.sentence.heightForWidth(self.width() - 30))
            self._column.activate()
            self.setFixedHeight(self._column.sizeHint().height())

    def point_at(self, target: QRect | None, uncovered: QRect) -> None:
        """Move next to a target or to the bottom, keeping ``uncovered`` visible."""
        bars = self._window.menuBar().height(), self._window.statusBar().height()
        room = self._window.rect().adjusted(0, bars[0], 0, -bars[1])
        room.adjust(_MARGIN, _MARGIN, -_MARGIN, -_MARGIN)
        if target is None:
            target = QRect(room.center().x(), room.bottom(), 1, 1)
            self.setGeometry(card_placement(self.size(), target, room, uncovered)[0])
            self.tip.hide()
            return
        rect, side = card_placement(self.size(), target, room, uncovered)
        if rect != self.geometry() or self.tip.isHidden():
            self.move(rect.topLeft())
        self.tip.attach(rect, target, side)
        self.tip.setVisible(self.isVisible() and not rect.intersects(target))
        self.tip.raise_()

    def set_theme(self, theme: Theme) -> None:
        """Apply the theme to the card's arrow, which the style sheet does not reach."""
        self.tip.theme = theme
        self.tip.update()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """End the tour on Esc, press the focused button on Enter."""
        button = self.focusWidget()
        if event.key() == Qt.Key.Key_Escape:
            self.skipped.emit()
        elif event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and isinstance(button, QPushButton):
            button.click()
        else:
            super().keyPressEvent(event)

    def event(self, event: QEvent) -> bool:
        """Hide the pointer together with the card."""
        if event.type() == QEvent.Type.Hide:
            self.tip.hide()
        return super().event(event)
