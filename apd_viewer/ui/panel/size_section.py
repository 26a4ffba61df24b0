"""Size section: dimensions, compactness and mass."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QGridLayout, QLabel

from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.presentation import readings
from apd_viewer.session.quantities.expressions import unambiguous_text
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import WallText, typed_mass
from apd_viewer.ui.panel.area_section import reading_title
from apd_viewer.ui.panel.wall_fields import WallFields
from apd_viewer.ui.widgets.box_layouts import add_parts
from apd_viewer.ui.widgets.folding_section import Section, quiet_label
from apd_viewer.ui.widgets.theme import Theme

if TYPE_CHECKING:
    from apd_viewer.geometry.analysis.shape_check import ShapeCheck
    from apd_viewer.session.model.state import State


class SizeSection(Section):
    """Table of dimensions and mass, and fields for the wall.

    Attributes
    ----------
    box_change, packed_change, compact_change : QLabel
        Changes from rest.
    problem : QLabel
        Reason for a missing mass.
    """

    def __init__(self) -> None:
        super().__init__(tr("Size and mass"))
        self._unit, self._area = Unit.NONE, 0.0
        self._material: float | None = None
        self._found: ShapeCheck | None = None
        self._at_rest: ShapeCheck | None = None
        self._grid = QGridLayout(horizontalSpacing=8, verticalSpacing=4)
        self._grid.setColumnStretch(0, 1)
        later = tr("measured when the shape stops moving")
        self.extent = self._row(
            tr("Bounding box"), tr("Extent along x, y and z; {later}").format(later=later), wide=True
        )
        self.box, self.box_change = self._reading_labels(
            tr("Bounding box volume"),
            tr("Volume of the bounding box along x, y and z; {later}").format(later=later),
        )
        self.packed, self.packed_change = self._reading_labels(
            tr("Smallest box volume"),
            tr(
                "Volume of the smallest bounding box found, in any orientation: the space it takes up "
                "in a carton or a bale; {later}"
            ).format(later=later),
        )
        self.compact, self.compact_change = self._reading_labels(
            tr("Compactness"),
            tr("36 π V² / A³ of volume V and area A, for closed surfaces: 1 for a sphere, 0.52 for a cube"),
        )
        self.wall_fields = WallFields()
        self.wall_fields.entered.connect(lambda _: self._show_mass())
        self._grid.addWidget(self.wall_fields, self._grid.rowCount(), 0, 1, 3)
        self.mass = self._row(tr("Mass"), tr("Area × thickness × density"), wide=True)
        add_parts(self.column, self._grid, 4)
        self.problem = quiet_label(tr("Why there is no mass"), style="unreached")
        self.two_walls = quiet_label(tr("Material and capacity of the double wall"))
        for line in (self.problem, self.two_walls):
            line.hide()
            self.column.addWidget(line)

    def _row(self, title: str, tip: str, wide: bool = False) -> QLabel:
        row = self._grid.rowCount()
        reading = QLabel(
            readings.NO_VALUE, accessibleName=title, toolTip=tip, alignment=Qt.AlignmentFlag.AlignRight
        )
        self._grid.addWidget(reading_title(title, tip), row, 0)
        self._grid.addWidget(reading, row, 1, 1, 2 if wide else 1)
        return reading

    def _reading_labels(self, title: str, tip: str) -> tuple[QLabel, QLabel]:
        """Labels of a reading and of its change from rest."""
        reading = self._row(title, tip)
        name = tr("{title}, change").format(title=title)
        change = QLabel("", objectName="quiet", accessibleName=name, alignment=Qt.AlignmentFlag.AlignRight)
        change.setMinimumWidth(change.fontMetrics().horizontalAdvance("−100.0 %"))
        self._grid.addWidget(change, self._grid.rowCount() - 1, 2)
        return reading, change

    def show_wall(self, wall: WallText) -> None:
        """Show the wall of another mesh."""
        self.wall_fields.show_wall(wall, self._unit)
        self._show_mass()

    def show_readings(self, state: State, unit: Unit) -> None:
        """Show compactness and mass of a state's shape."""
        self._area, self._material = state.inspection.area, readings.material_volume(state)
        said = readings.double_wall(state, unit)
        self.two_walls.setText(said)
        self.two_walls.setVisible(bool(said))
        for label, text in zip(
            (self.compact, self.compact_change), readings.compactness_text(state), strict=True
        ):
            label.setText(text)
        if unit is not self._unit:
            self._unit = unit
            self.wall_fields.show_unit(unit)
            self._show_boxes()
        self._show_mass()

    def show_check(self, check: ShapeCheck | None, at_rest: ShapeCheck | None) -> None:
        """Show the bounding boxes from a shape check; None while unknown."""
        self._found, self._at_rest = check, at_rest
        self._show_boxes()

    def _show_boxes(self) -> None:
        found, rest = self._found, self._at_rest
        rows = (self.box, self.box_change, "box"), (self.packed, self.packed_change, "packed_box")
        for reading, changed, what in rows:
            said = readings.box_volume(getattr(found, what, None), getattr(rest, what, None), self._unit)
            reading.setText(said[0])
            changed.setText(said[1])
        self.extent.setText(readings.extent(found, self._unit))
        self._show_summary()

    def _show_summary(self) -> None:
        """Show the mass, or else the smallest box, in the heading while it is folded."""
        change, mass = self.packed_change.text(), self.mass.text()
        box = tr("smallest box {change}").format(change=change) if change else ""
        self.heading.show_reading(box if mass == readings.NO_VALUE else mass, only_folded=True)

    def _show_mass(self) -> None:
        wall = self.wall_fields.value
        try:
            for word in wall[:-1]:
                unambiguous_text(word)
            grams, problem = typed_mass(wall, self._area, self._unit, self._material), ""
        except InputError as error:
            grams, problem = None, str(error)
        self.mass.setText(readings.mass(grams, self._unit))
        self._show_summary()
        if problem != self.problem.text():
            self.problem.setText(problem)
            self.problem.setVisible(bool(problem))

    def set_theme(self, theme: Theme) -> None:
        """Apply the theme to the headings."""
        super().set_theme(theme)
        self.wall_fields.set_theme(theme)
