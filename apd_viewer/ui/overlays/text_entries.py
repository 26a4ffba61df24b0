"""Text entries over the canvas: vertices, brush size, pivot."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QFrame, QLabel, QLineEdit

from apd_viewer.errors import InputError
from apd_viewer.language import tr, trn
from apd_viewer.presentation.number_format import format_editable
from apd_viewer.session.session import Session
from apd_viewer.ui.overlays.card_stack import free_span
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.active_parts import ActiveParts
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.tools.selection_tool import StrokeEffect, stroke_effect
from apd_viewer.ui.widgets.box_layouts import column_layout, row_layout
from apd_viewer.ui.widgets.wheel import block_mouse_events

_PIXELS = "px"


class TextEntries:
    """Three entry cards, at most one of them open.

    Parameters
    ----------
    cancel_drag : callable
        Function to cancel the current drag; True if there was one.
    """

    def __init__(
        self, canvas: Canvas, session: Session, parts: ActiveParts, cancel_drag: Callable[[], bool]
    ) -> None:
        self._canvas, self._session, self._parts = canvas, session, parts
        self._give_up = cancel_drag
        self.vertices = TextEntryCard(
            canvas.viewport,
            tr("Select by ID or expression"),
            tr("IDs or conditions of the vertices to select"),
            tr("y > 80% and x < 0      or IDs: 3, 10-20"),
            tr("Enter adds, Alt+Enter removes, Ctrl+Enter replaces, Esc closes."),
        )
        self.brush = TextEntryCard(
            canvas.viewport,
            tr("Brush size"),
            tr("Brush radius"),
            tr("24px      or 5mm, 0.05L"),
            tr("Pixels refer to the screen, lengths to the mesh. Enter applies, Esc closes."),
        )
        self.pivot = TextEntryCard(
            canvas.viewport,
            tr("Pivot at"),
            tr("Coordinates of the pivot"),
            tr("0, 0.5Y, 12mm"),
            tr("Three coordinates, separated by commas. Enter applies, Esc closes."),
        )
        self.vertices.text_changed.connect(self._preview)
        self.vertices.text_entered.connect(self._choose)
        self.vertices.closed.connect(lambda: canvas.preview_selection(None))
        self.brush.text_changed.connect(lambda text: self._parse_or_explain(self.brush, text, self._radius))
        self.brush.text_entered.connect(self._take_brush)
        self.pivot.text_changed.connect(self._show_pivot)
        self.pivot.text_entered.connect(self._take_pivot)
        self.pivot.closed.connect(lambda: self._mark(None))

    @property
    def cards(self) -> tuple[TextEntryCard, ...]:
        """All three entry cards."""
        return self.vertices, self.brush, self.pivot

    def open_entry(self, card: TextEntryCard) -> None:
        """Show a card and hide the others."""
        if self._session.store.state is not None:
            self.close()
            card.open_card()

    def close(self) -> bool:
        """Close the open card; True if there was one."""
        shown = [card for card in self.cards if not card.isHidden()]
        for card in shown:
            card.close_card()
        return bool(shown)

    def _parse_or_explain(self, card: TextEntryCard, text: str, read: Callable[[str], object]) -> object:
        """Parse a text; None if it is invalid, with the error on the card."""
        if self._session.store.state is None:
            return None
        try:
            meant = read(text)
        except InputError as error:
            card.show_message(str(error) if text else "")
            return None
        card.show_message("")
        return meant

    # Vertex entry

    def _preview(self, text: str) -> None:
        ids = self._parse_or_explain(self.vertices, text, self._session.typed_values.parse_vertices)
        self._canvas.preview_selection(ids if isinstance(ids, np.ndarray) else None)
        if isinstance(ids, np.ndarray):
            said = trn("{n:,} vertex.", "{n:,} vertices.", len(ids)).format(n=len(ids))
            self.vertices.show_message(f"{said} {self.vertices.help}")

    def _choose(self, text: str, act: StrokeEffect) -> None:
        ids = self._parse_or_explain(self.vertices, text, self._session.typed_values.parse_vertices)
        if isinstance(ids, np.ndarray) and not self._give_up():
            self.vertices.close_card()  # so that the next key is a command, not text
            self._canvas.strokes.paint_vertices(ids, act)

    # Brush entry

    def open_brush_entry(self) -> None:
        """Open the brush card with the current radius."""
        size = self._canvas.brush.size
        length = (
            None
            if size.mesh_radius is None
            else f"{format_editable(size.mesh_radius, 4)}{self._session.store.unit.symbol}"
        )
        self.brush.text.setText(length or f"{size.radius:.0f}{_PIXELS}")
        self.open_entry(self.brush)

    def _radius(self, text: str) -> tuple[float, bool]:
        """The radius, and whether it is in pixels."""
        pixels = text.strip().lower().endswith(_PIXELS)
        if not pixels:
            radius = self._session.typed_values.parse_length(text)
        else:
            try:
                radius = float(text.strip()[: -len(_PIXELS)].replace(",", "."))
            except ValueError:
                problem = tr("“{text}” is not a number of pixels; enter one such as 24px.")
                raise InputError(problem.format(text=text)) from None
        if not 0.0 < radius < np.inf:
            raise InputError(tr("Enter a brush radius greater than 0, such as 24px or 0.05L."))
        return radius, pixels

    def _take_brush(self, text: str, _: StrokeEffect) -> None:
        meant = self._parse_or_explain(self.brush, text, self._radius)
        if isinstance(meant, tuple):
            radius, pixels = meant
            if pixels:
                self._canvas.brush.size.radius = radius
            else:
                self._canvas.brush.size.mesh_radius = radius
            self.brush.close_card()

    # Pivot entry

    def _show_pivot(self, text: str) -> None:
        self._mark(self._parse_or_explain(self.pivot, text, self._session.typed_values.parse_point))

    def _take_pivot(self, text: str, _: StrokeEffect) -> None:
        point = self._parse_or_explain(self.pivot, text, self._session.typed_values.parse_point)
        if isinstance(point, np.ndarray) and not self._give_up():
            self._session.handles.set_pivot(point, self._parts.handle)
            self.pivot.close_card()

    def _mark(self, point: object) -> None:
        self._canvas.picker.marked_points = point[None] if isinstance(point, np.ndarray) else np.empty((0, 3))


_WIDTH = 480
_MARGIN = 12


class TextEntryCard(QFrame):
    """Card with a text field and a live preview.

    Parameters
    ----------
    title, name, example : str
        Label of the field, its accessible name, and an example of its text.
    help : str
        Usage, shown without any other message.

    Attributes
    ----------
    text_changed : Signal(str)
        The text has changed.
    text_entered : Signal(str, object)
        The text, and the Act.
    message_label : QLabel
        Meaning of the text, or its error.
    """

    text_changed = Signal(str)
    text_entered = Signal(str, object)
    closed = Signal()

    def __init__(self, canvas: Viewport, title: str, name: str, example: str, help: str) -> None:  # noqa: A002
        super().__init__(canvas, objectName="notice")
        block_mouse_events(self)
        self._canvas = canvas
        self.help = help
        self.text = _Line(objectName="typed", placeholderText=example, accessibleName=name)
        self.text.textChanged.connect(self.text_changed)
        self.text.entered.connect(lambda act: self.text_entered.emit(self.text.text(), act))
        self.text.left.connect(self.close_card)
        plain = Qt.TextFormat.PlainText
        self.message_label = QLabel(help, objectName="quiet", wordWrap=True, textFormat=plain)
        line = row_layout(QLabel(title), (self.text, 1))
        self._column = column_layout(
            line, self.message_label, spacing=6, margins=(12, 10, 12, 10), parent=self
        )
        canvas.resized.connect(self._place)
        self.hide()

    def open_card(self) -> None:
        """Show the card and focus its text field."""
        self.show()
        self._place()
        self.raise_()
        self.text.setFocus(Qt.FocusReason.ShortcutFocusReason)
        self.text.selectAll()
        self.text_changed.emit(self.text.text())

    def close_card(self) -> None:
        """Hide the card and return the focus to the canvas."""
        self.hide()
        self._canvas.setFocus()
        self.closed.emit()

    def show_message(self, sentence: str) -> None:
        """Show a result or an error; an empty sentence shows the usage."""
        self.message_label.setText(sentence or self.help)
        self._place()

    def _place(self) -> None:
        start, span = free_span(self._canvas)
        self.setFixedWidth(min(_WIDTH, span - 2 * _MARGIN))
        # heightForWidth() would return at least the minimum height set for the previous text.
        self.message_label.setMinimumHeight(0)
        edges = self._column.contentsMargins()
        self.message_label.setFixedHeight(
            self.message_label.heightForWidth(self.width() - edges.left() - edges.right())
        )
        self._column.activate()
        self.adjustSize()
        self.move(start + (span - self.width()) // 2, self._canvas.height() - self.height() - 64)


class _Line(QLineEdit):
    entered = Signal(object)
    left = Signal()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Accept on Return, close on Esc."""
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.entered.emit(stroke_effect(event))
        elif event.key() == Qt.Key.Key_Escape:
            self.left.emit()
        else:
            super().keyPressEvent(event)
