"""Column of cards over the canvas, and the tool bar of selection modes."""

from collections.abc import Callable, Sequence
from itertools import product

import numpy as np
from PySide6.QtCore import QEvent, QMargins, QObject, QPoint, QRect, QRectF, Qt
from PySide6.QtGui import QAction, QMouseEvent
from PySide6.QtWidgets import QWidget

from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.widgets.box_layouts import column_layout
from apd_viewer.ui.widgets.tool_bar import ToolBar
from apd_viewer.ui.widgets.wheel import block_mouse_events

_MARGIN, _GAP = 12, 8
CARD_WIDTH = 288
_SHARE = 1 / 8  # largest fraction of the canvas that a card hides unless unfolded
GEOMETRY_EVENTS = (
    QEvent.Type.Move,
    QEvent.Type.Resize,
    # Unlike Show and Hide, the next two are also sent to children of a hidden widget.
    QEvent.Type.ShowToParent,
    QEvent.Type.HideToParent,
    QEvent.Type.LayoutRequest,
)


class CardStack(QWidget):
    """Column of cards placed clear of the other widgets of the canvas.

    Parameters
    ----------
    below : sequence of QWidget
        Widgets at the bottom of the canvas, not to be covered.
    """

    def __init__(self, canvas: Viewport, below: Sequence[QWidget]) -> None:
        super().__init__(canvas)
        self._canvas = canvas
        self._below, self._beside = list[QWidget](), list[QWidget]()
        self._fits: dict[QWidget, Callable[[int, int], None]] = {}
        self._grip: QPoint | None = None  # offset of the cursor in the column during a drag
        self._corner: QPoint | None = (
            None  # position of the column once it has been dragged; None means the default
        )
        self._placing = False
        self._column = column_layout(spacing=_GAP, parent=self)
        canvas.resized.connect(self.reposition)
        self.hide()
        self.keep_above(below)

    def add(self, card: QWidget, fit_into: Callable[[int, int], None] | None = None) -> None:
        """Add a card; ``fit_into(least, most)`` shrinks it to a height if possible.

        ``most`` is the available height, ``least`` the height that hides little of the mesh.
        """
        if fit_into is not None:
            self._fits[card] = fit_into
        self._column.addWidget(card)
        card.installEventFilter(self)

    def keep_above(self, others: Sequence[QWidget]) -> None:
        """Leave room for widgets at the bottom of the canvas."""
        self._below += others
        for other in others:
            other.installEventFilter(self)

    def stay_clear_of(self, column: QWidget) -> None:
        """Keep the cards clear of a column at the left edge of the canvas."""
        self._beside.append(column)
        column.installEventFilter(self)
        self.reposition()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Reposition when other widgets change; drag the column by its cards."""
        if event.type() in GEOMETRY_EVENTS and not self._placing:
            self.reposition()
        return isinstance(event, QMouseEvent) and watched.parent() is self and self._drag(event)

    def _drag(self, event: QMouseEvent) -> bool:
        """Move the column with a dragged card; a double click restores its position."""
        at, left = event.globalPosition().toPoint(), event.button() == Qt.MouseButton.LeftButton
        if event.type() == QEvent.Type.MouseButtonPress and left:
            self._grip = at - self.pos()
        elif event.type() == QEvent.Type.MouseMove and self._grip is not None:
            self._corner = at - self._grip
            self.reposition()
        elif event.type() == QEvent.Type.MouseButtonRelease and left:
            self._grip = None
        elif event.type() == QEvent.Type.MouseButtonDblClick and left:
            self._corner = None
            self.reposition()
        return True

    def reposition(self) -> None:
        """Move the column to its position, clear of other widgets."""
        self._placing = True  # ignore the layout events of the cards while they are placed
        try:
            self._place()
        finally:
            self._placing = False

    def _place(self) -> None:
        items = filter(None, map(self._column.itemAt, range(self._column.count())))
        shown = [card for item in items if (card := item.widget()) is not None and not card.isHidden()]
        if shown:
            self._shrink_cards(shown)
            widest = max(card.minimumSizeHint().width() for card in shown)
            self.setFixedWidth(max(widest, min(CARD_WIDTH, self._canvas.width() // 3)))
            # Activate the layout now; when shown, the cards would otherwise keep the layout of the old size.
            self._column.activate()
            self.adjustSize()
        self.setVisible(bool(shown))
        if not shown:
            return
        room = self._default_rectangle() if self._corner is None else QRect(self._corner, self.size())
        free = self._canvas.size().shrunkBy(QMargins(0, 0, self.width() + _MARGIN, self.height() + _MARGIN))
        self.move(max(min(room.left(), free.width()), _MARGIN), max(min(room.top(), free.height()), _MARGIN))
        self.raise_()

    def _default_rectangle(self) -> QRect:
        """Default rectangle at the lower left, beside and above other widgets."""
        room = QRect(_MARGIN, self._canvas.height() - self.height() - _MARGIN, self.width(), self.height())
        beside = [other for other in self._beside if not other.isHidden()]
        below = [other for other in self._below if not other.isHidden()]
        for _ in range(2):  # twice, as moving up may bring the cards beside another column
            for other in beside:
                if _are_close(room, other):
                    room.moveLeft(other.geometry().right() + _MARGIN)
            room = rectangle_moved_above(room, below)
        return room

    def _shrink_cards(self, shown: Sequence[QWidget]) -> None:
        """Shrink cards if there is no room for all of them."""
        room = self._canvas.height() - 2 * _MARGIN - (len(shown) - 1) * _GAP
        room -= sum(card.sizeHint().height() for card in shown if card not in self._fits)
        least = int(_SHARE * self._canvas.width() * self._canvas.height() / CARD_WIDTH)
        for card in shown:
            if fit_into := self._fits.get(card):
                fit_into(min(least, room), room)


def free_span(canvas: Viewport) -> tuple[int, int]:
    """Left end and width of the canvas part not covered by bars at its left edge."""
    left = canvas.camera_controller.covered_left
    return left, canvas.width() - left


def spare_mesh(canvas: Viewport, on: bool) -> None:
    """Drop hints that find no room beside a framed mesh, or let them cover it."""
    canvas.spares_mesh = on
    canvas.resized.emit()


def covers_framed_mesh(rect: QRect, canvas: Viewport) -> bool:
    """True if a rectangle covers the framed mesh."""
    mesh = _framed_mesh(canvas)
    return mesh is not None and mesh.intersects(rect)


def span_beside_mesh(canvas: Viewport) -> tuple[int, int]:
    """Left end and width of the canvas beside the mesh, on its freer side."""
    (start, span), mesh = free_span(canvas), _framed_mesh(canvas)
    if mesh is None:
        return start, span
    left, right = mesh.left() - start, start + span - mesh.right() - 1
    return (mesh.right() + 1, right) if right >= left else (start, left)


def _framed_mesh(canvas: Viewport) -> QRect | None:
    """Rectangle around a framed mesh; None if the camera was moved since."""
    look, box = canvas.camera_controller, () if canvas.box is None else canvas.box()
    if not box or not look.is_framing:
        return None
    at = look.camera.project(np.array(list(product(*np.reshape(box, (3, 2))))))
    (left, top), (right, bottom) = at.min(axis=0), at.max(axis=0)
    return QRectF(left, top, right - left, bottom - top).toAlignedRect().intersected(canvas.rect())


def rectangle_moved_above(rect: QRect, below: Sequence[QWidget]) -> QRect:
    """Rectangle moved up until it covers no visible widget."""
    shown = [other for other in below if not other.isHidden()]
    for other in sorted(shown, key=lambda widget: -widget.geometry().bottom()):
        if _are_close(rect, other):
            rect.moveBottom(other.geometry().top() - _MARGIN)
    return rect


def _are_close(room: QRect, other: QWidget) -> bool:
    return other.geometry().adjusted(-_GAP, -_GAP, _GAP, _GAP).intersects(room)


class ModeBar(ToolBar):
    """Vertical tool bar of selection modes at the left edge of the canvas.

    Parameters
    ----------
    groups : sequence of sequences of QAction
        Parted by lines.
    """

    def __init__(self, canvas: Viewport, title: str, groups: Sequence[Sequence[QAction]]) -> None:
        super().__init__(title, canvas, "ways", groups)
        block_mouse_events(self)
        self._canvas = canvas
        self.setOrientation(Qt.Orientation.Vertical)
        self.move(QPoint(_MARGIN, _MARGIN))
        self.hide()
        canvas.camera_controller.bars.append(self)
        canvas.resized.connect(self._fit)

    def show_bar(self, on: bool) -> None:
        """Show the bar if the active tool has modes, or hide it; reframe the mesh."""
        self.setVisible(on)
        self._fit()
        self._canvas.camera_controller.keep_framing()

    def _fit(self) -> None:
        """Shrink to the canvas height; the last modes move to the overflow menu."""
        room = self._canvas.height() - 2 * _MARGIN
        self.resize(self.sizeHint().width(), min(self.sizeHint().height(), room))
