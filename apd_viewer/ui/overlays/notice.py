"""Messages, hints and empty state over the canvas, none of them modal."""

import logging
import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from PySide6.QtCore import QEvent, QObject, QPoint, QRect, Qt, QTimer, QUrl, Signal
from PySide6.QtGui import QAction, QDesktopServices, QHideEvent, QShowEvent
from PySide6.QtWidgets import QFrame, QLabel, QPushButton, QSizePolicy, QToolButton, QWidget

from apd_viewer.files.samples import SAMPLES
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.named_obstacle import ObstacleKind
from apd_viewer.session.state_store import StateStore
from apd_viewer.ui.filing.file_requests import FileRequests
from apd_viewer.ui.overlays.card_stack import (
    GEOMETRY_EVENTS,
    covers_framed_mesh,
    free_span,
    rectangle_moved_above,
    span_beside_mesh,
)
from apd_viewer.ui.preferences.shortcuts import text_with_keys
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.tool_modes import Tool
from apd_viewer.ui.widgets.box_layouts import arrange_row, column_layout, row_layout
from apd_viewer.ui.widgets.theme import ICON_SIZE, LIGHT, Theme, icon, set_style_property

_LOGGER = logging.getLogger(__name__)
_MARGIN = 12
_WIDEST = 480
_CLOSE = 34  # px: size of a notice's close button
SECTION_PROPERTY = "manualSection"  # property that names the manual section of a detached widget
_UNBOUNDED = 16_777_215  # QWIDGETSIZE_MAX, Qt's largest widget size
_INVITATION_PADDING = 20
_NARROWEST = 104  # px: smallest width of a sentence
_AROUND_TEXT = 80  # px beside the sentence of a notice
_LEAST_SPAN = _NARROWEST + _AROUND_TEXT + 2 * _MARGIN  # px; for a notice
_READING_TIME = 7000  # ms a message is shown; failures stay until dismissed


class Notice(QFrame):
    """Message at the bottom of the canvas; except its buttons, it ignores clicks.

    Parameters
    ----------
    below : sequence of QWidget
        Widgets at the bottom of the canvas, not to be covered.

    Attributes
    ----------
    open_file, show_folder : QPushButton
        Buttons for the file of the message; hidden without one.
    timer : QTimer
        Hides a message once it can have been read.
    file_offered : Signal
        The path of a file that was written.
    """

    file_offered = Signal(Path)

    def __init__(self, canvas: Viewport, below: Sequence[QWidget]) -> None:
        super().__init__(canvas)
        self._canvas = canvas
        self._below = list[QWidget]()
        self._theme = LIGHT
        self.setObjectName("notice")
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self._text = QLabel(wordWrap=True, textFormat=Qt.TextFormat.PlainText)
        self._symbol = QLabel()
        # A child of the canvas, as the notice itself is transparent to the mouse.
        self.close_button = QToolButton(
            canvas, accessibleName=tr("Dismiss message"), toolTip=tr("Dismiss"), iconSize=ICON_SIZE
        )
        self.close_button.setProperty(SECTION_PROPERTY, type(self).__name__)
        self.close_button.clicked.connect(self.hide)
        self._file, self._has_offer = Path(), False
        self._buttons = self._make_buttons(canvas)
        self._accept: Callable[[], object] = lambda: None
        self._row = row_layout(self._symbol, (self._text, 1), margins=(12, 8, 8 + _CLOSE, 8), parent=self)
        self.timer = QTimer(self, singleShot=True, interval=_READING_TIME, timeout=self.hide)
        self._kind = "message"
        self._held = ""
        self.hide()
        self.keep_above(below)
        canvas.resized.connect(self._place)
        canvas.camera_controller.on_framed.append(self._place)

    def _make_buttons(self, canvas: Viewport) -> QWidget:
        buttons = QWidget(canvas)
        self.open_file = QPushButton(tr("Open"), toolTip=tr("Open the file with the program for it"))
        self.show_folder = QPushButton(tr("Show in folder"), toolTip=tr("Open the folder of the file"))
        self.open_file.clicked.connect(lambda: _open_with_system(self._file))
        self.show_folder.clicked.connect(lambda: _open_with_system(self._file.parent))
        self.accept = QPushButton("")
        self.accept.clicked.connect(self.hide)
        self.accept.clicked.connect(lambda: self._accept())
        for button in (self.open_file, self.show_folder, self.accept):
            button.setProperty(SECTION_PROPERTY, type(self).__name__)
        row_layout(self.open_file, self.show_folder, self.accept, parent=buttons)
        buttons.hide()
        return buttons

    def keep_above(self, others: Sequence[QWidget]) -> None:
        """Leave room for widgets at the bottom of the canvas."""
        self._below += others
        for other in others:
            other.installEventFilter(self)

    def eventFilter(self, _: QObject, event: QEvent) -> bool:
        """Reposition when other widgets of the canvas change."""
        if event.type() in GEOMETRY_EVENTS:
            self._place()
        return False

    def hideEvent(self, event: QHideEvent) -> None:
        """Hide the buttons too."""
        super().hideEvent(event)
        self.close_button.hide()
        self._buttons.hide()

    @property
    def text(self) -> str:
        """Current sentence; empty if hidden."""
        return self._text.text() if not self.isHidden() else ""

    def show_message(self, sentence: str, file: Path | None = None) -> None:
        """Show a message for a few seconds, with an offer to open its ``file``."""
        self._show(sentence, "message")
        self.timer.start()
        if file is not None:
            self.offer_file(file)

    def offer_file(self, path: Path) -> None:
        """Offer to open the file of the current message, or its folder."""
        self._file = path
        self._offer_buttons(self.open_file, self.show_folder)
        self.file_offered.emit(path)

    def offer(self, sentence: str, title: str, accept: Callable[[], object]) -> None:
        """Show a proposal until it is dismissed or accepted by a button with a ``title``."""
        self._show(sentence, "message")
        self.timer.stop()
        self._accept = accept
        self.accept.setText(title)
        self._offer_buttons(self.accept)

    def _offer_buttons(self, *offered: QPushButton) -> None:
        for button in (self.open_file, self.show_folder, self.accept):
            button.setVisible(button in offered)
        self._has_offer = True
        self._place()
        self._buttons.raise_()

    def show_failure(self, sentence: str) -> None:
        """Show and log a failure until dismissed or replaced."""
        _LOGGER.warning(sentence)
        self._show(sentence, "failure")
        self.timer.stop()

    def show_persistent_failure(self, sentence: str) -> None:
        """Show a failure until cleared by an empty sentence."""
        if sentence == self._held:
            return
        before, self._held = self._held, sentence
        if sentence:
            self.show_failure(sentence)
        elif self.text == before:
            self.hide()

    def dismiss_failure(self) -> bool:
        """Hide the current failure; True if there was one."""
        shown = not self.isHidden() and self._kind == "failure"
        if shown:
            self.hide()
        return shown

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        self._theme = theme
        self.close_button.setIcon(icon("cancel", theme))
        self._draw_symbol()

    def _show(self, sentence: str, kind: str) -> None:
        self._kind = kind
        self._text.setText(sentence)
        set_style_property(self, "kind", kind)
        self._draw_symbol()
        self._has_offer = False
        self.show()
        self.close_button.show()
        self.raise_()
        self.close_button.raise_()
        self._place()

    def _draw_symbol(self) -> None:
        name = "warning" if self._kind == "failure" else "info"
        self._symbol.setPixmap(icon(name, self._theme).pixmap(ICON_SIZE, self.devicePixelRatioF()))

    def _place(self) -> None:
        if self.isHidden():
            return
        self._place_in(*free_span(self._canvas))
        beside = span_beside_mesh(self._canvas)
        if beside[1] >= _LEAST_SPAN and covers_framed_mesh(self.geometry(), self._canvas):
            self._place_in(*beside)

    def _place_in(self, start: int, span: int) -> None:
        """Place the notice in a part of the canvas."""
        canvas, buttons = self._canvas, self._buttons
        room = span - 2 * _MARGIN - _AROUND_TEXT
        buttons.setVisible(self._has_offer and room - buttons.sizeHint().width() >= _NARROWEST)
        buttons.adjustSize()
        aside = 0 if buttons.isHidden() else buttons.width() + 8
        self._row.setContentsMargins(12, 8, 8 + _CLOSE + aside, 8)
        room = max(_NARROWEST, min(_WIDEST, room - aside))
        width = min(room, self._text.fontMetrics().horizontalAdvance(self._text.text()) + 4)
        self._text.setMinimumSize(0, 0)  # heightForWidth() returns at least the minimum height
        self._text.setMaximumSize(_UNBOUNDED, _UNBOUNDED)
        self._text.setFixedSize(width, self._text.heightForWidth(width))
        self._row.activate()
        self.adjustSize()
        left = start + (span - self.width()) // 2
        place = QRect(QPoint(left, canvas.height() - self.height() - 2 * _MARGIN), self.size())
        self.setGeometry(rectangle_moved_above(place, self._below))
        self.close_button.setFixedSize(_CLOSE, _CLOSE)
        beside = self.geometry().right() - _CLOSE - 4
        middle = self.geometry().center().y()
        self.close_button.move(beside, middle - _CLOSE // 2)
        buttons.move(beside - aside, middle - buttons.height() // 2)


def _open_with_system(path: Path) -> None:
    QDesktopServices.openUrl(QUrl.fromLocalFile(str(path)))


class CanvasHint(QLabel):
    """Hint at the bottom of the canvas.

    It is beside a framed mesh that it would cover. Where no room is left there, it covers the mesh, or is
    dropped where that is to be spared.
    """

    def __init__(self, canvas: Viewport) -> None:
        plain = Qt.TextFormat.PlainText
        super().__init__(canvas, wordWrap=True, textFormat=plain, alignment=Qt.AlignmentFlag.AlignCenter)
        self._canvas = canvas
        self.setObjectName("invitation")
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.hide()
        canvas.resized.connect(self._place)
        canvas.camera_controller.on_framed.append(self._place)

    def show_text(self, sentence: str) -> None:
        """Show ``sentence``; hide if empty."""
        self.setText(sentence)
        self._place()

    def _place(self) -> None:
        if not self.text():
            self.hide()
            return
        whole, beside = free_span(self._canvas), span_beside_mesh(self._canvas)
        self._place_in(*whole)
        covers = covers_framed_mesh(self.geometry(), self._canvas)
        if covers and beside[1] >= _NARROWEST + 2 * _MARGIN:
            self._place_in(*beside)
            covers = covers_framed_mesh(self.geometry(), self._canvas)
        if covers and not self._canvas.spares_mesh:
            self._place_in(*whole)
        self.setVisible(not (covers and self._canvas.spares_mesh))

    def _place_in(self, start: int, span: int) -> None:
        """Place the hint in a part of the canvas."""
        words = self.fontMetrics().horizontalAdvance(self.text())
        width = max(_NARROWEST, min(words + 2 * _INVITATION_PADDING, span - 2 * _MARGIN))
        self.setMinimumSize(0, 0)  # heightForWidth() returns at least the minimum height
        self.setFixedSize(width, self.heightForWidth(width))
        self.move(start + (span - width) // 2, self._canvas.height() - self.height() - 2 * _MARGIN)


class EmptyState(QWidget):
    """Empty state of the canvas, with buttons to open a mesh."""

    def __init__(self, canvas: Viewport, requests: FileRequests) -> None:
        super().__init__(canvas)
        self._canvas = canvas
        self.setObjectName("empty")
        title = QLabel(tr("Drop a mesh here or open one"), alignment=Qt.AlignmentFlag.AlignCenter)
        self.open = QPushButton(tr("Open mesh…"), objectName="primary", clicked=requests.ask_for_file)
        self.samples = [
            QPushButton(sample.title, toolTip=sample.tip, clicked=partial(requests.open_sample, name))
            for name, sample in SAMPLES.items()
        ]
        for button in (self.open, *self.samples):
            button.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        centre = Qt.AlignmentFlag.AlignHCenter
        self._row = row_layout(*((button, 0, centre) for button in (self.open, *self.samples)), spacing=-1)
        column_layout(title, self._row, spacing=12, margins=None, parent=self)
        self.hide()
        canvas.resized.connect(self._place)

    def showEvent(self, event: QShowEvent) -> None:
        """Centre the widget on the canvas."""
        super().showEvent(event)
        self._place()

    def _place(self) -> None:
        canvas = self._canvas
        arrange_row(self._row, canvas.width() - 2 * _MARGIN)
        self.adjustSize()
        self.move((canvas.width() - self.width()) // 2, (canvas.height() - self.height()) // 2)


_TWIST = tr("Drag a ring to rotate, an arrow to move")
_PUSH = tr("Drag an arrow of the obstacle, or enter a distance, to push the surface")
_PUSH_PLATE = tr(
    "Drag the arrow of the plate, or enter a distance, to push the surface; "
    "turn the view where the arrow points at you"
)
_FILLED = tr("The base is enough: volume or pressure moves the rest")
_SELECT = tr("Click an obstacle to move it")
_WAITS = tr("Preview: the surface follows once enough is compiled for this computer ({percent} %)")


class NextStepHint:
    """Chooses the hint about the user's next step.

    Parameters
    ----------
    tools : mapping of Tool to QAction
        Whose keys are named.

    Attributes
    ----------
    has_moved : bool
        Whether something has been dragged since the window was opened.
    """

    def __init__(self, invitation: CanvasHint, tools: Mapping[Tool, QAction]) -> None:
        self._invitation = invitation
        self._tools = tools
        self.has_moved = False
        self._waits = ""
        self._asked: tuple[Document, Tool, int, int | None] | None = None
        for action in tools.values():
            action.changed.connect(self._refresh_shortcuts)

    def record_drag(self) -> None:
        """Record a drag and hide the hint; no more hints are needed."""
        self.has_moved = True
        self.hide_hint()

    def hide_hint(self) -> None:
        """Hide the next step; a preview message stays visible."""
        self._invitation.show_text(self._waits)

    def follow_store(self, store: StateStore) -> None:
        """Show a message while the store is previewing."""
        waits = ""
        if store.is_previewing:
            waits = _WAITS.format(percent=math.floor(100.0 * (store.compiled_fraction or 0.0)))
        if waits != self._waits:
            self._waits = waits
            self.hide_hint()

    def show_hint(self, document: Document, tool: Tool, handle: int, obstacle: int | None) -> None:
        """Show the next step for the tool, the active handle and the active obstacle."""
        self._asked = document, tool, handle, obstacle
        self._invitation.show_text(self._waits or self._sentence(*self._asked))

    def _refresh_shortcuts(self) -> None:
        """Update the shortcuts named in the visible hint."""
        if self._asked is not None and not self._invitation.isHidden():
            self._invitation.show_text(self._waits or self._sentence(*self._asked))

    def _sentence(self, document: Document, tool: Tool, handle: int, obstacle: int | None) -> str:
        if document.has_active_obstacles and not tool.traits.is_brush:
            nothing_held = not document.label_counts[BASE] and not document.label_counts[HANDLE:].any()
            if obstacle is not None or nothing_held:  # moving obstacles needs no painted base or handle
                return self._obstacle_hint(document, tool, obstacle)
        if own := _hint_of_tool(document, tool):
            return own
        if not document.label_counts[BASE]:
            return text_with_keys(tr("Paint the part that stays in place: the base"), self._tools[Tool.BASE])
        needs_no_handle = document.settings.effective_settings.is_filled
        has_handle = document.label_counts[HANDLE:].any()
        if not has_handle and not needs_no_handle:
            return text_with_keys(tr("Now paint the part to move: the handle"), self._tools[Tool.HANDLE])
        if document.paint_problem:
            return document.paint_problem
        if not has_handle:
            return _FILLED if tool.traits.is_brush else ""
        if not document.label_counts[HANDLE + handle]:
            name = document.handles[handle].name
            return text_with_keys(
                tr("Paint the part that “{name}” moves").format(name=name), self._tools[Tool.HANDLE]
            )
        if self.has_moved or document.relative_to_rest.is_posed:
            return ""
        return (
            _TWIST if tool is Tool.MOVE else text_with_keys(tr("Now move the handle"), self._tools[Tool.MOVE])
        )

    def _obstacle_hint(self, document: Document, tool: Tool, obstacle: int | None) -> str:
        if self.has_moved or any(each.shift.any() for each in document.obstacles):
            return ""
        if tool is not Tool.MOVE:
            return text_with_keys(tr("Now move an obstacle"), self._tools[Tool.MOVE])
        if obstacle is None:
            return _SELECT
        return _PUSH_PLATE if document.obstacles[obstacle].kind is ObstacleKind.PLATE else _PUSH


def _hint_of_tool(document: Document, tool: Tool) -> str:
    """Hint about what the tool in hand paints, as long as there is nothing of it."""
    if tool is Tool.HANDLE and not document.label_counts[HANDLE:].any():
        return tr("Paint the part to move: the handle")
    if tool is Tool.REGION and not document.member.any():
        return tr("Paint a part to measure or keep its area")
    return ""


def may_change_next_step(before: Document, after: Document) -> bool:
    """True if a change of the document may affect the next step."""
    same = before.labels is after.labels and before.obstacles is after.obstacles
    same &= before.paint_problem == after.paint_problem
    return not same or before.relative_to_rest.is_posed != after.relative_to_rest.is_posed
