"""Area section: the area, its target, and a sentence if out of reach."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from PySide6.QtCore import QPointF, Qt, Signal
from PySide6.QtGui import QColor, QFont, QPainter, QPaintEvent
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QStackedLayout, QVBoxLayout, QWidget

from apd_viewer.language import tr
from apd_viewer.presentation import readings
from apd_viewer.presentation.number_format import format_grouped
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.preferences.unit_button import UnitButton
from apd_viewer.ui.widgets.fields import CheckBox, percent_field
from apd_viewer.ui.widgets.folding_section import quiet_label
from apd_viewer.ui.widgets.slider_field import PERCENT, SliderField
from apd_viewer.ui.widgets.theme import LIGHT, Theme

if TYPE_CHECKING:
    from apd_viewer.session.model.state import State
    from apd_viewer.session.session import Session

# For the values of Activity.
_WORDS = {
    "idle": tr("idle"),
    "refining": tr("solving"),
    "paused": tr("paused"),
    "settled": tr("converged"),
    "not reached": tr("not converged"),
}
_TIP = tr("Target of the total area, in percent of the rest area")


class StatusDot(QWidget):
    """Status dot: quiet while all is well, warm otherwise."""

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


class AreaSection(QWidget):
    """Area reading with its verdict, target and remark.

    Attributes
    ----------
    target : SliderField
        In percent.
    unit : UnitButton
    keep_toggled : Signal(bool)
        "local" should keep the total area too, or not.
    percent, area, verdict, unreached, local_change, activity : QLabel
    """

    keep_toggled = Signal(bool)

    def __init__(self) -> None:
        super().__init__()
        self._theme = LIGHT
        column = QVBoxLayout(self, spacing=4)
        column.setContentsMargins(0, 0, 0, 8)
        self._add_reading(column)
        self._add_target(column)
        self.unreached = QLabel("", objectName="unreached", wordWrap=True)
        self.unreached.setAccessibleName(tr("Targets out of reach"))
        self.unreached.hide()
        column.addSpacing(4)
        column.addWidget(self.unreached)
        column.addSpacing(4)
        tip = tr("Largest area change of any triangle, up or down, relative to its rest area")
        self.local_change = QLabel("–", accessibleName=tr("Largest local area change"), toolTip=tip)
        grid = QGridLayout()
        grid.addWidget(QLabel(tr("Largest local area change"), objectName="quiet", toolTip=tip), 0, 0)
        grid.addWidget(self.local_change, 0, 1, Qt.AlignmentFlag.AlignRight)
        column.addLayout(grid)

    def _add_reading(self, column: QVBoxLayout) -> None:
        self.activity = QLabel("", objectName="quiet", accessibleName=tr("Solver status"))
        self._dot = StatusDot()
        row = QHBoxLayout()
        row.addWidget(QLabel(tr("Area"), objectName="heading"))
        row.addStretch(1)
        row.addWidget(self.activity)
        row.addWidget(self._dot)
        column.addLayout(row)
        self.percent = QLabel("–", accessibleName=tr("Area in percent of the rest area"))
        font = QFont(self.percent.font())
        font.setPointSizeF(font.pointSizeF() * 2.5)
        font.setWeight(QFont.Weight.DemiBold)
        self.percent.setFont(font)
        self.percent.setMinimumWidth(
            self.percent.fontMetrics().horizontalAdvance(f"{format_grouped(100.0, 3)} %")
        )
        column.addWidget(self.percent)
        self.verdict = quiet_label(tr("Area change"))
        self.area = quiet_label(tr("Area, and rest area"))
        column.addWidget(self.verdict)
        self.unit = UnitButton()
        row = QHBoxLayout(spacing=4)
        row.addWidget(self.area, 1)
        row.addWidget(self.unit)
        column.addLayout(row)

    def _add_target(self, column: QVBoxLayout) -> None:
        self.hold = CheckBox(
            tr("Keep total area"),
            toolTip=tr("Keep the total area exactly"),
        )
        self.hold.toggled.connect(self.keep_toggled)
        label = QLabel(tr("Target"), toolTip=_TIP)
        title = QWidget()
        self._title = QStackedLayout(title)
        self._title.setSizeConstraint(QStackedLayout.SizeConstraint.SetMinimumSize)
        for part in (label, self.hold):
            self._title.addWidget(part)
        self.target = SliderField(title, PERCENT, percent_field("", _TIP), tr("Area target"))
        label.setBuddy(self.target.field)
        column.addSpacing(8)
        column.addWidget(self.target)

    def show_settings(self, state: State) -> None:
        """Show the document's settings."""
        document = state.document
        method = document.settings.traits
        optional = method.may_keep_total_area
        self.target.setVisible(method.keeps_total_area or optional)
        self._title.setCurrentIndex(int(optional))
        self.hold.blockSignals(True)
        self.hold.setChecked(document.settings.hold_area)
        self.hold.blockSignals(False)
        self.target.set_active(not optional or document.settings.hold_area)
        self.target.show_value(document.settings.area)

    def show_readings(self, state: State, unit: Unit, targets_changed: bool) -> None:
        """Show the shape's area; ``targets_changed`` after a change of the targets."""
        frame, missed = state.frame, state.has_unmet_target
        self.percent.setText(readings.area_percent(state))
        self.verdict.setText(readings.area_verdict(state))
        self.area.setText(readings.area(state, unit))
        self.local_change.setText(readings.local_change(state))
        self._dot.set_color(self._theme.warm if missed else self._theme.good)
        self._dot.setToolTip(tr("Some targets not met") if missed else tr("All targets met"))
        if frame.unreached is not None and (frame.settled or frame.share_reached < 1.0):
            self.unreached.setText(frame.unreached)
            self.unreached.show()
        elif frame.settled or not missed or targets_changed:
            # It stays while the solver works: otherwise it would flicker at every step of a drag.
            self.unreached.hide()

    def show_preview(self, compiled: float) -> None:
        """Say that no shape has come yet, and how much is compiled so far."""
        for reading in (self.percent, self.local_change):
            reading.setText(readings.NO_VALUE)
        self.verdict.setText(tr("A preview: no area is kept yet."))
        self.area.setText(tr("Compiled so far: {percent} %").format(percent=math.floor(100.0 * compiled)))

    def show_activity(self, state: State, session: Session) -> None:
        """Show the solver's activity."""
        activity = session.store.activity.value
        said = _WORDS[activity]
        if session.store.is_previewing:
            said = tr("preview")
        elif session.store.is_preparing:
            said = tr("preparing")
        elif activity == "not reached" and state.frame.unreached:
            said = tr("out of reach")
        self.activity.setText(said)

    def set_theme(self, theme: Theme) -> None:
        """Recolour the parts beyond the style sheet's reach."""
        self._theme = theme
        self.target.set_theme(theme)
        self.unit.set_theme(theme)
