"""Panel section of the obstacles."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QGridLayout, QLabel, QMenu, QPushButton

from apd_viewer.language import tr, trc
from apd_viewer.presentation.obstacle_readings import idle_reason, load_excess_text, load_text, motion_text
from apd_viewer.presentation.palette import OBSTACLE_COLOR
from apd_viewer.session.model.named_obstacle import ObstacleKind
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.obstacles.obstacle_fields import ObstacleFields
from apd_viewer.ui.widgets.box_layouts import add_parts
from apd_viewer.ui.widgets.folding_section import Section, quiet_label
from apd_viewer.ui.widgets.part_row import PartList, PartRow
from apd_viewer.ui.widgets.theme import Theme, icon

if TYPE_CHECKING:
    from apd_viewer.session.model.state import State
    from apd_viewer.session.typed_values import TypedValues

TIPS = {
    ObstacleKind.PLATE: tr("Put a plate that stops the surface, by a click on it"),
    ObstacleKind.SPHERE: tr("Put a sphere that pushes like a finger, by a click on the surface"),
    ObstacleKind.CYLINDER: tr("Put a cylinder with round ends, by a click on the surface"),
}
FLOOR_TIP = tr("Put a plate under the lowest point")
SIDES_TIP = tr("Put two plates that touch the shape on both sides, to press it by hand")


class ObstacleSection(Section):
    """List of the obstacles, fields of the active one, and buttons to add more.

    Attributes
    ----------
    contact : QPushButton
        Turns contact on where obstacles push nothing without it.
    note : QLabel
        Why they push nothing.
    sides_requested : Signal(int)
        Plates on both sides along axis 0, 1 or 2.
    """

    sides_requested = Signal(int)
    contact_requested = Signal()

    def __init__(self) -> None:
        super().__init__(tr("Obstacles"))
        self.empty = quiet_label(tr("About obstacles"))
        self.empty.setText(
            tr(
                "Plates, spheres and cylinders push the surface by contact, without friction; "
                "nothing has to be held."
            )
        )
        self.list = PartList([OBSTACLE_COLOR], self._row)
        self.fields = ObstacleFields()
        self.excess = quiet_label(tr("Expected excess of the loads"))
        self.note = quiet_label(tr("Why obstacles push nothing"))
        self.note.setObjectName("unreached")
        self.contact = QPushButton(tr("Turn contact on"), toolTip=tr("Let the obstacles push the surface"))
        self.contact.clicked.connect(self.contact_requested)
        parts = self.list, self.excess, self.fields, self.note, self.contact
        add_parts(self.column, self.empty, *parts, 4, self._make_buttons())
        for part in parts:
            part.hide()
        self.heading.show_reading(trc("obstacles", "none"), only_folded=True)

    def _make_buttons(self) -> QGridLayout:
        grid = QGridLayout(horizontalSpacing=8, verticalSpacing=4)
        self.kinds = {}
        for column, kind in enumerate(ObstacleKind):
            button = QPushButton(kind.title, toolTip=TIPS[kind])
            button.setAccessibleName(tr("Add {kind}").format(kind=kind.word))
            self.kinds[kind] = button
            grid.addWidget(button, 0, 2 * column, 1, 2)
        self.floor = QPushButton(tr("Floor"), toolTip=FLOOR_TIP, accessibleName=tr("Add floor"))
        self.sides = QPushButton(tr("Both sides"), toolTip=SIDES_TIP, objectName="choice")
        self.sides.setLayoutDirection(Qt.LayoutDirection.RightToLeft)  # places the chevron after the text
        self.sides.setAccessibleName(tr("Plates on both sides"))
        menu = QMenu(self.sides)
        for axis, letter in enumerate("XYZ"):
            asked = menu.addAction(tr("Along {axis}").format(axis=letter))
            asked.triggered.connect(partial(self._ask_sides, axis))
        self.sides.setMenu(menu)
        grid.addWidget(self.floor, 1, 0, 1, 3)
        grid.addWidget(self.sides, 1, 3, 1, 3)
        return grid

    def _ask_sides(self, axis: int) -> None:
        self.sides_requested.emit(axis)

    def _row(self, _k: int, name: str, color: tuple[int, int, int]) -> PartRow:
        details = quiet_label(tr("Motion of {name}").format(name=name))
        details.setIndent(22)
        row = PartRow("obstacle", name, color, details)
        row.buttons.hide()
        return row

    def show_state(self, state: State, unit: Unit, active: int | None, values: TypedValues) -> None:
        """Show the obstacles of a state, and the fields of the active one."""
        obstacles = state.document.obstacles
        self.list.show_names([each.name for each in obstacles], active)
        for k, row in enumerate(self.list.rows):
            row.reading.setText(load_text(state, k))
            if k == active and isinstance(row.details, QLabel):
                row.details.setText(motion_text(state, k, unit))
        self.empty.setVisible(not obstacles)
        self.excess.setText(load_excess_text(state))
        self.excess.setVisible(bool(self.excess.text()))
        self.fields.setVisible(active is not None)
        if active is not None:
            self.fields.show_obstacle(state, active, values)
        self._explain(state)
        self.heading.show_reading(
            f"{len(obstacles)}" if obstacles else trc("obstacles", "none"), only_folded=True
        )

    def _explain(self, state: State) -> None:
        """Show why the obstacles have no effect on the shape, if so."""
        why, there = idle_reason(state), bool(state.document.obstacles)
        self.note.setText(why)
        self.note.setVisible(there and bool(why))
        self.contact.setVisible(there and bool(why) and state.document.settings.traits.may_use_contact)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        super().set_theme(theme)
        self.list.set_theme(theme)
        self.fields.set_theme(theme)
        for button in (*self.kinds.values(), self.floor):
            button.setIcon(icon("add", theme))
        self.sides.setIcon(icon("unfolded", theme))
