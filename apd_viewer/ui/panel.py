"""The panel at the side: the area first, then volume, method, handle and paint."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from PySide6.QtCore import QEvent, QPointF, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QFont, QKeyEvent, QPainter, QPaintEvent, QWheelEvent
from PySide6.QtWidgets import (
    QComboBox,
    QDoubleSpinBox,
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from apd_viewer.geometry.constraints import BASE, FREE, HANDLE
from apd_viewer.geometry.deformation import DEFAULT_TOLERANCE
from apd_viewer.session.document import State
from apd_viewer.ui.palette import BASE_COLOR, FREE_COLOR, HANDLE_COLOR
from apd_viewer.ui.theme import LIGHT, Theme

METHOD_NAMES = {"paper": "Paper (Li & Hui)", "arap": "ARAP"}
METHOD_WORDS = {
    "paper": "Keeps the total area within the tolerance. Gives up a little of where you put the handle.",
    "arap": "Keeps the shape as rigid as possible and the handle in place. Gives up the area.",
}
_WIDTH = 288
_NOTHING = 1e-7


class Dot(QWidget):
    """A dot that is quiet while all is well and warm when it is not."""

    def __init__(self) -> None:
        super().__init__()
        self.setFixedSize(16, 16)
        self._color = QColor("gray")

    def set_color(self, color: str) -> None:
        """Fill with ``color``."""
        if self._color.name() != color:
            self._color = QColor(color)
            self.update()

    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw the dot."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(self._color)
        painter.drawEllipse(QPointF(8, 8), 5, 5)


class _Choice(QComboBox):
    """A box that the wheel scrolls past: it lies where people scroll the panel."""

    def wheelEvent(self, event: QWheelEvent) -> None:
        event.ignore()


class _Number(QDoubleSpinBox):
    """A field that gives the keyboard back after Enter and Esc, and that the wheel scrolls past."""

    def __init__(self, **properties: Any) -> None:
        super().__init__(**properties)
        self.lineEdit().returnPressed.connect(self.clearFocus)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        super().keyPressEvent(event)
        if event.key() == Qt.Key.Key_Escape:
            self.clearFocus()

    def wheelEvent(self, event: QWheelEvent) -> None:
        if self.hasFocus():
            super().wheelEvent(event)
        else:
            event.ignore()


class Panel(QScrollArea):
    """Readings that follow the state, and the settings of the method.

    Attributes
    ----------
    method_chosen : Signal(str)
    tolerance_chosen : Signal(float)
        Relative, so 0.001 where the field says 0.1 %.
    reset_asked : Signal()
    """

    method_chosen = Signal(str)
    tolerance_chosen = Signal(float)
    reset_asked = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._theme = LIGHT
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Expanding)
        body = QWidget(objectName="panel")
        self._column = QVBoxLayout(body)
        self._column.setContentsMargins(16, 16, 16, 16)
        self._column.setSpacing(4)
        self._add_area()
        self._add_volume()
        self._add_method()
        self._add_handle()
        self._add_paint()
        self._column.addStretch(1)
        self.setWidget(body)

    def minimumSizeHint(self) -> QSize:
        """As wide as the widest line, so that nothing is ever cut off at the side."""
        body, bar = self.widget(), self.verticalScrollBar().sizeHint().width()
        lines = body.minimumSizeHint().width() + bar if body else 0
        return QSize(max(_WIDTH, lines), super().minimumSizeHint().height())

    def sizeHint(self) -> QSize:
        """No wider than it must be."""
        return QSize(self.minimumSizeHint().width(), super().sizeHint().height())

    def changeEvent(self, event: QEvent) -> None:
        """Ask for another width once the letters have grown."""
        super().changeEvent(event)
        if event.type() in (QEvent.Type.FontChange, QEvent.Type.StyleChange):
            QTimer.singleShot(0, self, self.updateGeometry)

    # Sections

    def _add_area(self) -> None:
        self._dot = Dot()
        self.activity = QLabel("", objectName="quiet", accessibleName="What the solver is doing")
        row = QHBoxLayout()
        row.addWidget(QLabel("Area", objectName="heading"))
        row.addStretch(1)
        row.addWidget(self.activity)
        row.addWidget(self._dot)
        self._column.addLayout(row)
        self.percent = QLabel("–", accessibleName="Area in percent of the rest area")
        font = QFont(self.percent.font())
        font.setPointSizeF(font.pointSizeF() * 2.5)
        font.setWeight(QFont.Weight.DemiBold)
        self.percent.setFont(font)
        self.percent.setMinimumWidth(self.percent.fontMetrics().horizontalAdvance("100.000 %"))
        self._column.addWidget(self.percent)
        self.area = self._value("Area, and area at rest")
        self.verdict = self._value("Change of the area")

    def _add_volume(self) -> None:
        self._rule()
        self._heading("Volume")
        self.volume_change = QLabel("–", accessibleName="Change of the volume")
        font = QFont(self.volume_change.font())
        font.setPointSizeF(font.pointSizeF() * 1.4)
        self.volume_change.setFont(font)
        self._column.addWidget(self.volume_change)
        self.volume = self._value("Volume, and volume at rest")

    def _add_method(self) -> None:
        self._rule()
        self._heading("Method")
        self.method = _Choice(accessibleName="Method")
        for key, name in METHOD_NAMES.items():
            self.method.addItem(name, key)
        self.method.activated.connect(lambda index: self.method_chosen.emit(self.method.itemData(index)))
        self._column.addWidget(self.method)
        self._words = self._value("What the method keeps and gives up")
        self.tolerance = _Number(
            accessibleName="Tolerance of the area in percent", minimum=0.001, maximum=10.0, decimals=3
        )
        self.tolerance.setSuffix(" %")
        self.tolerance.setStepType(QDoubleSpinBox.StepType.AdaptiveDecimalStepType)
        self.tolerance.setKeyboardTracking(False)
        self.tolerance.setValue(100.0 * DEFAULT_TOLERANCE)
        self.tolerance.setToolTip("How far the total area may be from the area at rest")
        self.tolerance.valueChanged.connect(lambda percent: self.tolerance_chosen.emit(percent / 100.0))
        row = QHBoxLayout()
        label = QLabel("Tolerance")
        label.setBuddy(self.tolerance)
        row.addWidget(label)
        row.addStretch(1)
        row.addWidget(self.tolerance)
        self._column.addSpacing(4)
        self._column.addLayout(row)

    def _add_handle(self) -> None:
        self._rule()
        self._heading("Handle")
        grid = QGridLayout()
        grid.setVerticalSpacing(4)
        self.moved = self._row(grid, 0, "Moved", "How far the handle was moved")
        self.turned = self._row(grid, 1, "Turned", "How far the handle was turned")
        self.drift = self._row(grid, 2, "Drift", "How far the handle is from where it was put")
        self._column.addLayout(grid)
        self.reset = QPushButton("Reset handle", toolTip="Put the handle back and the mesh in its rest shape")
        self.reset.clicked.connect(self.reset_asked)
        self._column.addSpacing(4)
        self._column.addWidget(self.reset)

    def _add_paint(self) -> None:
        self._rule()
        self._heading("Paint")
        grid = QGridLayout()
        grid.setVerticalSpacing(4)
        self._counts = {
            label: self._row(grid, row, f"{_swatch(color)}  {name}", f"Vertices painted as {name.lower()}")
            for row, (label, name, color) in enumerate(
                ((BASE, "Base", BASE_COLOR), (HANDLE, "Handle", HANDLE_COLOR), (FREE, "Free", FREE_COLOR))
            )
        }
        self._column.addLayout(grid)

    # What is shown

    def show_state(self, old: State | None, new: State) -> None:
        """Show what differs between two states."""
        document, frame = new.document, new.frame
        if old is None or old.document is not document or old.frame is not frame:
            self._show_readings(new)
        if old is None or old.document.labels is not document.labels:
            for label, field in self._counts.items():
                field.setText(f"{int((document.labels == label).sum()):,}")
        if old is None or old.document.method is not document.method:
            self.method.setCurrentIndex(self.method.findData(document.method))
            self._words.setText(METHOD_WORDS[document.method])
            self.tolerance.setEnabled(document.method == "paper")
        if old is None or old.document.tolerance != document.tolerance:
            self.tolerance.blockSignals(True)
            self.tolerance.setValue(100.0 * document.tolerance)
            self.tolerance.blockSignals(False)

    def set_theme(self, theme: Theme) -> None:
        """Recolour what the style sheet does not reach."""
        self._theme = theme

    def _show_readings(self, state: State) -> None:
        frame, rest = state.frame, state.inspection
        promised = state.document.method != "arap"
        within = abs(frame.area_error) <= state.document.tolerance or not promised
        self.percent.setText(f"{100 * (1 + frame.area_error):.3f} %")
        self._dot.set_color(self._theme.good if within else self._theme.warm)
        self.area.setText(f"{_figures(frame.area)} of {_figures(rest.area)}")
        verdict = f", {'within' if within else 'outside'} {100 * state.document.tolerance:.3g} %"
        self.verdict.setText(f"{_signed(100 * frame.area_error, 3)} %{verdict if promised else ''}")
        self._show_volume(state)
        self._show_handle(state)

    def _show_volume(self, state: State) -> None:
        rest, now = state.inspection.volume, state.frame.volume
        if rest is None or now is None or rest == 0.0:
            self.volume_change.setText("none")
            self.volume.setText(state.inspection.why_no_volume or "The surface encloses nothing.")
            return
        change = _signed(100 * (now / rest - 1), 2)
        self.volume_change.setText("unchanged" if float(change.replace("−", "-")) == 0 else f"{change} %")
        self.volume.setText(f"{_figures(now)} of {_figures(rest)}")

    def _show_handle(self, state: State) -> None:
        document = state.document
        held = document.labels == HANDLE
        if not held.any():
            self.moved.setText("–")
            self.turned.setText("–")
            self.drift.setText("–")
            return
        centre = document.grip[held].mean(axis=0)
        moved = document.pose[:3, :3] @ centre + document.pose[:3, 3] - centre
        size = max(state.inspection.size)
        self.moved.setText(_length(float(np.linalg.norm(moved)), size))
        cosine = (np.trace(document.pose[:3, :3]) - 1.0) / 2.0
        self.turned.setText(f"{math.degrees(math.acos(min(1.0, max(-1.0, cosine)))):.1f}°")
        self.drift.setText(_length(state.frame.handle_drift, size))

    # Pieces

    def _heading(self, text: str) -> None:
        self._column.addWidget(QLabel(text, objectName="heading"))

    def _value(self, name: str) -> QLabel:
        label = QLabel("", objectName="quiet", accessibleName=name, wordWrap=True)
        self._column.addWidget(label)
        return label

    def _row(self, grid: QGridLayout, row: int, title: str, tip: str) -> QLabel:
        label = QLabel(title, objectName="quiet", toolTip=tip)
        value = QLabel("–", alignment=Qt.AlignmentFlag.AlignRight, accessibleName=tip)
        grid.addWidget(label, row, 0)
        grid.addWidget(value, row, 1)
        return value

    def _rule(self) -> None:
        rule = QFrame(objectName="rule")
        rule.setFixedHeight(1)
        self._column.addSpacing(12)
        self._column.addWidget(rule)
        self._column.addSpacing(12)


def _figures(value: float, digits: int = 6) -> str:
    return f"{value:#.{digits}g}".rstrip(".") if value else "0"


def _length(value: float, size: float) -> str:
    """A length on a mesh of this size; what is nothing but rounding is zero."""
    return _figures(value, 4) if value > _NOTHING * size else "0"


def _signed(value: float, decimals: int) -> str:
    """The number with a real minus sign, and without a sign where it rounds to zero."""
    text = f"{value:+.{decimals}f}"
    return f"{0:.{decimals}f}" if float(text) == 0 else text.replace("-", "−")


def _swatch(color: tuple[int, int, int]) -> str:
    return f'<span style="color:rgb{color}; font-size:large">■</span>'
