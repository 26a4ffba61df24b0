"""Size section: dimensions, compactness and mass."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QGridLayout, QLabel, QLineEdit

from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.presentation import readings
from apd_viewer.session.quantities.expressions import MOST_CHARACTERS, unambiguous_text
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import NO_WALL, WallText, typed_mass
from apd_viewer.ui.widgets.box_layouts import add_parts, row_layout
from apd_viewer.ui.widgets.fields import TextField, return_focus
from apd_viewer.ui.widgets.folding_section import Section, quiet_label

if TYPE_CHECKING:
    from apd_viewer.geometry.analysis.shape_check import ShapeCheck
    from apd_viewer.session.model.state import State


class SizeSection(Section):
    """Table of dimensions and mass, and fields for wall thickness and density.

    Attributes
    ----------
    wall_entered : Signal(WallText)
    box_change, packed_change, compact_change : QLabel
        From rest.
    problem : QLabel
        Why there is no mass.
    """

    wall_entered = Signal(object)

    def __init__(self) -> None:
        super().__init__(tr("Size and mass"))
        self._unit, self._area, self._typed = Unit.NONE, 0.0, NO_WALL
        self._material: float | None = None
        self._found: ShapeCheck | None = None
        self._at_rest: ShapeCheck | None = None
        self._grid = QGridLayout(horizontalSpacing=8, verticalSpacing=4)
        self._grid.setColumnStretch(1, 1)
        later = tr("measured when the shape stops moving")
        self.extent = self._row(
            tr("Bounding box"), tr("Extent along x, y and z; {later}").format(later=later), wide=True
        )
        self.box, self.box_change = self._rows(
            tr("Bounding box volume"),
            tr("Volume of the bounding box along x, y and z; {later}").format(later=later),
        )
        self.packed, self.packed_change = self._rows(
            tr("Smallest box volume"),
            tr(
                "Volume of the smallest bounding box found, in any orientation: the space it takes up "
                "in a carton or a bale; {later}"
            ).format(later=later),
        )
        self.compact, self.compact_change = self._rows(
            tr("Compactness"),
            tr("36 π V² / A³ of volume V and area A, for closed surfaces: 1 for a sphere, 0.52 for a cube"),
        )
        self._add_wall()
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
        self._grid.addWidget(QLabel(title, objectName="quiet", toolTip=tip), row, 0)
        self._grid.addWidget(reading, row, 1, 1, 2 if wide else 1)
        return reading

    def _rows(self, title: str, tip: str) -> tuple[QLabel, QLabel]:
        """Labels of a reading and of its change from rest."""
        reading = self._row(title, tip)
        name = tr("{title}, change").format(title=title)
        change = QLabel("", objectName="quiet", accessibleName=name, alignment=Qt.AlignmentFlag.AlignRight)
        change.setMinimumWidth(change.fontMetrics().horizontalAdvance("−100.0 %"))
        self._grid.addWidget(change, self._grid.rowCount() - 1, 2)
        return reading, change

    def _add_wall(self) -> None:
        row = self._grid.rowCount()
        tip = tr("Thickness of the wall: 0.3mm, or a number in the unit of the mesh")
        self.thickness = self._field(tr("thickness"), tip)
        tip = tr("Density of the material: 1.38 (g/cm³, as for PET), 1380 kg/m³ or 86 lb/ft³")
        self.density = self._field(tr("density"), tip)
        label = QLabel(tr("Wall"), objectName="quiet", buddy=self.thickness)
        line = row_layout((label, 1), (self.thickness, 1), (self.density, 1), spacing=4, margins=(0, 4, 0, 4))
        self._grid.addLayout(line, row, 0, 1, 3)

    def _field(self, what: str, tip: str) -> QLineEdit:
        field = TextField(placeholderText=what, toolTip=tip)
        field.setAccessibleName(tr("Wall, {what}").format(what=what))
        field.setMaxLength(MOST_CHARACTERS)
        field.editingFinished.connect(self._type)
        field.returnPressed.connect(partial(return_focus, field))
        return field

    @property
    def wall(self) -> WallText:
        """Wall thickness and density as typed."""
        return WallText(self.thickness.text(), self.density.text())

    def show_wall(self, wall: WallText) -> None:
        """Show the wall thickness and density of another mesh."""
        self.thickness.setText(wall.thickness)
        self.density.setText(wall.density)
        self._typed = wall
        self._show_mass()

    def _type(self) -> None:
        if self.wall != self._typed:
            self._typed = self.wall
            self._show_mass()
            self.wall_entered.emit(self.wall)

    def show_readings(self, state: State, unit: Unit) -> None:
        """Show compactness and mass of a state's shape."""
        self._area, self._material = state.frame.area, readings.material_volume(state)
        said = readings.double_wall(state, unit)
        self.two_walls.setText(said)
        self.two_walls.setVisible(bool(said))
        for label, text in zip(
            (self.compact, self.compact_change), readings.compactness_text(state), strict=True
        ):
            label.setText(text)
        if unit is not self._unit:
            self._unit = unit
            self._show_boxes()
        self._show_mass()

    def show_check(self, check: ShapeCheck | None, at_rest: ShapeCheck | None) -> None:
        """Show the bounding boxes from a shape check; None while unknown."""
        self._found, self._at_rest = check, at_rest
        self._show_boxes()

    def _show_boxes(self) -> None:
        found, rest = self._found, self._at_rest
        rows = (self.box, self.box_change, "box"), (self.packed, self.packed_change, "packed")
        for reading, changed, what in rows:
            said = readings.box_volume(getattr(found, what, None), getattr(rest, what, None), self._unit)
            reading.setText(said[0])
            changed.setText(said[1])
        self.extent.setText(readings.extent(found, self._unit))
        change = self.packed_change.text()
        self.heading.show_reading(
            tr("smallest box {change}").format(change=change) if change else "", only_folded=True
        )

    def _show_mass(self) -> None:
        try:
            thickness, density = map(unambiguous_text, (self._typed.thickness, self._typed.density))
            wall = WallText(thickness, density)
            grams, problem = typed_mass(wall, self._area, self._unit, self._material), ""
        except InputError as error:
            grams, problem = None, str(error)
        self.mass.setText(readings.mass(grams, self._unit))
        if problem != self.problem.text():
            self.problem.setText(problem)
            self.problem.setVisible(bool(problem))
