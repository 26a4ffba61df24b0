"""The small cards over the canvas, one below the other at its lower left."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QEvent, QObject, QRect
from PySide6.QtWidgets import QVBoxLayout, QWidget

from apd_viewer.ui.viewport import Viewport

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
    """A column that stands beside and above what else lies on the canvas.

    Parameters
    ----------
    canvas : Viewport
    below : sequence of QWidget
        On the canvas, at its bottom: they must not be covered.
    """

    def __init__(self, canvas: Viewport, below: Sequence[QWidget]) -> None:
        super().__init__(canvas)
        self._canvas = canvas
        self._below, self._beside = list(below), list[QWidget]()
        self._column = QVBoxLayout(self, spacing=_GAP)
        self._column.setContentsMargins(0, 0, 0, 0)
        self.setFixedWidth(WIDTH)
        canvas.resized.connect(self.place)
        for other in below:
            other.installEventFilter(self)
        self.hide()

    def add(self, card: QWidget) -> None:
        """Put a card under the others."""
        self._column.addWidget(card)
        card.installEventFilter(self)

    def stand_beside(self, column: QWidget) -> None:
        """Leave a column at the left edge of the canvas uncovered too."""
        self._beside.append(column)
        column.installEventFilter(self)
        self.place()

    def eventFilter(self, _: QObject, event: QEvent) -> bool:
        """Make room for what else is shown."""
        if event.type() in _MOVES:
            self.place()
        return False

    def place(self) -> None:
        """Stand where there is room."""
        cards = [self._column.itemAt(k).widget() for k in range(self._column.count())]
        self.setVisible(any(card is not None and not card.isHidden() for card in cards))
        if self.isHidden():
            return
        self._column.activate()
        self.adjustSize()
        room = QRect(_MARGIN, self._canvas.height() - self.height() - _MARGIN, self.width(), self.height())
        for other in self._beside:
            if not other.isHidden() and _meet(room, other):
                room.moveLeft(other.geometry().right() + _MARGIN)
        for other in sorted(self._below, key=lambda widget: -widget.geometry().bottom()):
            if not other.isHidden() and _meet(room, other):
                room.moveBottom(other.geometry().top() - _MARGIN)
        self.move(room.left(), max(room.top(), _MARGIN))
        self.raise_()


def _meet(room: QRect, other: QWidget) -> bool:
    return other.geometry().adjusted(-_GAP, -_GAP, _GAP, _GAP).intersects(room)
