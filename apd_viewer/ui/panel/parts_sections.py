"""Sections of the parts: one list of all, readings and targets."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QHBoxLayout, QLabel, QMenu, QPushButton, QToolButton, QWidget

from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.language import tr, trn
from apd_viewer.presentation import readings
from apd_viewer.presentation.palette import BASE_COLOR, HANDLE_COLORS, REGION_COLORS
from apd_viewer.session.model.status_text import self_intersection_warnings
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.posing.motion_field import MotionField, SymmetryRow
from apd_viewer.ui.widgets.box_layouts import STRETCH, add_parts, column_layout, row_layout
from apd_viewer.ui.widgets.fields import CheckBox, NumberField, keep_room, percent_field, small_button
from apd_viewer.ui.widgets.folding_section import CHEVRON, Section, quiet_label
from apd_viewer.ui.widgets.part_row import PartButtons, PartList, PartRow, Swatch
from apd_viewer.ui.widgets.slider_field import SHARE, SliderField
from apd_viewer.ui.widgets.theme import Theme, icon

if TYPE_CHECKING:
    from apd_viewer.geometry.analysis.shape_check import ShapeCheck
    from apd_viewer.session.model.document import Document
    from apd_viewer.session.model.state import State

_NAME_INDENT = 2  # px before the text of a name field


class PartsSection(Section):
    """One list of all parts, with a button to add more.

    Parameters
    ----------
    rows : sequence of QWidget
        Lists of the handles, regions and obstacles.

    Attributes
    ----------
    base : PartButtons
        In the row of the base, above those of the handles.
    add : QToolButton
        In the heading; opens a menu of what can be added.
    """

    def __init__(self, rows: Sequence[QWidget]) -> None:
        super().__init__(tr("Parts"))
        self._make_add()
        self.column.addLayout(self._make_base_row())
        add_parts(self.column, *rows)

    def _make_add(self) -> None:
        self.add = QToolButton(text=tr("Add"), accessibleName=tr("Add part"), objectName="small")
        self.add.setIconSize(QSize(16, 16))
        self.add.setToolTip(tr("Add another handle, region or obstacle"))
        self.add.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.add.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.add.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.add.setMenu(QMenu(self.add, toolTipsVisible=True))
        row_layout(STRETCH, self.add, CHEVRON + 8, parent=self.heading)

    def _make_base_row(self) -> QHBoxLayout:
        tip = tr("Vertices of the base")
        self._base_count = QLabel(objectName="quiet", accessibleName=tip, toolTip=tip)
        self.base = PartButtons()
        name, no_remove = QLabel(tr("Base"), indent=_NAME_INDENT), small_button("", "")
        keep_room(no_remove)
        no_remove.hide()
        parts = Swatch(BASE_COLOR), (name, 1), self.base, self._base_count, no_remove
        return row_layout(*parts, margins=(9, 4, 5, 0))

    def add_actions(self, *groups: Sequence[QAction]) -> None:
        """Add actions to the menu of the add button, with a separator between groups."""
        for actions in groups:
            self.add.menu().addSeparator()
            self.add.menu().addActions(list(actions))

    def show_settings(self, document: Document) -> None:
        """Show the vertex count and the flags of the base."""
        held = document.label_counts[BASE]
        self._base_count.setText(vertex_count_text(held))
        self.base.show_flags(document.base, bool(held))

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        super().set_theme(theme)
        self.base.set_theme(theme)
        self.add.setIcon(icon("add", theme))


class HandleSection(Section):
    """Motion of the active handle.

    Attributes
    ----------
    list : PartList
        Of all handles; laid out among the parts.
    falloff : SliderField
        In percent of the longest side.
    crossing_signs : QLabel
        Warnings that the surface has passed through itself; hidden without any.
    """

    reset_all_requested = Signal()
    reset_handle_requested = Signal()

    def __init__(self) -> None:
        super().__init__(tr("Motion"))
        self.list = PartList(HANDLE_COLORS, self._row)
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
        self.reset_handle = QPushButton(
            tr("Reset"), toolTip=tr("Return the active handle to its rest position")
        )
        self.reset_handle.setAccessibleName(tr("Reset handle"))
        self.reset_all = QPushButton(
            tr("Reset all"), toolTip=tr("Reset all handles and return the mesh to its rest shape")
        )
        self.reset_all.setAccessibleName(tr("Reset all handles"))
        self.reset_handle.clicked.connect(self.reset_handle_requested)
        self.reset_all.clicked.connect(self.reset_all_requested)
        buttons = row_layout(self.reset_handle, self.reset_all)
        add_parts(self.column, 4, buttons)

    def _row(self, _k: int, name: str, color: tuple[int, int, int]) -> PartRow:
        details = quiet_label(tr("Displacement and rotation of {name}").format(name=name), indent=22)
        return PartRow("handle", name, color, details)

    def show_settings(self, state: State, unit: Unit, active: int) -> None:
        """Show the handles, and the motion of the active one."""
        document = state.document
        self.list.show_names([handle.name for handle in document.handles], active)
        for k, row in enumerate(self.list.rows):
            count = document.label_counts[HANDLE + k]
            row.reading.setText(vertex_count_text(count))
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

    def show_check(self, state: State, check: ShapeCheck | None) -> None:
        """Show self-intersection warnings once known."""
        lost = self_intersection_warnings(state, check)
        self.crossing_signs.setText("\n".join(lost))
        self.crossing_signs.setVisible(bool(lost))

    def show_readings(self, state: State, unit: Unit, active: int) -> None:
        """Show the active handle's motion."""
        self._show_motion(state, unit, active)

    def _show_motion(self, state: State, unit: Unit, active: int) -> None:
        details = self.list.rows[active].details
        if isinstance(details, QLabel):
            details.setText(readings.motion(state, active, unit))
        self.heading.show_reading(readings.motion(state, active, unit), only_folded=True)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        super().set_theme(theme)
        self.list.set_theme(theme)
        self.falloff.set_theme(theme)


def vertex_count_text(count: int) -> str:
    """Number of vertices of a part, or that it is empty."""
    return trn("{n:,} vertex", "{n:,} vertices", int(count)).format(n=count) if count else tr("empty")


class RegionRows(QWidget):
    """Rows of the named regions, with their areas and area targets.

    Attributes
    ----------
    list : PartList
    target_changed : Signal(int, object)
        A region and the area to keep in percent, or None to leave it free.
    """

    target_changed = Signal(int, object)

    def __init__(self) -> None:
        super().__init__()
        self.list = PartList(REGION_COLORS, self._row)
        self.note = quiet_label(tr("Why regions are not kept"), tr("The method Paper only measures regions."))
        self.note.hide()
        column_layout(self.list, self.note, spacing=2, parent=self)

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
        self.note.setVisible(bool(regions) and only_measured)
        self.setVisible(bool(regions))

    def show_readings(self, state: State, unit: Unit) -> None:
        """Show the area of each region."""
        for row, (area, sizes) in zip(self.list.rows, readings.regions(state, unit), strict=False):
            row.reading.setText(area)
            row.reading.setToolTip(tr("Area in percent of its rest area: {sizes}").format(sizes=sizes))

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        self.list.set_theme(theme)


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
