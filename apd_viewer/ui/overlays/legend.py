"""Legend of an overlay, with its editable scale."""

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QImage, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QFrame, QGridLayout, QLabel, QPushButton, QSizePolicy, QWidget

from apd_viewer.language import tr
from apd_viewer.presentation.scales import Measure, Scale
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.widgets.box_layouts import column_layout, row_layout
from apd_viewer.ui.widgets.fields import ComboBox, NumberField, small_button
from apd_viewer.ui.widgets.theme import LIGHT, Theme, icon
from apd_viewer.ui.widgets.wheel import block_mouse_events

# Limits of the fields; lengths and curvatures depend on the mesh unit, which can be any.
_DECIMALS, _LEAST = 30, 1e-30


class Legend(QFrame):
    """Legend card: title, scale, value under the cursor and extremes.

    Attributes
    ----------
    measure_chosen : Signal(object)
        A Measure, or None by the cross.
    scale_changed : Signal(float, float)
        The end of the scale and what counts for no change, as :class:`Scale` has them.
    """

    measure_chosen = Signal(object)
    scale_changed = Signal(float, float)
    fit_requested = Signal()
    extreme_requested = Signal()

    def __init__(self) -> None:
        super().__init__(objectName="card", accessibleName=tr("Overlay"))
        block_mouse_events(self)
        self._scale = Scale(Measure.AREA, 0.1, 0.001)
        self._unit = Unit.NONE
        self._theme = LIGHT
        self._least, self._most = 10_000, 10_000  # px: height if folded automatically; available height
        self._unfolded: bool | None = None  # the user's choice; None folds by the available height
        self._folded = False
        self._make_parts()
        self._lay_out()
        self.set_theme(LIGHT)
        self.hide()

    def _make_parts(self) -> None:
        self.choice = ComboBox(accessibleName=tr("Overlay"), toolTip=tr("Quantity shown in colour"))
        self.set_measures(tuple(Measure))
        self.choice.activated.connect(lambda k: self.measure_chosen.emit(self.choice.itemData(k)))
        self.close_button = small_button(tr("Hide overlay"), tr("Hide overlay"))
        self.close_button.clicked.connect(lambda: self.measure_chosen.emit(None))
        self.fold_button = small_button(tr("Fold legend"), tr("Show fewer or all lines of the legend"))
        self.fold_button.clicked.connect(self._toggle_lines)
        self.bar = LegendColorBar()
        self.note = QLabel(objectName="quiet", wordWrap=True)
        self.under_cursor, self.largest = QLabel(), QLabel()
        self.next_extreme = small_button(tr("Next extreme"), tr("Go to the next extreme"))
        self.next_extreme.clicked.connect(self.extreme_requested)
        tip = tr("Change at the ends of the scale, where the colours are strongest")
        self.reach = NumberField(brief=True, accessibleName=tr("Range"), toolTip=tip, decimals=_DECIMALS)
        tip = tr("Changes up to this value are shown as neutral")
        self.neutral = NumberField(brief=True, accessibleName=tr("Neutral"), toolTip=tip, decimals=_DECIMALS)
        for field in (self.reach, self.neutral):
            field.setFixedWidth(100)
            field.valueChanged.connect(self._enter)
        self.fit = QPushButton(
            tr("Fit"), toolTip=tr("Fit the scale to the largest change of the current shape")
        )
        self.fit.clicked.connect(self.fit_requested)
        for button in (self.fit, self.next_extreme, self.fold_button, self.close_button):
            button.setFocusPolicy(Qt.FocusPolicy.TabFocus)  # a click leaves the keyboard focus on the canvas

    def _lay_out(self) -> None:
        self._head: list[QWidget] = [self.choice, self.fold_button, self.close_button]
        head = row_layout((self.choice, 1), self.fold_button, self.close_button, spacing=4)
        self._rows = QGridLayout(horizontalSpacing=8, verticalSpacing=4)
        self._rows.setColumnStretch(1, 1)
        self._names: dict[QWidget, QLabel] = {}
        self._lines: list[list[QWidget]] = []
        right = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        for row, (text, value, button) in enumerate(
            (
                (tr("Under the cursor"), self.under_cursor, None),
                (tr("Largest"), self.largest, self.next_extreme),
                (tr("Range"), self.reach, self.fit),
                (tr("Neutral up to"), self.neutral, None),
            )
        ):
            self._names[value] = QLabel(text, objectName="quiet")
            self._rows.addWidget(self._names[value], row, 0)
            self._rows.addWidget(value, row, 1, right)
            if button is not None:
                self._rows.addWidget(button, row, 2, Qt.AlignmentFlag.AlignCenter)
            self._lines.append([w for w in (self._names[value], value, button) if w is not None])
        self._column = column_layout(
            head, self.bar, self.note, self._rows, spacing=8, margins=(12, 10, 12, 10), parent=self
        )

    # Display

    def set_measures(self, measures: tuple[Measure, ...]) -> None:
        """Set the measures offered in the combo box."""
        self._offered, shown = measures, self._scale.measure
        self.choice.clear()
        for measure in measures:
            self.choice.addItem(measure.traits.title, measure)
        if shown in measures:
            self.choice.setCurrentIndex(measures.index(shown))

    def show_scale(self, scale: Scale, unit: Unit) -> None:
        """Display a scale with values in ``unit``."""
        self._scale, self._unit = scale, unit
        self.choice.setCurrentIndex(self._offered.index(scale.measure))
        self.choice.setToolTip(scale.measure.traits.tip)
        self.bar.show_scale(scale, unit)
        kind = scale.measure.traits.kind
        for field, value, least in ((self.reach, scale.reach, _LEAST), (self.neutral, scale.neutral, 0.0)):
            field.blockSignals(True)
            field.setRange(least, 1.0 / _LEAST)
            field.setSuffix(kind.suffix(unit))
            field.setValue(kind.factor * value)
            field.blockSignals(False)
        self._show_lines()
        self.show()

    def fit_into(self, least: int, most: int) -> None:
        """Hide the last lines as needed for a height, see :meth:`CardStack.add`."""
        self._least, self._most = least, most
        self._show_lines()

    def _toggle_lines(self) -> None:
        """Toggle between all lines and none."""
        self._unfolded = any(line[0].isHidden() for line in self._lines if self._is_wanted(line))
        self._show_lines()

    def _is_wanted(self, line: list[QWidget]) -> bool:
        return self._scale.measure.is_signed or self.neutral not in line

    def _show_lines(self) -> None:
        room = {None: self._least, True: self._most, False: 0}[self._unfolded]
        # Sum the parts; the overall size hint depends on hidden lines and would oscillate.
        margins = self._column.contentsMargins()
        above: list[list[QWidget]] = [self._head, [self.bar]]
        if not self.note.isHidden():
            above.append([self.note])
        height = margins.top() + margins.bottom() + sum(self._height(line) for line in above)
        for line in self._lines:
            wanted = self._is_wanted(line)
            height += self._height(line) if wanted else 0
            for widget in line:
                if widget.isHidden() == (wanted and height <= room):
                    widget.setVisible(widget.isHidden())
        folded = any(line[0].isHidden() for line in self._lines if self._is_wanted(line))
        if folded != self._folded:  # setting an icon triggers another layout, so only on change
            self._folded = folded
            self._draw_fold()

    def _draw_fold(self) -> None:
        self.fold_button.setIcon(icon("folded" if self._folded else "unfolded", self._theme))

    def _height(self, line: list[QWidget]) -> int:
        return max(widget.sizeHint().height() for widget in line) + self._column.spacing()

    def show_values(self, span: tuple[float, float] | None, value: float | None) -> None:
        """Show smallest, largest and current value; None hides them."""
        self.bar.show_values(span, value)
        written = "–" if value is None else self._scale.format_value(value, self._unit)
        largest = (
            "–" if span is None else self._scale.format_value(self._scale.largest_change(span), self._unit)
        )
        for label, text in ((self.under_cursor, written), (self.largest, largest)):
            if label.text() != text:
                label.setText(text)
        self.next_extreme.setEnabled(span is not None)
        self.fit.setEnabled(span is not None)

    def show_note(self, note: str) -> None:
        """Show the reason for missing colours; hide the note if empty."""
        if note != self.note.text() or self.note.isHidden() == bool(note):
            self.note.setText(note)
            self.note.setVisible(bool(note))

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        self._theme = theme
        self._draw_fold()
        self.close_button.setIcon(icon("cancel", theme))
        self.next_extreme.setIcon(icon("worst", theme))

    def _enter(self) -> None:
        factor = self._scale.measure.traits.kind.factor
        self.scale_changed.emit(self.reach.value() / factor, self.neutral.value() / factor)


_STEPS = 256
_TALL, _SPAN, _TICK = 14, 3, 7  # px: height of the colour bar, gap to the range line below, and tick length


class LegendColorBar(QWidget):
    """Colour bar, labelled at its ends and at zero, with a tick at one value.

    A line below the colours spans the values of the shape, within the scale.

    Attributes
    ----------
    value : float or None
        Under the cursor.
    """

    def __init__(self) -> None:
        super().__init__(accessibleName=tr("Overlay colours"))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self._scale = Scale(Measure.AREA, 0.1)
        self._unit = Unit.NONE
        self._span: tuple[float, float] | None = None
        self.value: float | None = None
        self._colors = QImage()

    def show_scale(self, scale: Scale, unit: Unit) -> None:
        """Display the colours of a scale with values in ``unit``."""
        self._scale, self._unit = scale, unit
        self._colors = scale_image(scale)
        self.update()

    def show_values(self, span: tuple[float, float] | None, value: float | None) -> None:
        """Show smallest, largest and current value; None hides them."""
        if (span, value) != (self._span, self.value):
            self._span, self.value = span, value
            self.update()

    @property
    def labels(self) -> tuple[tuple[float, str], ...]:
        """Label positions, from 0 to 1, and texts."""
        scale = self._scale
        return tuple((scale.position(x), scale.format_value(x, self._unit)) for x in scale.tick_values)

    def sizeHint(self) -> QSize:
        """Height of the tick, the colours, the range line and the labels."""
        return QSize(200, _TICK + _TALL + 2 * _SPAN + self.fontMetrics().height() + 2)

    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw the colours, the range line, the tick and the labels."""
        painter = QPainter(self)
        painter.setRenderHints(QPainter.RenderHint.Antialiasing | QPainter.RenderHint.SmoothPixmapTransform)
        palette, wide = self.palette(), float(self.width())
        bar = QRectF(0.5, _TICK, wide - 1.0, _TALL)
        painter.drawImage(bar, self._colors)
        painter.setPen(QPen(palette.mid().color(), 1.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(bar)
        ink = palette.windowText().color()
        if self._span is not None:
            low, high = (self._x_at(value, bar) for value in self._span)
            painter.setPen(QPen(ink, 2.0, c=Qt.PenCapStyle.FlatCap))
            y = bar.bottom() + _SPAN
            painter.drawLine(QPointF(min(low, high - 2.0), y), QPointF(high, y))
        if self.value is not None and self.value == self.value:
            self._draw_tick(painter, self._x_at(self.value, bar), bar)
        painter.setPen(ink)
        for place, text in self.labels:
            room = QRectF(self.fontMetrics().boundingRect(text)).adjusted(-1, 0, 3, 0)
            left = min(max(place * wide - room.width() / 2, 0.0), wide - room.width())
            top = bar.bottom() + 2 * _SPAN
            painter.drawText(
                QRectF(left, top, room.width(), self.fontMetrics().height()),
                Qt.AlignmentFlag.AlignCenter,
                text,
            )

    def _x_at(self, value: float, bar: QRectF) -> float:
        return bar.left() + self._scale.position(value) * bar.width()

    def _draw_tick(self, painter: QPainter, x: float, bar: QRectF) -> None:
        ink, paper = self.palette().windowText().color(), self.palette().base().color()
        painter.setPen(QPen(paper, 3.0))
        painter.drawLine(QPointF(x, bar.top()), QPointF(x, bar.bottom()))
        painter.setPen(QPen(ink, 1.25))
        painter.drawLine(QPointF(x, bar.top()), QPointF(x, bar.bottom()))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(ink)
        top = bar.top() - _TICK + 1.0
        x = min(max(x, 5.0), self.width() - 5.0)
        painter.drawPolygon(
            QPolygonF([QPointF(x - 4.5, top), QPointF(x + 4.5, top), QPointF(x, bar.top() - 0.5)])
        )


def scale_image(scale: Scale) -> QImage:
    """Image of the colours of a scale, one pixel high."""
    colors = scale.colors(np.linspace(0.0, 1.0, _STEPS))
    return QImage(colors.tobytes(), _STEPS, 1, colors.nbytes, QImage.Format.Format_RGB888).copy()
