"""Findings of the mesh check: a badge, and a list over the canvas."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QPointF, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPushButton, QScrollArea, QVBoxLayout, QWidget

from apd_viewer.language import tr
from apd_viewer.presentation.palette import MARK_COLOR
from apd_viewer.ui.overlays.findings_badge import ENTER_KEYS
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.widgets.event_barrier import shield
from apd_viewer.ui.widgets.fields import CheckBox, small_button
from apd_viewer.ui.widgets.icons import icon
from apd_viewer.ui.widgets.theme import Theme, set_style_property

_MARGIN = 12
_WIDEST = 380
_INDENT = 22  # of a loose part, below what is said of all of them
_ROOM = 0.5  # of the height of the canvas: its middle, where a finding is shown, stays free


class _Spot(QWidget):
    """Ring filled while its finding is marked on the mesh."""

    def __init__(self) -> None:
        super().__init__()
        self.setFixedSize(14, 18)
        self.on = False

    def paintEvent(self, _: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        color = QColor(*MARK_COLOR) if self.on else self.palette().placeholderText().color()
        painter.setPen(QPen(color, 1.5))
        painter.setBrush(color if self.on else Qt.BrushStyle.NoBrush)
        painter.drawEllipse(QPointF(7, 9), 4.25, 4.25)


class FindingRow(QFrame):
    """Sentence of a finding, clickable.

    Attributes
    ----------
    chosen : Signal()
    step_requested : Signal(int)
        The arrow keys ask for the row above, -1, or below, 1.
    stay_toggled : Signal(bool)
        The parts of this row are to stay, or to go along.
    weld_requested : Signal()
        What it is about is to be welded.

    Parameters
    ----------
    sentence : str
    components : tuple of int
        The loose parts that it is about: each may stay.
    weldable : bool
        Whether it is about seams that can be welded.
    """

    chosen = Signal()
    step_requested = Signal(int)
    stay_toggled = Signal(bool)
    weld_requested = Signal()

    def __init__(self, sentence: str, components: tuple[int, ...] = (), weldable: bool = False) -> None:
        super().__init__(objectName="finding", focusPolicy=Qt.FocusPolicy.StrongFocus)
        self.setToolTip(tr("Show where this is"))
        self._sentence, self._parts = sentence, components
        self._spot = _Spot()
        row = QHBoxLayout(self, spacing=8)
        row.setContentsMargins(
            _INDENT if components else 8, 3 if components else 6, 8, 3 if components else 6
        )
        flags = Qt.AlignmentFlag
        row.addWidget(self._spot, 0, flags.AlignVCenter if components else flags.AlignTop)
        row.addWidget(QLabel(sentence, wordWrap=True, textFormat=Qt.TextFormat.PlainText), 1)
        self.stay = CheckBox(tr("Stays"), visible=bool(components))
        self.stay.setToolTip(tr("Leave it in place; otherwise it goes along with the nearest surface"))
        self.stay.setAccessibleName(tr("{sentence} Stays in place.").format(sentence=sentence))
        self.stay.clicked.connect(self.stay_toggled)
        row.addWidget(self.stay, 0, flags.AlignVCenter)
        self.weld = QPushButton(tr("Weld"), visible=weldable)
        self.weld.setToolTip(tr("Hold the seams together; the file keeps all its vertices"))
        self.weld.clicked.connect(self.weld_requested)
        row.addWidget(self.weld, 0, flags.AlignVCenter)
        self.show_marked(False)

    def show_staying(self, staying: tuple[int, ...]) -> None:
        """Check the box if all its parts are among those ``staying``."""
        self.stay.setChecked(set(self._parts) <= set(staying))

    def show_marked(self, on: bool) -> None:
        """Say whether this finding is shown on the mesh."""
        self.setAccessibleName(
            tr("{sentence} Shown on the mesh.").format(sentence=self._sentence) if on else self._sentence
        )
        self._spot.on = on
        self._spot.update()
        set_style_property(self, "marked", on)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Ask to be shown."""
        if event.button() == Qt.MouseButton.LeftButton:
            self.setFocus()
            self.chosen.emit()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Ask to be shown, or go to a neighbour."""
        if event.key() in (*ENTER_KEYS, Qt.Key.Key_Space):
            self.chosen.emit()
        elif event.key() in (Qt.Key.Key_Up, Qt.Key.Key_Down):
            self.step_requested.emit(-1 if event.key() == Qt.Key.Key_Up else 1)
        else:
            super().keyPressEvent(event)


class FindingList(QFrame):
    """All findings, at the lower right of the canvas, over the badge.

    Attributes
    ----------
    chosen : Signal(int)
        The row to be shown, by its number.
    stay_toggled : Signal(int, bool)
        The loose parts of a row, by its number, are to stay, or to go along.
    weld_requested : Signal()
        The seams are to be welded.
    dismissed : Signal()
        Esc, or the cross.
    rows : list of FindingRow
    close_button : QToolButton
    """

    chosen = Signal(int)
    stay_toggled = Signal(int, bool)
    weld_requested = Signal()
    dismissed = Signal()

    def __init__(self, canvas: Viewport) -> None:
        super().__init__(canvas, objectName="findings")
        shield(self)
        self._canvas = canvas
        self.rows: list[FindingRow] = []
        self._title = QLabel(objectName="heading")
        self.close_button = small_button(tr("Close mesh check"), tr("Close (Esc)"))
        self.close_button.clicked.connect(self.dismissed)
        head = QHBoxLayout()
        head.setContentsMargins(8, 0, 0, 0)
        head.addWidget(self._title, 1)
        head.addWidget(self.close_button)
        self._lines = QVBoxLayout()
        self._scroll = QScrollArea(widgetResizable=True, focusPolicy=Qt.FocusPolicy.NoFocus)
        self._scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        column = QVBoxLayout(self, spacing=4)
        column.setContentsMargins(6, 6, 6, 6)
        column.addLayout(head)
        column.addWidget(self._scroll)
        self.hide()
        canvas.resized.connect(self._place)

    def open(self, title: str, rows: Sequence[FindingRow]) -> None:
        """List the rows, none of them shown yet, and give the keys to the first."""
        body = QWidget(objectName="rows")
        column = self._lines = QVBoxLayout(body, spacing=2)
        column.setContentsMargins(0, 0, 0, 0)
        self.rows = list(rows)
        for k, row in enumerate(self.rows):
            column.addWidget(row)
            row.chosen.connect(lambda k=k: self.chosen.emit(k))
            row.step_requested.connect(lambda step, k=k: self._step(k + step))
            row.stay_toggled.connect(lambda on, k=k: self.stay_toggled.emit(k, on))
            row.weld_requested.connect(self.weld_requested)
        column.addStretch(1)
        self._scroll.setWidget(body)
        self._title.setText(title)
        self.setAccessibleName(self._title.text())
        self.show()
        self.raise_()
        self._place()
        self.rows[0].setFocus(Qt.FocusReason.PopupFocusReason)

    def show_marked(self, number: int) -> None:
        """Emphasise the finding marked on the mesh."""
        for k, row in enumerate(self.rows):
            row.show_marked(k == number)

    def show_staying(self, staying: tuple[int, ...]) -> None:
        """Check the boxes of the loose parts that stay."""
        for row in self.rows:
            row.show_staying(staying)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icon."""
        self.close_button.setIcon(icon("cancel", theme))

    def _step(self, k: int) -> None:
        if 0 <= k < len(self.rows):
            self.rows[k].setFocus()
            self._scroll.ensureWidgetVisible(self.rows[k])
            self.chosen.emit(k)

    def _place(self) -> None:
        if self.isHidden():
            return
        canvas = self._canvas
        width = max(120, min(_WIDEST, canvas.width() - 2 * _MARGIN))
        around = self.contentsMargins()
        inner = width - 12 - around.left() - around.right()
        lines = self._lines.heightForWidth(inner)
        room = max(96, round(_ROOM * canvas.height()) - 52)
        if lines > room:
            lines = self._lines.heightForWidth(inner - self._scroll.verticalScrollBar().sizeHint().width())
        self._scroll.setFixedHeight(min(lines, room))
        self.setFixedWidth(width)
        self.adjustSize()
        self.move(canvas.width() - width - _MARGIN, canvas.height() - self.height() - _MARGIN)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Esc closes the list."""
        if event.key() == Qt.Key.Key_Escape:
            self.dismissed.emit()
        else:
            super().keyPressEvent(event)
