"""Sections of area and volume: readings, targets and warnings."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import QPointF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFont, QIcon, QPainter, QPaintEvent, QPixmap
from PySide6.QtWidgets import QGridLayout, QLabel, QStackedLayout, QToolButton, QVBoxLayout, QWidget

from apd_viewer.geometry.goals.target_values import ball_volume
from apd_viewer.geometry.solver.convergence import stability_text
from apd_viewer.language import tr
from apd_viewer.presentation import readings
from apd_viewer.presentation.number_format import format_grouped
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.panel.volume_target_field import VolumeTargetField
from apd_viewer.ui.preferences.unit_button import UnitButton
from apd_viewer.ui.widgets.box_layouts import STRETCH, column_layout, row_layout
from apd_viewer.ui.widgets.fields import CheckBox, percent_field
from apd_viewer.ui.widgets.folding_section import Section, quiet_label
from apd_viewer.ui.widgets.slider_field import PERCENT, SliderField
from apd_viewer.ui.widgets.theme import LIGHT, Theme, icon

if TYPE_CHECKING:
    from apd_viewer.geometry.analysis.shape_check import ShapeCheck
    from apd_viewer.session.model.state import State
    from apd_viewer.session.session import Session

# Display texts for the values of Activity.
_WORDS = {
    "idle": tr("idle"),
    "refining": tr("solving"),
    "paused": tr("paused"),
    "settled": tr("converged"),
    "not reached": tr("not converged"),
}
_AREA_TIP = tr("Target of the total area, in percent of the rest area")


def reading_grid(rows: Sequence[tuple[str, str]]) -> tuple[QGridLayout, list[QLabel]]:
    """Grid with a row for each title and tooltip, and the labels for its values."""
    grid = QGridLayout(horizontalSpacing=8, verticalSpacing=4)
    grid.setColumnStretch(0, 1)
    values = []
    for row, (title, tip) in enumerate(rows):
        values.append(QLabel(readings.NO_VALUE, accessibleName=title, toolTip=tip))
        grid.addWidget(reading_title(title, tip), row, 0)
        grid.addWidget(values[-1], row, 1, Qt.AlignmentFlag.AlignRight)
    return grid, values


def reading_title(title: str, tip: str) -> QLabel:
    """Title of a reading, wrapping beside a long value."""
    return QLabel(title, objectName="quiet", toolTip=tip, wordWrap=True)


class StatusDot(QWidget):
    """Status dot: neutral if all targets are met, in a warning colour otherwise."""

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
    """Area in large digits, with its change and a warning.

    Attributes
    ----------
    target : SliderField
        In percent; laid out with the method.
    keep_toggled : Signal(bool)
        "local" should keep the total area too, or not.
    """

    keep_toggled = Signal(bool)

    def __init__(self) -> None:
        super().__init__()
        self._theme = LIGHT
        column = column_layout(margins=(16, 12, 16, 8), parent=self)
        self._add_reading(column)
        self._make_target()
        self.unreached = QLabel("", objectName="unreached", wordWrap=True)
        self.unreached.setAccessibleName(tr("Targets out of reach"))
        self.unreached.hide()
        column.addWidget(self.unreached)

    def _add_reading(self, column: QVBoxLayout) -> None:
        self.activity = QLabel("", objectName="quiet", accessibleName=tr("Solver status"))
        self._dot = StatusDot()
        row = row_layout(
            QLabel(tr("Area"), objectName="heading"), STRETCH, self.activity, self._dot, spacing=-1
        )
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
        row = row_layout((self.area, 1), self.unit, spacing=4)
        column.addLayout(row)

    def _make_target(self) -> None:
        self.hold = CheckBox(tr("Keep total area"), toolTip=tr("Keep the total area exactly"))
        self.hold.toggled.connect(self.keep_toggled)
        label = QLabel(tr("Area target"), toolTip=_AREA_TIP)
        title = QWidget()
        self._title = QStackedLayout(title)
        self._title.setSizeConstraint(QStackedLayout.SizeConstraint.SetMinimumSize)
        for part in (label, self.hold):
            self._title.addWidget(part)
        self.target = SliderField(title, PERCENT, percent_field("", _AREA_TIP), tr("Area target"))
        label.setBuddy(self.target.field)

    def show_settings(self, state: State) -> None:
        """Show the area target of the document."""
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
        """Show the shape's area; ``targets_changed`` clears an outdated warning."""
        frame, missed = state.frame, state.has_unmet_target
        self.percent.setText(readings.area_percent(state))
        self.verdict.setText(readings.area_verdict(state))
        self.area.setText(readings.area(state, unit))
        self._dot.set_color(self._theme.warm if missed else self._theme.good)
        self._dot.setToolTip(tr("Some targets not met") if missed else tr("All targets met"))
        if frame.unreached is not None and (frame.settled or frame.share_reached < 1.0):
            self.unreached.setText(frame.unreached)
            self.unreached.show()
        elif frame.settled or not missed or targets_changed:
            # The warning stays while the solver works: otherwise it would flicker at every step of a drag.
            self.unreached.hide()

    def show_preview(self, compiled: float) -> None:
        """Show that there is no solved shape yet, and the compiled fraction of kernels."""
        self.percent.setText(readings.NO_VALUE)
        self.verdict.setText(tr("A preview: no area is kept yet."))
        self.area.setText(tr("Compiled so far: {percent} %").format(percent=math.floor(100.0 * compiled)))

    def show_activity(self, state: State, session: Session) -> None:
        """Show the solver's activity."""
        activity = session.store.shown_activity.value
        text = _WORDS[activity]
        if session.store.is_previewing:
            text = tr("preview")
        elif session.store.is_preparing:
            text = tr("preparing")
        elif activity == "not reached" and state.frame.unreached:
            text = tr("out of reach")
        self.activity.setText(text)
        stability = stability_text(state.frame, not state.document.settings.traits.is_plain_only)
        self.activity.setToolTip(tr("Stability: {words}").format(words=stability))

    def set_theme(self, theme: Theme) -> None:
        """Recolour the parts not covered by the style sheet."""
        self._theme = theme
        self.target.set_theme(theme)
        self.unit.set_theme(theme)


class StrainSection(Section):
    """Largest local area change, largest and mean edge strain, and drift of handles."""

    def __init__(self) -> None:
        super().__init__(tr("Strain and drift"))
        rows = (
            (
                tr("Largest local area change"),
                tr("Largest area change of any triangle, up or down, relative to its rest area"),
            ),
            (tr("Largest edge strain"), tr("Strain of the most stretched (+) or shortened (−) edge")),
            (tr("Mean edge strain"), tr("Mean absolute strain of the edges, weighted by rest area")),
            (
                tr("Drift"),
                tr("Distance between a handle and the position you gave it; the largest of several"),
            ),
        )
        grid, values = reading_grid(rows)
        self.local_change, self.largest_strain, self.mean_strain, self.drift = values
        self.column.addLayout(grid)

    def show_readings(self, state: State, unit: Unit) -> None:
        """Show the strains of a state's shape and the drift of its handles."""
        self.drift.setText(readings.drift(state, unit))
        self.local_change.setText(readings.local_change(state))
        self.largest_strain.setText(readings.largest_edge_strain(state))
        self.mean_strain.setText(readings.mean_edge_strain(state))
        self.heading.show_reading(self.largest_strain.text(), only_folded=True)

    def show_preview(self) -> None:
        """Show no strain while the shape is only a preview."""
        for reading in (self.local_change, self.largest_strain, self.mean_strain, self.drift):
            reading.setText(readings.NO_VALUE)
        self.heading.show_reading("")


_VOLUME_TIP = tr("What is held: 120%, 250ml or, with the method Wall, a pressure such as 30mbar or -0.2bar")
# Rest volume relative to the ball of the same area, below which a shape is flat and has no percentages.
_FLAT = 1e-2
_NOTHING = dict.fromkeys(("volume", "filled_volume", "pressure"))


class VolumeSection(Section):
    """Volume, with an optional target enabled by a check box.

    Attributes
    ----------
    target : SliderField
        In percent, or another target as typed; laid out with the method, as is the note below it.
    target_changed : Signal(object)
        Changes of settings by name: a target, or none.
    """

    target_changed = Signal(object)

    def __init__(self) -> None:
        super().__init__(tr("Volume"))
        self.volume = quiet_label(tr("Volume, and rest volume"))
        self.keep = CheckBox(tr("Keep volume"), toolTip=tr("Keep the enclosed volume exactly"))
        entry = VolumeTargetField(toolTip=_VOLUME_TIP)
        self.target = SliderField(self.keep, PERCENT, entry, tr("Volume target"))
        self.disabled_note = quiet_label(tr("Why the volume cannot be kept"))
        self.litres = quiet_label(tr("Volume in litres, and how its openings were closed"))
        self.crossings = CrossingsButton()
        for part in (self.volume, self.litres, self.crossings):
            self.column.addWidget(part)
        self._add_contact()
        for later in (self.target.field, self.target.slider, self.disabled_note):
            later.hide()  # shown once the volume can be kept
        self.keep.clicked.connect(self._keep)
        self.target.field.entered.connect(self.target_changed)

    def _keep(self, on: bool) -> None:
        """Keep the rest volume, or ask for what is held of a shape that has none."""
        if on and self._has_percent:
            self.target.chosen.emit(self.target.value)
        elif on:
            self.keep.setChecked(False)
            self.target.field.setFocus()
        else:
            self.target_changed.emit(_NOTHING)

    def _add_contact(self) -> None:
        self._contact = QWidget()
        rows = (
            (
                tr("Pairs in contact"),
                tr("Pairs of vertex and triangle, or of two edges, closer than the distance that walls keep"),
            ),
            (tr("Least gap"), tr("Least distance between parts in contact")),
            (tr("Fraction of the path"), tr("Fraction of the path that contact allows")),
        )
        grid, values = reading_grid(rows)
        grid.setContentsMargins(0, 0, 0, 4)
        self._contact.setLayout(grid)
        self.pairs, self.least_gap, self.path_fraction = values
        self._contact.hide()  # shown once contact is on
        self.column.addWidget(self._contact)

    def set_theme(self, theme: Theme) -> None:
        """Recolour the parts not covered by the style sheet."""
        super().set_theme(theme)
        self.target.set_theme(theme)
        self.crossings.set_theme(theme)

    @property
    def change(self) -> str:
        """Change of the volume, as text."""
        return self.heading.reading

    def show_settings(self, state: State) -> None:
        """Show the volume target, or why the volume cannot be kept."""
        settings, inspection = state.document.settings, state.inspection
        field, is_wall = self.target.field, settings.traits.is_wall
        is_open = bool(inspection.missing_volume_reason)
        why = tr("Only a closed surface has a volume to keep.") if is_open else ""
        if settings.traits.keeps_only_total_area and not why:
            why = tr("The method {name} cannot keep a volume.").format(name=settings.traits.short_title)
        ball = ball_volume(inspection.area)
        self._has_percent = not why and abs(inspection.volume or 0.0) > _FLAT * ball
        takes = not why or (is_wall and is_open)
        asked = takes and settings.effective_settings.is_filled
        asked |= not why and settings.volume is not None
        if takes and not self._has_percent and not asked:
            why = why or tr("Flat at rest: enter a volume such as 250ml.")
            if is_wall:
                why = tr("{sentence} Of a wall it may be a pressure such as 30mbar.").format(sentence=why)
        self.disabled_note.setText("" if asked else why)
        self.disabled_note.setVisible(bool(why) and not asked)
        self.keep.setEnabled(takes)
        self.keep.setChecked(asked)
        shown = asked or (takes and not self._has_percent)
        in_percent = asked and settings.volume is not None
        self.target.set_active(shown)
        self.target.field.setVisible(shown)
        self.target.slider.setVisible(in_percent)
        self.target.show_value(settings.volume or 100.0)
        field.show_settings(settings)
        self.target.reset_button.setVisible(in_percent and settings.volume != 100.0)

    def show_readings(self, state: State, unit: Unit) -> None:
        """Show the shape's volume; openings of an open surface are capped."""
        said = readings.volume(state, unit)
        self.heading.show_reading(said.change)
        self.volume.setText(said.volumes)
        self.litres.setText("\n".join(said.remarks))
        self.litres.setVisible(bool(said.remarks))
        if state.is_contact_active:
            touch = readings.contact(state, unit)
            for label, text in zip((self.pairs, self.least_gap, self.path_fraction), touch, strict=True):
                label.setText(text)
        self._contact.setVisible(state.is_contact_active)

    def show_preview(self) -> None:
        """Show no volume while the shape is only a preview."""
        self.heading.show_reading("")
        for label in (self.volume, self.litres):
            label.setText(readings.NO_VALUE)

    def show_check(self, state: State, check: ShapeCheck | None, under_way: bool) -> None:
        """Show the self-intersections of a state, or that they are not known yet."""
        if check is not None:
            count = None if check.crossing is None else len(check.crossing)
            self.crossings.show_count(count, state.is_contact_active)
        elif under_way and not state.is_safe_from_crossing:
            self.crossings.show_checking()
        else:
            self.crossings.show_pending(state.is_safe_from_crossing)


_KEPT_APART = tr("Contact keeps walls apart: no triangles intersect, and the volume counts nothing twice")


class CrossingsButton(QToolButton):
    """Line on self-intersections below the volume; a click shows any found."""

    def __init__(self) -> None:
        super().__init__(
            objectName="crossings", iconSize=QSize(16, 16), focusPolicy=Qt.FocusPolicy.StrongFocus
        )
        self.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self._theme, self._symbol = LIGHT, ""
        self.show_pending()

    def show_pending(self, cannot_cross: bool = False) -> None:
        """Show that the check waits for convergence, or is needless under contact."""
        if cannot_cross:
            self._show_text(tr("no self-intersections"), _KEPT_APART, "sound")
            return
        tip = tr("Self-intersections are checked when the shape stops moving")
        self._show_text(tr("self-intersections: checked when it stops"), tip)

    def show_checking(self) -> None:
        """Show that a check for self-intersections is in progress."""
        self._show_text(tr("checking for self-intersections…"), tr("Checking whether triangles intersect"))

    def show_count(self, triangles: int | None, kept_apart: bool = False) -> None:
        """Show the number of intersecting triangles; None if unknown.

        With ``kept_apart`` contact is on.
        """
        if triangles is None:
            tip = tr(
                "The library ipctk, which checks this, is missing or does not respond, or the mesh is a heap"
            )
            self._show_text(tr("self-intersections: not checked"), tip)
        elif triangles == 0:
            self._show_text(
                tr("no self-intersections"),
                _KEPT_APART if kept_apart else tr("No triangles intersect"),
                "sound",
            )
        else:
            sentence = tr("{n:,} intersecting triangles")
            tip = tr("The volume counts overlaps twice. Show where this is")
            if kept_apart:
                tip = tr(
                    "Contact ignores triangles that cross at rest, and a loose part against its carrier; "
                    "the volume counts such overlaps twice. Show where this is"
                )
            self._show_text(sentence.format(n=triangles), tip, "warning")

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icon."""
        self._theme = theme
        self._draw()

    def _show_text(self, text: str, tip: str, symbol: str = "") -> None:
        self.setText(text)
        self.setToolTip(tip)
        self.setAccessibleName(text)
        self.setEnabled(symbol == "warning")
        self._symbol = symbol
        self._draw()

    def _draw(self) -> None:
        theme = self._theme
        if self._symbol == "warning":
            self.setIcon(icon("warning", replace(theme, ink=theme.warm, on_accent=theme.warm)))
        elif self._symbol:
            self.setIcon(icon(self._symbol, replace(theme, faint=theme.quiet)))
        else:  # a transparent icon aligns the text of an unknown state with the others
            nothing = QPixmap(self.iconSize())
            nothing.fill(Qt.GlobalColor.transparent)
            self.setIcon(QIcon(nothing))
