"""Target shape section: distance of the shape from the target shape."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QGridLayout, QLabel, QPushButton

from apd_viewer.language import tr
from apd_viewer.presentation import readings
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.widgets.box_layouts import add_parts
from apd_viewer.ui.widgets.folding_section import Section, name_label

if TYPE_CHECKING:
    from apd_viewer.geometry.analysis.target_shape import TargetDistance
    from apd_viewer.session.model.document import Document
    from apd_viewer.session.model.state import State

_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter


class TargetSection(Section):
    """Name of the target shape and distances to it; hidden without a target.

    Attributes
    ----------
    closest, vertex : tuple of QLabel
        Largest, RMS and mean distance from the closest points, and from the same vertices.
    name : QLabel
        Name of the file, or the reason it is missing.
    """

    def __init__(self) -> None:
        super().__init__(tr("Target shape"))
        self._unit, self._size = Unit.NONE, 1.0
        self._found: TargetDistance | None = None
        self._shown: tuple[object, ...] = (None, None, None)
        self.name = name_label(tr("File of the target shape"))
        self.column.addWidget(self.name)
        self._grid = QGridLayout(horizontalSpacing=8, verticalSpacing=4)
        self._grid.setColumnStretch(0, 1)
        for row, (title, _) in enumerate(readings.DISTANCE_COLUMNS, start=1):
            self._grid.addWidget(QLabel(title, objectName="quiet"), row, 0)
        self.closest = self._column(
            1,
            tr("Closest point"),
            tr("Distance of each vertex from the closest point of the target shape, weighted by area"),
        )
        self.vertex = self._column(
            2,
            tr("Same vertex"),
            tr(
                "Distance of each vertex from the vertex with the same ID, weighted by area; "
                "only where the triangles of both meshes are the same"
            ),
        )
        add_parts(self.column, self._grid, 4)
        self.clear = QPushButton(tr("Clear target shape"), toolTip=tr("Stop comparing with the target shape"))
        self.column.addWidget(self.clear)
        self.hide()

    def _column(self, column: int, title: str, tip: str) -> tuple[QLabel, ...]:
        self._grid.addWidget(QLabel(title, objectName="quiet", toolTip=tip, alignment=_RIGHT), 0, column)
        labels = []
        for row, (what, _) in enumerate(readings.DISTANCE_COLUMNS, start=1):
            name = tr("{what}, {title}").format(what=what, title=title)
            label = QLabel(readings.NO_VALUE, accessibleName=name, toolTip=tip, alignment=_RIGHT)
            self._grid.addWidget(label, row, column)
            labels.append(label)
        return tuple(labels)

    def show_settings(self, document: Document) -> None:
        """Show the name of the target shape, or the reason it is missing."""
        target, missing = document.target_shape, document.missing_target_shape
        shown = target, missing, document.mesh.F
        if all(new is old for new, old in zip(shown, self._shown, strict=True)):
            return  # comparing all triangles is too slow for every step of a drag
        self._shown = shown
        self.setVisible(target is not None or missing is not None)
        if target is not None:
            self.name.setText(target.mesh.name)
        elif missing is not None:
            self.name.setText(missing.reason)
        self.name.setToolTip(self.name.text())
        corresponds = target is not None and target.has_same_triangles(document.mesh)
        for row in range(self._grid.rowCount()):
            for column, wanted in enumerate((target is not None, target is not None, corresponds)):
                if (item := self._grid.itemAtPosition(row, column)) and (widget := item.widget()):
                    widget.setVisible(wanted)

    def show_readings(self, state: State, unit: Unit) -> None:
        """Update the unit and scale of the distances."""
        self._size = max(state.inspection.size)
        if unit is not self._unit:
            self._unit = unit
            self._show()

    def show_distance(self, distance: TargetDistance | None) -> None:
        """Show the distances to the target shape; None while unknown."""
        if distance is not self._found:
            self._found = distance
            self._show()

    def _show(self) -> None:
        found = self._found
        for labels, name in ((self.closest, "closest"), (self.vertex, "vertex")):
            said = readings.distances(getattr(found, name, None), self._unit, self._size)
            for label, text in zip(labels, said, strict=True):
                label.setText(readings.PENDING if found is None else text)
        self.heading.show_reading(
            tr("RMS {distance}").format(distance=self.closest[1].text()), only_folded=True
        )
