"""Panel section with distances, angles, geodesics, sections and fill levels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from PySide6.QtWidgets import QLabel, QPushButton

from apd_viewer.language import tr, trc
from apd_viewer.presentation import measurement_text as words
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.widgets.box_layouts import add_parts, row_layout
from apd_viewer.ui.widgets.fields import CheckBox
from apd_viewer.ui.widgets.folding_section import Section, quiet_label
from apd_viewer.ui.widgets.part_row import PartList, PartRow
from apd_viewer.ui.widgets.quantity_fields import VolumeField, field_row
from apd_viewer.ui.widgets.theme import Theme, icon

if TYPE_CHECKING:
    from apd_viewer.session.measurement_readings import MeasurementReading

_COLOR = (122, 130, 142)
_MOST_VOLUME = 1e18  # cubic mesh units


class MeasureSection(Section):
    """Panel section listing the measurements with their values and changes.

    Attributes
    ----------
    contents : VolumeField
        Volume of the active fill level.
    shown : CheckBox
        Check box to draw the measurements in the view.
    """

    def __init__(self) -> None:
        super().__init__(tr("Measure"))
        about = tr(
            "Choose the tool Measure and click the mesh: distances, angles, geodesics, sections, fill levels."
        )
        self.empty = quiet_label(tr("About measuring"), about)
        self.list = PartList([_COLOR], self._row)
        title, tip = (
            tr("Contents"),
            tr("Volume of the liquid, such as 480ml; what it does not hold is spilled"),
        )
        self.contents = VolumeField(
            brief=True, accessibleName=title, toolTip=tip, maximum=_MOST_VOLUME, decimals=9
        )
        self._contents = field_row(title, self.contents)
        self.shown = CheckBox(tr("Show in the view"), toolTip=tr("Draw the measurements over the mesh"))
        self.shown.setChecked(True)
        self.copy = QPushButton(tr("Copy"), toolTip=tr("Copy all values as text, for a spreadsheet"))
        self.copy.setAccessibleName(tr("Copy measurements"))
        self.clear = QPushButton(tr("Remove all"), toolTip=tr("Remove all measurements"))
        self.clear.setAccessibleName(tr("Remove all measurements"))
        buttons = row_layout(self.copy, self.clear)
        add_parts(self.column, self.empty, self.list, self._contents, self.shown, 4, buttons)
        self.show_readings((), Unit.NONE, 0)

    def _row(self, _k: int, name: str, color: tuple[int, int, int]) -> PartRow:
        details = quiet_label(tr("Values of {name}").format(name=name), indent=22)
        row = PartRow("measurement", name, color, details)
        row.buttons.hide()
        return row

    def show_readings(self, readings: Sequence[MeasurementReading], unit: Unit, active: int) -> None:
        """Show the given measurements with their current values."""
        self.list.show_names([reading.measurement.name for reading in readings], active)
        for reading, row in zip(readings, self.list.rows, strict=True):
            assert isinstance(row.details, QLabel)
            row.reading.setText(words.short_text(reading, unit))
            row.reading.setToolTip(words.detail_text(reading, unit))
            row.details.setText(words.detail_text(reading, unit))
        contents = readings[active].measurement.contents if readings else None
        self._contents.setVisible(contents is not None)
        self.contents.show_unit(unit)
        if contents is not None:
            self.contents.show_value(contents.volume)
        self.empty.setVisible(not readings)
        for part in (self.shown, self.copy, self.clear):
            part.setVisible(bool(readings))
        self.heading.show_reading(
            f"{len(readings)}" if readings else trc("measurements", "none"), only_folded=True
        )

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        super().set_theme(theme)
        self.list.set_theme(theme)
        self.copy.setIcon(icon("copy", theme))
