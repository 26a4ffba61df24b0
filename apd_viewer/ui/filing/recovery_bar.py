"""Non-modal bar offering the sessions of crashed processes."""

from collections.abc import Callable

from PySide6.QtCore import QEvent, QObject, QPoint, QRect, Qt, Signal
from PySide6.QtWidgets import QFrame, QLabel, QPushButton, QToolButton, QWidget

from apd_viewer.language import tr, trc
from apd_viewer.session.session import Session
from apd_viewer.session.storage.recovery_file import RecoveryFile, age_text
from apd_viewer.ui.overlays.card_stack import GEOMETRY_EVENTS, rectangle_moved_above
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.widgets.box_layouts import arrange_row, row_layout
from apd_viewer.ui.widgets.theme import ICON_SIZE, LIGHT, Theme, icon
from apd_viewer.ui.widgets.wheel import block_mouse_events

_MARGIN = 12
_ABOVE = 68  # px from the bottom of the canvas: above a hint of one line, which comes and goes
_LONGEST_NAME = 240  # px; longer names are elided
_NARROWEST = 120  # px; smallest width of the text
_BESIDE_WORDS = 80  # px; icon and margins beside the text, if the buttons are below


class RecoveryBar(QFrame):
    """Bar offering recovered sessions, newest first, until one is restored.

    Parameters
    ----------
    canvas : Viewport
    hint : QWidget
        At the bottom of the canvas, not to be covered.

    Attributes
    ----------
    restore_requested : Signal(Leftover)
    """

    restore_requested = Signal(object)

    def __init__(self, canvas: Viewport, hint: QWidget) -> None:
        super().__init__(canvas)
        block_mouse_events(self)
        self._canvas, self._hint = canvas, hint
        self._waiting: list[RecoveryFile] = []
        self._at = 0  # index of the recovered session on offer
        self.setObjectName("notice")
        self._symbol = QLabel()
        self._text = QLabel(wordWrap=True, textFormat=Qt.TextFormat.PlainText)
        self.restore = self._button(
            tr("Restore"), tr("Restore the unsaved work as one step that can be undone"), self._restore
        )
        self.restore.setObjectName("primary")
        self.discard = self._button(tr("Discard"), tr("Delete the unsaved work permanently"), self._discard)
        self.next = QToolButton(
            accessibleName=trc("unsaved work", "Next"),
            toolTip=tr("Show the next unsaved work"),
            iconSize=ICON_SIZE,
        )
        self.next.clicked.connect(self._show_next)
        self.later = QToolButton(
            accessibleName=tr("Not now"), toolTip=tr("Ask at the next start"), iconSize=ICON_SIZE
        )
        self.later.clicked.connect(self.postpone_all)
        self._buttons = self.restore, self.discard, self.next, self.later
        words, answers = row_layout(self._symbol, self._text), row_layout(*self._buttons)
        self._row = row_layout(words, answers, margins=(12, 8, 8, 8), parent=self)
        for button in self._buttons:
            # A focused button that is hidden would pass its focus to a text field.
            button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.set_theme(LIGHT)
        self.hide()
        canvas.resized.connect(self._place)
        hint.installEventFilter(self)

    def eventFilter(self, _: QObject, event: QEvent) -> bool:
        """Reposition when the hint changes."""
        if event.type() in GEOMETRY_EVENTS:
            self._place()
        return False

    def _button(self, text: str, tip: str, pressed: Callable[[], None]) -> QPushButton:
        return QPushButton(text, toolTip=tip, clicked=pressed)

    @property
    def text(self) -> str:
        """Text of the current offer; empty if there is none."""
        return self._text.text() if not self.isHidden() else ""

    def offer(self, recovery_files: list[RecoveryFile]) -> None:
        """Offer recovered sessions locked for this window."""
        self._waiting = recovery_files
        self._show(0)

    def follow_session(self, session: Session) -> None:
        """Hide once the offer is accepted; disable the buttons while a job runs."""
        for button in self._buttons:
            button.setEnabled(session.jobs.current is None)
        if self._waiting and self._waiting[self._at].is_restored:
            del self._waiting[self._at]
            self.postpone_all()

    def postpone_all(self) -> None:
        """Unlock the remaining sessions, to be offered at the next start."""
        for left in self._waiting:
            left.release()
        self._waiting.clear()
        self.hide()

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        self.later.setIcon(icon("cancel", theme))
        self.next.setIcon(icon("folded", theme))
        self._symbol.setPixmap(icon("history", theme).pixmap(ICON_SIZE, self.devicePixelRatioF()))

    def _restore(self) -> None:
        self.restore_requested.emit(self._waiting[self._at])

    def _discard(self) -> None:
        self._waiting.pop(self._at).discard()
        self._show(self._at)

    def _show_next(self) -> None:
        self._show(self._at + 1)

    def _show(self, at: int) -> None:
        n = len(self._waiting)
        self.setVisible(n > 0)
        if n > 0:
            self._at = at % n
            left = self._waiting[self._at]
            name = self.fontMetrics().elidedText(left.name, Qt.TextElideMode.ElideMiddle, _LONGEST_NAME)
            said = (
                tr("Unsaved work {k} of {n}: {name}, {when}") if n > 1 else tr("Unsaved work: {name}, {when}")
            )
            self._text.setText(said.format(k=self._at + 1, n=n, name=name, when=age_text(left.time)))
            self.next.setVisible(n > 1)
            self.raise_()
            self._place()

    def _place(self) -> None:
        if self.isHidden():
            return
        canvas, text = self._canvas, self._text
        text.setFixedWidth(_NARROWEST)
        room = canvas.width() - 2 * _MARGIN
        beside = arrange_row(self._row, room - 2)
        words = max(_NARROWEST, room - (self.sizeHint().width() - _NARROWEST if beside else _BESIDE_WORDS))
        text.setFixedWidth(min(words, text.fontMetrics().horizontalAdvance(text.text()) + 4))
        self._row.activate()
        self.adjustSize()
        corner = QPoint((canvas.width() - self.width()) // 2, canvas.height() - self.height() - _ABOVE)
        self.move(rectangle_moved_above(QRect(corner, self.size()), [self._hint]).topLeft())
