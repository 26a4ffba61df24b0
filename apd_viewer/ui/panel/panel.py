"""Side panel: area, page of parts and method, page of measurements."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QGridLayout, QLabel, QPushButton, QSizePolicy, QTabWidget, QWidget

from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.language import tr, translations
from apd_viewer.presentation.number_format import format_grouped
from apd_viewer.presentation.palette import BASE_COLOR, FREE_COLOR, HANDLE_COLORS
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.measuring.measure_section import MeasureSection
from apd_viewer.ui.obstacles.obstacle_section import ObstacleSection
from apd_viewer.ui.panel.area_section import AreaSection, StrainSection, VolumeSection
from apd_viewer.ui.panel.method_section import MethodSection
from apd_viewer.ui.panel.parts_sections import HandleSection, PartsSection, RegionRows
from apd_viewer.ui.panel.size_section import SizeSection
from apd_viewer.ui.posing.pose_section import PoseSection
from apd_viewer.ui.target.target_section import TargetSection
from apd_viewer.ui.tools.tool_modes import Tool
from apd_viewer.ui.widgets.box_layouts import add_parts, column_layout
from apd_viewer.ui.widgets.folding_section import PanelPage, Section, reveal_widget
from apd_viewer.ui.widgets.part_row import Swatch
from apd_viewer.ui.widgets.slider_field import SliderField
from apd_viewer.ui.widgets.theme import Theme
from apd_viewer.ui.widgets.wheel import ignore_wheel

if TYPE_CHECKING:
    from apd_viewer.session.model.document import Document
    from apd_viewer.session.model.state import State
    from apd_viewer.session.session import Session
    from apd_viewer.session.state_store import StateStore

_WIDTH = 328  # px: fits a region with a target, so that adding one does not resize the view
_ROW = 22  # px: height of a row of counts
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter


class PaintSection(Section):
    """Counts of base, handle and free vertices."""

    def __init__(self) -> None:
        super().__init__(tr("Vertices"))
        grid = QGridLayout(horizontalSpacing=8, verticalSpacing=0)
        grid.setColumnStretch(1, 1)
        self._counts = []
        for row, (name, tip, color) in enumerate(
            (
                (tr("Base"), tr("Vertices: base"), BASE_COLOR),
                (tr("Handles"), tr("Vertices: handles"), HANDLE_COLORS[0]),
                (tr("Free"), tr("Vertices: free"), FREE_COLOR),
            )
        ):
            count = QLabel("–", accessibleName=tip, toolTip=tip, alignment=_RIGHT)
            grid.addWidget(Swatch(color), row, 0)
            grid.addWidget(QLabel(name, objectName="quiet"), row, 1)
            grid.addWidget(count, row, 2)
            grid.setRowMinimumHeight(row, _ROW)
            self._counts.append(count)
        self.column.addLayout(grid)
        self.clear_all = QPushButton(tr("Clear all"), toolTip=tr("Clear base, handles and regions"))
        add_parts(self.column, 4, self.clear_all)

    def show_settings(self, document: Document) -> None:
        """Show the counts of base, handle and free vertices."""
        counts = document.label_counts
        for field, count in zip(
            self._counts, (counts[BASE], counts[HANDLE:].sum(), counts[FREE]), strict=True
        ):
            field.setText(format_grouped(count, 0))
        self.clear_all.setEnabled(bool(counts[FREE] < counts.sum() or document.member.any()))


class Panel(QWidget):
    """Side panel: the area, above a page of settings and a page of measurements.

    Attributes
    ----------
    area : AreaSection
        In sight on both pages.
    parts, handles, obstacles, method, poses
        Sections of the first page.
    volume, strain, measures, measure, target, paint
        Sections of the second page.
    regions : RegionRows
        Among the parts.
    deform, measurements : PanelPage
    pages : QTabWidget
    """

    def __init__(self) -> None:
        super().__init__(objectName="sidebar")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self.setMinimumWidth(_WIDTH)
        self.setSizePolicy(QSizePolicy.Policy.Minimum, QSizePolicy.Policy.Expanding)
        self.area = AreaSection()
        self.volume = VolumeSection()
        self.strain = StrainSection()
        self.measures = SizeSection()
        self.handles = HandleSection()
        self.obstacles = ObstacleSection()
        self.poses = PoseSection()
        self.method = MethodSection((self.area.target, self.volume.target, self.volume.disabled_note))
        self.regions = RegionRows()
        self.parts = PartsSection((self.handles.list, self.regions, self.obstacles.list))
        self.measure = MeasureSection()
        self.target = TargetSection()
        self.paint = PaintSection()
        # The keys identify the sections in the settings, independent of language and titles.
        done: dict[str, Section] = {
            "Parts": self.parts,
            "Handles": self.handles,
            "Obstacles": self.obstacles,
            "Method": self.method,
            "Poses": self.poses,
        }
        read: dict[str, Section] = {
            "Volume": self.volume,
            "Strain": self.strain,
            "Size and mass": self.measures,
            "Measure": self.measure,
            "Target shape": self.target,
            "Vertices": self.paint,
        }
        self._named = done | read
        self.deform, self.measurements = PanelPage(*done.values()), PanelPage(*read.values())
        self._lay_out()
        self.unit = Unit.NONE
        self._previews = False

    def _lay_out(self) -> None:
        self.pages = QTabWidget(documentMode=True)
        self.pages.addTab(self.deform, tr("Deform"))
        self.pages.addTab(self.measurements, tr("Measurements"))
        self.pages.tabBar().setDrawBase(False)
        ignore_wheel(self.pages.tabBar())
        head = QWidget(objectName="panel")
        column_layout(self.area, parent=head)
        column_layout(head, self.pages, spacing=0, margins=(1, 0, 0, 0), parent=self)

    @property
    def sections(self) -> tuple[Section, ...]:
        """All folding sections, from top to bottom."""
        return tuple(self._named.values())

    @property
    def slider_fields(self) -> tuple[SliderField, ...]:
        """All fields with a slider."""
        return self.area.target, self.volume.target, self.method.stiffness, self.handles.falloff

    def show_state(self, old: State | None, new: State, handle: int, region: int) -> None:
        """Update the readings changed between two states, and the active parts."""
        asked_anew = old is None or old.document is not new.document
        if asked_anew:
            self.area.show_settings(new)
            self.volume.show_settings(new)
            self.target.show_settings(new.document)
            self.method.show_settings(new.document)
            self.show_parts(new, handle, region)
        if old is None or old.document is not new.document:
            self.paint.show_settings(new.document)
            self.parts.show_settings(new.document)
        if asked_anew or old is None or old.frame is not new.frame:
            targets = old is None or old.document.target_percentages != new.document.target_percentages
            anew = targets or old is None or old.document.settings.method != new.document.settings.method
            self._show_readings(new, handle, anew)

    def _show_readings(self, state: State, handle: int, asked_anew: bool) -> None:
        if not self._previews:
            self.area.show_readings(state, self.unit, asked_anew)
            self._show_shape(state)
        self.measures.show_readings(state, self.unit)
        self.target.show_readings(state, self.unit)
        self.handles.show_readings(state, self.unit, handle)
        self.regions.show_readings(state, self.unit)

    def _show_shape(self, state: State) -> None:
        self.volume.show_readings(state, self.unit)
        self.strain.show_readings(state, self.unit)

    @property
    def unit(self) -> Unit:
        """Unit of the readings, applied when the next state is shown."""
        return self._unit

    @unit.setter
    def unit(self, unit: Unit) -> None:
        self._unit = unit
        self.area.unit.show_unit(unit)
        self.method.show_unit(unit)
        self.volume.target.field.show_unit_of_mesh(unit)
        self.handles.motion.show_unit(unit)

    def show_in_unit(self, unit: Unit, state: State, handle: int, region: int) -> None:
        """Show the readings of a state in another unit."""
        self.unit = unit
        self.show_parts(state, handle, region)
        self._show_readings(state, handle, asked_anew=False)

    def show_parts(self, state: State, handle: int, region: int) -> None:
        """Show the handles and regions, and the active ones."""
        self.handles.show_settings(state, self.unit, handle)
        self.regions.show_settings(state, region)

    def highlight_edited_part(self, tool: Tool, obstacle: int | None) -> None:
        """Highlight the active row of the parts that a tool edits; show its motion."""
        moves_obstacle = tool is Tool.MOVE and obstacle is not None
        self.obstacles.list.set_highlighted(moves_obstacle)
        self.regions.list.set_highlighted(tool is Tool.REGION)
        self.handles.list.set_highlighted(not moves_obstacle and tool is not Tool.REGION)
        self.handles.set_resting(moves_obstacle)

    def cancel_slider_drag(self) -> bool:
        """Cancel a slider drag in progress; True if there was one."""
        return any(dial.slider.cancel_drag() for dial in self.slider_fields)

    def show_status(self, session: Session) -> None:
        """Show the solver's activity and enable the applicable controls."""
        state = session.store.state
        self.setEnabled(state is not None)
        self.handles.reset_all.setEnabled(state is not None and not state.is_at_rest)
        if state is None:
            self.area.activity.setText("")
        else:
            self.area.show_activity(state, session)
            self._show_preview(state, session.store)

    def _show_preview(self, state: State, store: StateStore) -> None:
        """Hide area and volume while the shape is only a preview."""
        if store.is_previewing:
            self.area.show_preview(store.compiled_fraction or 0.0)
            self.volume.show_preview()
            self.strain.show_preview()
        elif self._previews:
            self.area.show_readings(state, self.unit, targets_changed=False)
            self._show_shape(state)
        self._previews = store.is_previewing

    def focus_motion_field(self) -> None:
        """Focus the motion field of the handle or obstacle in the hand."""
        field = self.obstacles.fields.distance if self.handles.is_resting else self.handles.motion.amount
        reveal_widget(field)
        field.setFocus(Qt.FocusReason.ShortcutFocusReason)
        field.selectAll()

    def focus_wall_fields(self) -> None:
        """Unfold the section of the wall and focus the material."""
        self.measures.reveal()
        self.window().activateWindow()
        self.measures.wall_fields.material.setFocus(Qt.FocusReason.ShortcutFocusReason)

    @property
    def folded_sections(self) -> list[str]:
        """Names of the folded sections."""
        return [name for name, section in self._named.items() if section.is_folded]

    @folded_sections.setter
    def folded_sections(self, names: list[str]) -> None:
        titles = set(names) - set(self._named)  # older settings contain translated titles
        for name, section in self._named.items():
            section.is_folded = name in names or bool(titles and titles & translations(name))

    def set_theme(self, theme: Theme) -> None:
        """Apply the theme to the parts not covered by the style sheet."""
        self.area.set_theme(theme)
        self.regions.set_theme(theme)
        for section in self.sections:
            section.set_theme(theme)
