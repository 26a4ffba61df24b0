"""Volume section: reading and optional target."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QIcon, QPixmap
from PySide6.QtWidgets import QGridLayout, QLabel, QToolButton, QWidget

from apd_viewer.language import tr
from apd_viewer.presentation import readings
from apd_viewer.ui.widgets.fields import CheckBox, percent_field
from apd_viewer.ui.widgets.folding_section import Section, quiet_label
from apd_viewer.ui.widgets.icons import icon
from apd_viewer.ui.widgets.slider_field import PERCENT, SliderField
from apd_viewer.ui.widgets.theme import LIGHT, Theme

if TYPE_CHECKING:
    from apd_viewer.geometry.analysis.shape_check import ShapeCheck
    from apd_viewer.session.model.state import State
    from apd_viewer.session.quantities.units import Unit

_TIP = tr("Target of the enclosed volume, in percent of the rest volume")


class VolumeSection(Section):
    """Volume reading, and a target behind a switch.

    Attributes
    ----------
    target : SliderField
        In percent.
    target_changed : Signal(object)
        The volume to keep in percent, or None to leave it free.
    volume, litres, pairs, least_gap, share : QLabel
    crossings : CrossingsButton
    """

    target_changed = Signal(object)

    def __init__(self) -> None:
        super().__init__(tr("Volume"))
        self.volume = quiet_label(tr("Volume, and rest volume"))
        self.keep = CheckBox(tr("Keep volume"), toolTip=tr("Keep the enclosed volume exactly"))
        self.target = SliderField(self.keep, PERCENT, percent_field("", _TIP), tr("Volume target"))
        self.disabled_note = quiet_label(tr("Why the volume cannot be kept"))
        self.litres = quiet_label(tr("Volume in litres, and how its openings were closed"))
        self.crossings = CrossingsButton()
        for part in (self.volume, self.litres, self.crossings):
            self.column.addWidget(part)
        self._add_contact()
        self.column.addWidget(self.target)
        self.column.addWidget(self.disabled_note)
        for later in (self.target.field, self.target.slider, self.disabled_note):
            later.hide()  # until a volume can be kept
        self.keep.toggled.connect(lambda on: self.target_changed.emit(self.target.value if on else None))

    def _add_contact(self) -> None:
        self._contact = QWidget()
        grid = QGridLayout(self._contact, horizontalSpacing=8, verticalSpacing=4)
        grid.setContentsMargins(0, 0, 0, 4)
        grid.setColumnStretch(0, 1)
        rows = (
            (
                tr("Pairs in contact"),
                tr("Pairs of vertex and triangle, or of two edges, nearer than the distance that walls keep"),
            ),
            (tr("Least gap"), tr("Least distance of what is in contact")),
            (
                tr("Share of the way"),
                tr("Share of its way from rest that contact has let the handle go"),
            ),
        )
        values = []
        for row, (title, tip) in enumerate(rows):
            values.append(QLabel(readings.NO_VALUE, accessibleName=title, toolTip=tip))
            grid.addWidget(QLabel(title, objectName="quiet", toolTip=tip), row, 0)
            grid.addWidget(values[-1], row, 1, Qt.AlignmentFlag.AlignRight)
        self.pairs, self.least_gap, self.share = values
        self._contact.hide()  # until contact is on
        self.column.addWidget(self._contact)

    def set_theme(self, theme: Theme) -> None:
        """Recolour the parts beyond the style sheet's reach."""
        super().set_theme(theme)
        self.target.set_theme(theme)
        self.crossings.set_theme(theme)

    @property
    def change(self) -> str:
        """The change of the volume, in words."""
        return self.heading.reading

    def show_settings(self, state: State) -> None:
        """Show the target, or the reason for a missing volume."""
        document, inspection = state.document, state.inspection
        why = "" if inspection.volume else tr("Only a closed surface has a volume to keep.")
        if document.settings.traits.keeps_only_total_area and not why:
            name = document.settings.traits.short_title
            why = tr("The method {name} cannot keep a volume.").format(name=name)
        self.disabled_note.setText(why)
        self.disabled_note.setVisible(bool(why))
        asked = document.settings.volume is not None
        self.keep.setEnabled(not why)
        self.keep.blockSignals(True)
        self.keep.setChecked(asked and not why)
        self.keep.blockSignals(False)
        active = asked and not why
        self.target.set_active(active)
        self.target.field.setVisible(active)
        self.target.slider.setVisible(active)
        self.target.show_value(100.0 if document.settings.volume is None else document.settings.volume)

    def show_readings(self, state: State, unit: Unit) -> None:
        """Show the shape's volume; an open surface's with capped openings."""
        said = readings.volume(state, unit)
        self.heading.show_reading(said.change)
        self.volume.setText(said.volumes)
        self.litres.setText("\n".join(said.remarks))
        self.litres.setVisible(bool(said.remarks))
        if state.is_contact_active:
            touch = readings.contact(state, unit)
            for label, text in zip((self.pairs, self.least_gap, self.share), touch, strict=True):
                label.setText(text)
        self._contact.setVisible(state.is_contact_active)

    def show_preview(self) -> None:
        """Say nothing of a shape that has not come yet."""
        self.heading.show_reading("")
        for label in (self.volume, self.litres):
            label.setText(readings.NO_VALUE)

    def show_check(self, state: State, check: ShapeCheck | None, under_way: bool) -> None:
        """Show the self-intersections of a state as far as known."""
        if check is not None:
            count = None if check.crossing is None else len(check.crossing)
            self.crossings.show_count(count, state.is_contact_active)
        elif under_way and not state.is_safe_from_crossing:
            self.crossings.show_checking()
        else:
            self.crossings.show_moving(state.is_safe_from_crossing)


_KEPT_APART = tr("Contact keeps walls apart: no triangles intersect, and the volume counts nothing twice")


class CrossingsButton(QToolButton):
    """Line under the volume about self-intersections; empty if there are none."""

    def __init__(self) -> None:
        super().__init__(
            objectName="crossings", iconSize=QSize(16, 16), focusPolicy=Qt.FocusPolicy.StrongFocus
        )
        self.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self._theme, self._symbol = LIGHT, ""
        self.show_moving()

    def show_moving(self, cannot_cross: bool = False) -> None:
        """The shape is on its way to somewhere else, kept from crossing itself or not."""
        if cannot_cross:
            self._say(tr("no self-intersections"), _KEPT_APART, "sound")
            return
        tip = tr("Self-intersections are checked when the shape stops moving")
        self._say(tr("self-intersections: checked when it stops"), tip)

    def show_checking(self) -> None:
        """It is being found out."""
        self._say(tr("checking for self-intersections…"), tr("Checking whether triangles intersect"))

    def show_count(self, triangles: int | None, kept_apart: bool = False) -> None:
        """Show the number of intersecting triangles; None if unknown.

        With ``kept_apart`` contact is on.
        """
        if triangles is None:
            tip = tr("The library ipctk, which checks this, is missing or does not respond")
            self._say(tr("self-intersections: not checked"), tip)
        elif triangles == 0:
            self._say(
                tr("no self-intersections"),
                _KEPT_APART if kept_apart else tr("No triangles intersect"),
                "sound",
            )
        else:
            said = tr("{n:,} intersecting triangles")
            tip = tr("The volume counts overlaps twice. Show where this is")
            if kept_apart:
                tip = tr(
                    "Contact leaves what crosses at rest as it is, and keeps no loose part apart from what "
                    "carries it; the volume counts such overlaps twice. Show where this is"
                )
            self._say(said.format(n=triangles), tip, "warning")

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icon."""
        self._theme = theme
        self._draw()

    def _say(self, text: str, tip: str, symbol: str = "") -> None:
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
        else:  # an unknown state has no icon, but its text is aligned as if it had one
            nothing = QPixmap(self.iconSize())
            nothing.fill(Qt.GlobalColor.transparent)
            self.setIcon(QIcon(nothing))
