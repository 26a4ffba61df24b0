"""One value with a slider for the hand and a field for the keyboard."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QVBoxLayout, QWidget

from apd_viewer.language import tr
from apd_viewer.ui.widgets.fields import NumberField, small_button
from apd_viewer.ui.widgets.icons import icon
from apd_viewer.ui.widgets.slider import Slider, SliderScale
from apd_viewer.ui.widgets.theme import Theme


class SliderField(QWidget):
    """One value with a slider for the hand and a field for the keyboard.

    Parameters
    ----------
    title : QLabel or QCheckBox
        Before the field; a check box also says whether the value counts at all.
    scale : SliderScale
    field : NumberField
    name : str
        For those who cannot see the title.
    ends : (str, str), optional
        Words under both ends of the slider.

    Attributes
    ----------
    chosen : Signal(float)
        By the field, by a step of the keyboard, or many times within a sweep of the knob.
    drag_began, drag_ended, drag_cancelled : Signal()
    """

    chosen = Signal(float)
    drag_began = Signal()
    drag_ended = Signal()
    drag_cancelled = Signal()

    def __init__(
        self,
        title: QWidget,
        scale: SliderScale,
        field: NumberField,
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
        neutral = f"{field.textFromValue(self._neutral)}{field.suffix()}"
        self.reset_button = small_button(
            tr("{name}: reset to {neutral}").format(name=name, neutral=neutral),
            tr("Reset to {neutral}").format(neutral=neutral),
        )
        kept = self.reset_button.sizePolicy()
        kept.setRetainSizeWhenHidden(True)
        self.reset_button.setSizePolicy(kept)
        if isinstance(title, QLabel):
            title.setBuddy(field)
        row = QHBoxLayout(spacing=0)
        row.addWidget(title)
        row.addStretch(1)
        row.addWidget(self.reset_button)
        row.addSpacing(4)
        row.addWidget(self.field)
        column = QVBoxLayout(self, spacing=4)
        column.setContentsMargins(0, 0, 0, 0)
        column.addLayout(row)
        column.addWidget(self.slider)
        if ends is not None:
            column.addLayout(_between(*ends))
        self.show_value(self._neutral)
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
    def _neutral(self) -> float:
        return self._scale.value_at(self._scale.neutral)

    @property
    def value(self) -> float:
        """Value of the field."""
        return self.field.value()

    def show_value(self, value: float) -> None:
        """Show a value without emitting a choice."""
        self.field.show_value(value)
        # A dragged knob stays under the cursor, also between steps.
        step = min(max(round(self._scale.step_of(value)), 0), self._scale.steps)
        if not self.slider.isSliderDown() and step != self.slider.value():
            self.slider.blockSignals(True)
            self.slider.setValue(step)
            self.slider.blockSignals(False)
        self.reset_button.setVisible(value != self._neutral)

    def set_active(self, on: bool) -> None:
        """Enable or disable the field, keeping its text."""
        for part in (self.field, self.slider, self.reset_button):
            part.setEnabled(on)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icon."""
        self.reset_button.setIcon(icon("reset", theme))

    def _choose(self, value: float) -> None:
        self.show_value(value)
        self.chosen.emit(value)

    def _go_back(self) -> None:
        if self.value != self._neutral:
            self._choose(self._neutral)


def _between(left: str, right: str) -> QHBoxLayout:
    row = QHBoxLayout()
    row.addWidget(QLabel(left, objectName="quiet"))
    row.addStretch(1)
    row.addWidget(QLabel(right, objectName="quiet"))
    return row
