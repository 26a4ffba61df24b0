"""Number field combined with a slider."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QLabel, QSizePolicy, QSlider, QStyle, QWidget

from apd_viewer.language import tr
from apd_viewer.ui.widgets.box_layouts import STRETCH, column_layout, row_layout
from apd_viewer.ui.widgets.fields import small_button
from apd_viewer.ui.widgets.theme import Theme, icon
from apd_viewer.ui.widgets.wheel import ignore_wheel


class SliderScale(NamedTuple):
    """Conversion between slider steps and values.

    Attributes
    ----------
    value_at : callable
        Value of a step.
    step_of : callable
        Step of a value, not rounded.
    neutral : int
        The step that the knob falls into, and from which the bar is drawn.
    """

    steps: int
    value_at: Callable[[int], float]
    step_of: Callable[[float], float]
    neutral: int


class SliderField(QWidget):
    """Number field combined with a slider, for the same value.

    Parameters
    ----------
    title : QLabel or QCheckBox
        Before the field; a check box also says whether the value counts at all.
    field : NumberField
        Or one with its signal and its methods for values.
    name : str
        Accessible name.
    ends : (str, str), optional
        Words under both ends of the slider.

    Attributes
    ----------
    chosen : Signal(float)
        Emitted by the field, by a key step, and repeatedly while the knob is moved.
    """

    chosen = Signal(float)
    drag_began = Signal()
    drag_ended = Signal()
    drag_cancelled = Signal()

    def __init__(
        self,
        title: QWidget,
        scale: SliderScale,
        field: Any,
        name: str,
        ends: tuple[str, str] | None = None,
    ) -> None:
        super().__init__()
        self._scale = scale
        self.field = field
        self.field.setAccessibleName(name)
        self.slider = Slider(
            scale, accessibleName=tr("{name}, slider").format(name=name), toolTip=field.toolTip()
        )
        neutral = f"{field.textFromValue(self._neutral_value)}{field.suffix()}"
        self.reset_button = small_button(
            tr("{name}: reset to {neutral}").format(name=name, neutral=neutral),
            tr("Reset to {neutral}").format(neutral=neutral),
        )
        kept = self.reset_button.sizePolicy()
        kept.setRetainSizeWhenHidden(True)
        self.reset_button.setSizePolicy(kept)
        if isinstance(title, QLabel):
            title.setBuddy(field)
        row = row_layout(title, STRETCH, self.reset_button, 4, self.field, spacing=0)
        column = column_layout(row, self.slider, parent=self)
        if ends is not None:
            left, right = (QLabel(text, objectName="quiet") for text in ends)
            column.addLayout(row_layout(left, STRETCH, right, spacing=-1))
        self.show_value(self._neutral_value)
        self._connect()

    def _connect(self) -> None:
        self.field.valueChanged.connect(self._choose)
        self.slider.valueChanged.connect(lambda step: self._choose(self._scale.value_at(step)))
        self.slider.sliderPressed.connect(self.drag_began)
        self.slider.sliderReleased.connect(self.drag_ended)
        self.slider.drag_cancelled.connect(self.drag_cancelled)
        self.slider.neutral_requested.connect(self._go_back)
        self.reset_button.clicked.connect(self._go_back)

    @property
    def _neutral_value(self) -> float:
        return self._scale.value_at(self._scale.neutral)

    @property
    def value(self) -> float:
        """Current value of the number field."""
        return self.field.value()

    def show_value(self, value: float) -> None:
        """Set the value without emitting a signal."""
        self.field.show_value(value)
        # While dragged, the knob follows the cursor even between steps.
        step = min(max(round(self._scale.step_of(value)), 0), self._scale.steps)
        if not self.slider.isSliderDown() and step != self.slider.value():
            self.slider.blockSignals(True)
            self.slider.setValue(step)
            self.slider.blockSignals(False)
        self.reset_button.setVisible(value != self._neutral_value)

    def set_active(self, on: bool) -> None:
        """Enable or disable field and slider, keeping the value."""
        for part in (self.field, self.slider, self.reset_button):
            part.setEnabled(on)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icon of the reset button."""
        self.reset_button.setIcon(icon("reset", theme))

    def _choose(self, value: float) -> None:
        self.show_value(value)
        self.chosen.emit(value)

    def _go_back(self) -> None:
        if self.value != self._neutral_value:
            self._choose(self._neutral_value)


_KNOB = 14


_MAGNET = 3  # pixels around the neutral value within which the knob snaps to it


# Scales in steps of half a percent, from 0 to 50 or from 50 to 150, and in three decades above 0.
SHARE = SliderScale(100, lambda step: step / 2.0, lambda percent: 2.0 * percent, 0)


PERCENT = SliderScale(200, lambda step: 50.0 + step / 2.0, lambda percent: 2.0 * (percent - 50.0), 100)


DECADES = SliderScale(
    91,
    lambda step: float(f"{1e-4 * 10.0 ** ((step - 1) / 30.0):.2g}") if step else 0.0,
    lambda value: 1.0 + 30.0 * math.log10(value / 1e-4) if value > 0.0 else 0.0,
    0,
)


class Slider(QSlider):
    """Slider with a marked neutral value; a press moves the knob to the cursor.

    Attributes
    ----------
    neutral_requested : Signal()
        A double click.
    drag_cancelled : Signal()
        Esc while the knob was held.
    """

    neutral_requested = Signal()
    drag_cancelled = Signal()

    def __init__(self, scale: SliderScale, **properties: Any) -> None:
        super().__init__(Qt.Orientation.Horizontal, **properties)
        self._neutral = scale.neutral
        self._grip = 0.0
        self.setRange(0, scale.steps)
        self.setPageStep(10)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        ignore_wheel(self)

    def sizeHint(self) -> QSize:
        """Height of the knob with its focus ring."""
        return QSize(120, _KNOB + 6)

    def minimumSizeHint(self) -> QSize:
        """Preferred size, so that the knob is not cut off."""
        return self.sizeHint()

    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw the groove, the mark at the neutral value, the bar from it and the knob."""
        palette, on = self.palette(), self.isEnabled()
        line, ink = palette.mid().color(), palette.placeholderText().color()
        accent = palette.highlight().color() if on else line
        middle, knob, neutral = (
            self.height() / 2,
            self.knob_position(self.value()),
            self.knob_position(self._neutral),
        )
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(line)
        painter.drawRoundedRect(QRectF(_KNOB / 2, middle - 1.5, self.width() - _KNOB, 3), 1.5, 1.5)
        painter.fillRect(QRectF(neutral - 0.75, middle - 5, 1.5, 10), ink if on else line)
        painter.setBrush(accent)
        painter.drawRoundedRect(
            QRectF(min(knob, neutral), middle - 1.5, abs(knob - neutral), 3).normalized(), 1.5, 1.5
        )
        painter.setPen(QPen(accent, 1.5))
        painter.setBrush(accent if self.isSliderDown() else palette.base())
        painter.drawEllipse(QPointF(knob, middle), _KNOB / 2 - 1, _KNOB / 2 - 1)
        if self.hasFocus():
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawEllipse(QPointF(knob, middle), _KNOB / 2 + 1.75, _KNOB / 2 + 1.75)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Grab the knob, moving it to the cursor first if pressed elsewhere."""
        if event.button() != Qt.MouseButton.LeftButton:
            return
        x, knob = event.position().x(), self.knob_position(self.value())
        self._grip = x - knob if abs(x - knob) <= _KNOB / 2 else 0.0
        self.setSliderDown(True)
        if not self._grip:
            self.setValue(self._step_at(x))

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Move the knob with the cursor."""
        if self.isSliderDown():
            self.setValue(self._step_at(event.position().x() - self._grip))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Release the knob."""
        if event.button() == Qt.MouseButton.LeftButton and self.isSliderDown():
            self.setSliderDown(False)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Request the neutral value."""
        if event.button() == Qt.MouseButton.LeftButton:
            self.neutral_requested.emit()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Cancel the drag on Esc."""
        if event.key() == Qt.Key.Key_Escape and self.cancel_drag():
            return
        super().keyPressEvent(event)

    def cancel_drag(self) -> bool:
        """Cancel a drag of the knob; True if there was one."""
        if not self.isSliderDown():
            return False
        self.blockSignals(True)
        self.setSliderDown(False)
        self.blockSignals(False)
        self.drag_cancelled.emit()
        return True

    def knob_position(self, step: int) -> float:
        """Horizontal position of the knob at a step, in pixels."""
        return _KNOB / 2 + (self.width() - _KNOB) * step / self.maximum()

    def _step_at(self, x: float) -> int:
        if abs(x - self.knob_position(self._neutral)) <= _MAGNET:
            return self._neutral
        return QStyle.sliderValueFromPosition(
            0, self.maximum(), round(x - _KNOB / 2), max(1, self.width() - _KNOB)
        )
