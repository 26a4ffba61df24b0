"""The small cards over the canvas, one below the other at its lower left."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from PySide6.QtCore import QEvent, QObject, QRect
from PySide6.QtWidgets import QVBoxLayout, QWidget

from apd_viewer.ui.scene.viewport import Viewport

_MARGIN, _GAP = 12, 8
WIDTH = 288
_MOVES = (
    QEvent.Type.Move,
    QEvent.Type.Resize,
    # These come to what is in a hidden widget too.
    QEvent.Type.ShowToParent,
    QEvent.Type.HideToParent,
    QEvent.Type.LayoutRequest,
)


class Cards(QWidget):
    """Column of cards beside and above the canvas's other widgets.

    Parameters
    ----------
    canvas : Viewport
    below : sequence of QWidget
        On the canvas, at its bottom: they must not be covered.
    """

    def __init__(self, canvas: Viewport, below: Sequence[QWidget]) -> None:
        super().__init__(canvas)
        self._canvas = canvas
        self._below, self._beside = list[QWidget](), list[QWidget]()
        self._fits: dict[QWidget, Callable[[int], None]] = {}
        self._placing = False
        self._column = QVBoxLayout(self, spacing=_GAP)
        self._column.setContentsMargins(0, 0, 0, 0)
        self.setFixedWidth(WIDTH)
        canvas.resized.connect(self.place)
        self.hide()
        self.stand_above(below)

    def add(self, card: QWidget, fit_into: Callable[[int], None] | None = None) -> None:
        """Add a card; ``fit_into(height)`` shrinks it, if it can."""
        if fit_into is not None:
            self._fits[card] = fit_into
        self._column.addWidget(card)
        card.installEventFilter(self)

    def stand_above(self, others: Sequence[QWidget]) -> None:
        """Leave room for widgets at the bottom of the canvas."""
        self._below += others
        for other in others:
            other.installEventFilter(self)

    def stand_beside(self, column: QWidget) -> None:
        """Leave a column at the left edge of the canvas uncovered too."""
        self._beside.append(column)
        column.installEventFilter(self)
        self.place()

    def eventFilter(self, _: QObject, event: QEvent) -> bool:
        """Make room for other widgets shown."""
        if event.type() in _MOVES and not self._placing:
            self.place()
        return False

    def place(self) -> None:
        """Move to the free place."""
        self._placing = True  # what it does to its cards is no news
        try:
            self._place()
        finally:
            self._placing = False

    def _place(self) -> None:
        cards = [self._column.itemAt(k).widget() for k in range(self._column.count())]
        shown = [card for card in cards if card is not None and not card.isHidden()]
        if shown:
            self._fold(shown)
            # Shown in the size that it had, it would lay out what is in its cards for that one.
            self._column.activate()
            self.adjustSize()
        self.setVisible(bool(shown))
        if not shown:
            return
        room = QRect(_MARGIN, self._canvas.height() - self.height() - _MARGIN, self.width(), self.height())
        beside = [other for other in self._beside if not other.isHidden()]
        below = [other for other in self._below if not other.isHidden()]
        for _ in range(2):  # above what is below, it may be beside a column that it was not beside before
            for other in beside:
                if _meet(room, other):
                    room.moveLeft(other.geometry().right() + _MARGIN)
            for other in sorted(below, key=lambda widget: -widget.geometry().bottom()):
                if _meet(room, other):
                    room.moveBottom(other.geometry().top() - _MARGIN)
        self.move(room.left(), max(room.top(), _MARGIN))
        self.raise_()

    def _fold(self, shown: Sequence[QWidget]) -> None:
        """Shrink cards if there is no room for all of them."""
        room = self._canvas.height() - 2 * _MARGIN - (len(shown) - 1) * _GAP
        room -= sum(card.sizeHint().height() for card in shown if card not in self._fits)
        for card in shown:
            if fit_into := self._fits.get(card):
                fit_into(room)


def _meet(room: QRect, other: QWidget) -> bool:
    return other.geometry().adjusted(-_GAP, -_GAP, _GAP, _GAP).intersects(room)
