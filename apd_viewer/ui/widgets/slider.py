"""Slider with a marked neutral value."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QSizePolicy, QSlider, QStyle

from apd_viewer.ui.widgets.wheel import ignore_wheel

_KNOB = 14


_MAGNET = 3  # pixels around the neutral value within which the knob snaps to it


class SliderScale(NamedTuple):
    """Map between slider steps and values.

    Attributes
    ----------
    steps : int
    value_at : callable
        From a step to its value.
    step_of : callable
        From a value to its step, not rounded.
    neutral : int
        The step that the knob falls into, and from which the bar is drawn.
    """

    steps: int
    value_at: Callable[[int], float]
    step_of: Callable[[float], float]
    neutral: int


# Half a percent per step, from 0 or around 100 %; and 0 with three decades above.
SHARE = SliderScale(100, lambda step: step / 2.0, lambda percent: 2.0 * percent, 0)


PERCENT = SliderScale(200, lambda step: 50.0 + step / 2.0, lambda percent: 2.0 * (percent - 50.0), 100)


DECADES = SliderScale(
    91,
    lambda step: float(f"{1e-4 * 10.0 ** ((step - 1) / 30.0):.2g}") if step else 0.0,
    lambda value: 1.0 + 30.0 * math.log10(value / 1e-4) if value > 0.0 else 0.0,
    0,
)


class Slider(QSlider):
    """Slider with a marked neutral value; its knob jumps to the cursor.

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
        """As high as its knob with the ring of the focus."""
        return QSize(120, _KNOB + 6)

    def minimumSizeHint(self) -> QSize:
        """The same."""
        return self.sizeHint()

    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw the groove, the bar from the neutral value, its mark and the knob."""
        palette, on = self.palette(), self.isEnabled()
        line, ink = palette.mid().color(), palette.placeholderText().color()
        accent = palette.highlight().color() if on else line
        middle, knob, neutral = self.height() / 2, self.x_of(self.value()), self.x_of(self._neutral)
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
        """Grab the knob; unless hit, it jumps to the cursor."""
        if event.button() != Qt.MouseButton.LeftButton:
            return
        x, knob = event.position().x(), self.x_of(self.value())
        self._grip = x - knob if abs(x - knob) <= _KNOB / 2 else 0.0
        self.setSliderDown(True)
        if not self._grip:
            self.setValue(self._step_at(x))

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Follow the cursor with the knob."""
        if self.isSliderDown():
            self.setValue(self._step_at(event.position().x() - self._grip))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Let the knob go."""
        if event.button() == Qt.MouseButton.LeftButton and self.isSliderDown():
            self.setSliderDown(False)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Ask for the neutral value."""
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

    def x_of(self, step: int) -> float:
        """Place of the knob at a step, in pixels from the left."""
        return _KNOB / 2 + (self.width() - _KNOB) * step / self.maximum()

    def _step_at(self, x: float) -> int:
        if abs(x - self.x_of(self._neutral)) <= _MAGNET:
            return self._neutral
        return QStyle.sliderValueFromPosition(
            0, self.maximum(), round(x - _KNOB / 2), max(1, self.width() - _KNOB)
        )
