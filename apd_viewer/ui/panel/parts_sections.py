"""Handle and region sections: lists, readings and targets."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QPushButton, QWidget

from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.language import tr, trc, trn
from apd_viewer.presentation import readings
from apd_viewer.presentation.palette import BASE_COLOR, HANDLE_COLORS, REGION_COLORS
from apd_viewer.session.model.status_text import self_intersection_warnings
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.posing.motion_field import MotionField, SymmetryRow
from apd_viewer.ui.widgets.box_layouts import STRETCH, add_parts, row_layout
from apd_viewer.ui.widgets.fields import CheckBox, NumberField, percent_field
from apd_viewer.ui.widgets.folding_section import Section, quiet_label
from apd_viewer.ui.widgets.part_row import PartButtons, PartList, PartRow, Swatch
from apd_viewer.ui.widgets.slider_field import SHARE, SliderField
from apd_viewer.ui.widgets.theme import Theme, icon

if TYPE_CHECKING:
    from apd_viewer.geometry.analysis.shape_check import ShapeCheck
    from apd_viewer.session.model.state import State

_DRIFT = tr("Distance between a handle and the position you gave it; the largest of several")


class HandleSection(Section):
    """Handles with their displacement and rotation, and their drift.

    Attributes
    ----------
    base : PartButtons
        In the row of the base, above those of the handles.
    falloff : SliderField
        In percent of the longest side.
    crossing_signs : QLabel
        Warnings that the surface has passed through itself; hidden without any.
    """

    add_requested = Signal()
    reset_all_requested = Signal()
    reset_handle_requested = Signal()

    def __init__(self) -> None:
        super().__init__(tr("Handles"))
        self.list = PartList(HANDLE_COLORS, self._row)
        self.column.addLayout(self._make_base_row())
        self.column.addWidget(self.list)
        self.crossing_signs = QLabel(
            objectName="lost", wordWrap=True, accessibleName=tr("Signs of self-penetration")
        )
        self.crossing_signs.hide()
        self.column.addWidget(self.crossing_signs)
        self.motion = MotionField()
        self.column.addWidget(self.motion)
        self.symmetry = SymmetryRow()
        self.column.addWidget(self.symmetry)
        tip = tr(
            "Distance over which the surface around the active handle moves with it, decreasing "
            "outwards; in percent of the longest side"
        )
        field = NumberField(brief=True, decimals=2, maximum=100.0, suffix=" %", singleStep=1.0, toolTip=tip)
        self.falloff = SliderField(
            QLabel(tr("Falloff"), toolTip=tip), SHARE, field, tr("Falloff of the handle")
        )
        self.column.addWidget(self.falloff)
        self.drift = QLabel("–", accessibleName=_DRIFT, toolTip=_DRIFT)
        grid = QGridLayout()
        grid.addWidget(QLabel(tr("Drift"), objectName="quiet", toolTip=_DRIFT), 0, 0)
        grid.addWidget(self.drift, 0, 1, Qt.AlignmentFlag.AlignRight)
        self.column.addLayout(grid)
        self.add = QPushButton(tr("Add"), accessibleName=tr("Add handle"), toolTip=tr("Add another handle"))
        self.reset_handle = QPushButton(
            tr("Reset"), toolTip=tr("Return the active handle to its rest position")
        )
        self.reset_handle.setAccessibleName(tr("Reset handle"))
        self.reset_all = QPushButton(
            tr("Reset all"), toolTip=tr("Reset all handles and return the mesh to its rest shape")
        )
        self.reset_all.setAccessibleName(tr("Reset all handles"))
        self.add.clicked.connect(self.add_requested)
        self.reset_handle.clicked.connect(self.reset_handle_requested)
        self.reset_all.clicked.connect(self.reset_all_requested)
        buttons = row_layout(self.add, self.reset_handle, self.reset_all)
        add_parts(self.column, 4, buttons)

    def _make_base_row(self) -> QHBoxLayout:
        tip = tr("Vertices of the base")
        self._base_count = QLabel(objectName="quiet", accessibleName=tip, toolTip=tip)
        self.base = PartButtons()
        name = QLabel(tr("Base")), 1
        return row_layout(Swatch(BASE_COLOR), name, self._base_count, self.base, margins=(9, 4, 5, 0))

    def _row(self, _k: int, name: str, color: tuple[int, int, int]) -> PartRow:
        details = quiet_label(tr("Displacement and rotation of {name}").format(name=name), indent=22)
        return PartRow("handle", name, color, details)

    def show_settings(self, state: State, unit: Unit, active: int) -> None:
        """Show the handles, and the motion of the active one."""
        document = state.document
        self.list.show_names([handle.name for handle in document.handles], active)
        held = document.label_counts[BASE]
        self._base_count.setText(_vertices(held))
        self.base.show_flags(document.base, bool(held))
        for k, row in enumerate(self.list.rows):
            count = document.label_counts[HANDLE + k]
            row.reading.setText(_vertices(count))
            row.reading.setToolTip(tr("Vertices of the handle"))
            row.remove.setVisible(len(document.handles) > 1)
            row.show_flags(document.handles[k].flags, bool(count))
        self.reset_handle.setEnabled(
            bool(document.label_counts[HANDLE + active]) and state.is_handle_moved(active)
        )
        self.falloff.show_value(100.0 * document.handles[active].falloff / max(state.inspection.size))
        self.motion.setEnabled(
            document.paint_problem is None and bool(document.label_counts[HANDLE + active])
        )
        self._show_motion(state, unit, active)
        self.heading.show_reading(f"{len(document.handles)}", only_folded=True)

    def show_check(self, state: State, check: ShapeCheck | None) -> None:
        """Show self-intersection warnings once known."""
        lost = self_intersection_warnings(state, check)
        self.crossing_signs.setText("\n".join(lost))
        self.crossing_signs.setVisible(bool(lost))

    def show_readings(self, state: State, unit: Unit, active: int) -> None:
        """Show the largest drift from the targets, and the active handle's motion."""
        self.drift.setText(readings.drift(state, unit))
        self._show_motion(state, unit, active)

    def _show_motion(self, state: State, unit: Unit, active: int) -> None:
        details = self.list.rows[active].details
        if isinstance(details, QLabel):
            details.setText(readings.motion(state, active, unit))

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        super().set_theme(theme)
        self.base.set_theme(theme)
        self.list.set_theme(theme)
        self.falloff.set_theme(theme)
        self.add.setIcon(icon("add", theme))


def _vertices(count: int) -> str:
    return trn("{n:,} vertex", "{n:,} vertices", int(count)).format(n=count) if count else tr("empty")


class RegionSection(Section):
    """Named regions with their areas and area targets.

    Attributes
    ----------
    target_changed : Signal(int, object)
        A region and the area to keep in percent, or None to leave it free.
    """

    add_requested = Signal()
    target_changed = Signal(int, object)

    def __init__(self) -> None:
        super().__init__(tr("Regions"))
        about = tr("A region is a painted part whose area you can measure and keep.")
        self.empty = quiet_label(tr("About regions"), about)
        self.list = PartList(REGION_COLORS, self._row)
        self.note = quiet_label(tr("Why regions are not kept"), tr("The method Paper only measures regions."))
        self.note.hide()
        self.add = QPushButton(tr("Add region"), toolTip=tr("Add another region to measure or keep its area"))
        self.add.clicked.connect(self.add_requested)
        add_parts(self.column, self.empty, self.list, self.note, 4, self.add)

    def _row(self, k: int, name: str, color: tuple[int, int, int]) -> PartRow:
        row = PartRow("region", name, color, RegionTargetField())
        details = row.details
        assert isinstance(details, RegionTargetField)
        details.target_changed.connect(lambda percent: self.target_changed.emit(k, percent))
        return row

    def show_settings(self, state: State, active: int) -> None:
        """Show the regions and their area targets."""
        document = state.document
        regions, only_measured = document.regions, document.settings.traits.keeps_only_total_area
        self.list.show_names([region.name for region in regions], active)
        for k, (region, row) in enumerate(zip(regions, self.list.rows, strict=True), 1):
            row.show_flags(region.flags, bool(state.region_counts[k]))
            if isinstance(row.details, RegionTargetField):
                row.details.show_target(region.area, not only_measured)
        self.empty.setVisible(not regions)
        self.note.setVisible(bool(regions) and only_measured)
        self.heading.show_reading(f"{len(regions)}" if regions else trc("regions", "none"), only_folded=True)

    def show_readings(self, state: State, unit: Unit) -> None:
        """Show the area of each region."""
        for row, (area, sizes) in zip(self.list.rows, readings.regions(state, unit), strict=False):
            row.reading.setText(area)
            row.reading.setToolTip(tr("Area in percent of its rest area: {sizes}").format(sizes=sizes))

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        super().set_theme(theme)
        self.list.set_theme(theme)
        self.add.setIcon(icon("add", theme))


class RegionTargetField(QWidget):
    """Area target of a region: free, or a percentage of the rest area.

    Attributes
    ----------
    target_changed : Signal(object)
        In percent, or None.
    """

    target_changed = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        tip = tr("Target of the area of the region, in percent of its rest area")
        self.box = CheckBox(
            tr("Keep at"), toolTip=tr("Keep the area of the region exactly, or leave it free")
        )
        self.field: NumberField = percent_field(tr("Area target of the region"), tip)
        row_layout(self.box, self.field, STRETCH, margins=(22, 0, 0, 2), parent=self)
        self.box.toggled.connect(lambda on: self.target_changed.emit(self.field.value() if on else None))
        self.field.valueChanged.connect(lambda percent: self.target_changed.emit(percent))

    def show_target(self, percent: float | None, possible: bool) -> None:
        """Show the area target, enabled if ``possible``."""
        self.setEnabled(possible)
        self.box.blockSignals(True)
        self.box.setChecked(percent is not None)
        self.box.blockSignals(False)
        self.field.setEnabled(percent is not None and possible)
        self.field.show_value(100.0 if percent is None else percent)
