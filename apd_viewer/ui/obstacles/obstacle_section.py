"""Panel section of the obstacles, with fields of the active one."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QFocusEvent, QHideEvent
from PySide6.QtWidgets import QGridLayout, QLabel, QPushButton, QWidget

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import checked_direction, frozen
from apd_viewer.language import tr, trc
from apd_viewer.notation import editable_number
from apd_viewer.presentation import obstacle_readings
from apd_viewer.presentation.number_format import format_editable
from apd_viewer.presentation.palette import OBSTACLE_COLOR
from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.widgets.box_layouts import add_parts, row_layout
from apd_viewer.ui.widgets.fields import ComboBox, ErrorBubble, TextField, return_focus, small_button
from apd_viewer.ui.widgets.folding_section import Section, quiet_label
from apd_viewer.ui.widgets.part_row import PartList, PartRow
from apd_viewer.ui.widgets.theme import Theme, icon

if TYPE_CHECKING:
    from apd_viewer.session.model.state import State
    from apd_viewer.session.quantities.newton_conversion import NewtonConversion
    from apd_viewer.session.typed_values import TypedValues

TIPS = {
    ObstacleKind.PLATE: tr("Add a plate that stops the surface where you click"),
    ObstacleKind.SPHERE: tr("Add a sphere that pushes like a finger where you click"),
    ObstacleKind.CYLINDER: tr("Add a cylinder with round ends where you click"),
}
FLOOR_TIP = tr("Add a plate under the lowest point")
SIDES_TIP = tr("Add two plates that touch the shape on both sides, to press it by hand")


class ObstacleSection(Section):
    """Fields of the active obstacle, and the reason if obstacles have no effect.

    It is hidden without an obstacle.

    Attributes
    ----------
    list : PartList
        Of all obstacles; laid out among the parts.
    contact : QPushButton
        Turns contact on where obstacles push nothing without it.
    note : QLabel
        Reason for obstacles without effect.
    """

    contact_requested = Signal()

    def __init__(self) -> None:
        super().__init__(tr("Obstacles"))
        self.list = PartList([OBSTACLE_COLOR], self._row)
        self.fields = ObstacleFields()
        self.excess = quiet_label(tr("Expected excess of the loads"))
        self.note = quiet_label(tr("Why obstacles push nothing"), style="unreached")
        self.contact = QPushButton(tr("Turn contact on"), toolTip=tr("Let the obstacles push the surface"))
        self.contact.clicked.connect(self.contact_requested)
        parts = self.excess, self.fields, self.note, self.contact
        add_parts(self.column, *parts)
        for part in (self, self.list, *parts):
            part.hide()

    def _row(self, _k: int, name: str, color: tuple[int, int, int]) -> PartRow:
        details = quiet_label(tr("Motion of {name}").format(name=name), indent=22)
        row = PartRow("obstacle", name, color, details)
        row.buttons.hide()
        return row

    def show_state(
        self,
        state: State,
        unit: Unit,
        active: int | None,
        values: TypedValues,
        newtons: NewtonConversion | None = None,
    ) -> None:
        """Show obstacles with their loads, and the fields of the active one."""
        obstacles = state.document.obstacles
        tip = obstacle_readings.force_tip(newtons, obstacle_readings.LOAD_TIP)
        self.list.show_names([each.name for each in obstacles], active)
        for k, row in enumerate(self.list.rows):
            row.reading.setText(obstacle_readings.load_text(state, k, newtons))
            row.reading.setToolTip(tip)
            if k == active and isinstance(row.details, QLabel):
                row.details.setText(obstacle_readings.motion_text(state, k, unit))
        self.setVisible(bool(obstacles))
        self.excess.setText(obstacle_readings.load_excess_text(state, newtons))
        self.excess.setVisible(bool(self.excess.text()))
        self.fields.setVisible(active is not None)
        if active is not None:
            self.fields.show_obstacle(state, active, values)
            self.fields.show_unit(unit)
        self._show_idle_reason(state)
        self.heading.show_reading(f"{len(obstacles)}", only_folded=True)

    def _show_idle_reason(self, state: State) -> None:
        """Show why the obstacles have no effect on the shape, if so."""
        why, there = obstacle_readings.inactive_reason(state), bool(state.document.obstacles)
        self.note.setText(why)
        self.note.setVisible(there and bool(why))
        self.contact.setVisible(there and bool(why) and state.document.settings.traits.may_use_contact)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        super().set_theme(theme)
        self.list.set_theme(theme)
        self.fields.set_theme(theme)


_AXIS = {
    ObstacleKind.PLATE: (tr("Normal"), tr("Direction to the side that stays free: three numbers")),
    ObstacleKind.SPHERE: (tr("Direction"), tr("Direction of the motion: three numbers")),
    ObstacleKind.CYLINDER: (tr("Axis"), tr("Direction of the axis: three numbers")),
}
_DIGITS = 5  # significant digits shown; unedited values keep full precision
_PLACE = tr("Place: three lengths such as 0, 0.5Y, 12mm; X, Y, Z, L and D are sizes of the mesh")
_BY = tr("Distance to move, such as 12, 0.1L or 5mm; Enter moves the obstacle")


class ObstacleFields(QWidget):
    """Fields for the position, direction and size of an obstacle, and its motion.

    Attributes
    ----------
    along : ComboBox
        Direction of the distance: the obstacle's axis, or one of the mesh.
    obstacle_entered : Signal(NamedObstacle)
        The obstacle as typed, to be placed anew.
    distance_entered : Signal(object, str)
        The axis of the mesh to move along, or None for its own, and the distance.
    problem : ErrorBubble
        Error in the typed distance.
    """

    obstacle_entered = Signal(object)
    distance_entered = Signal(object, str)
    reset_requested = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._shown: NamedObstacle | None = None
        self._values: TypedValues | None = None
        self.place = EnteredField(tr("Place of the obstacle"), _PLACE)
        self.axis = EnteredField(tr("Direction of the obstacle"), "")
        self.radius = EnteredField(tr("Radius of the obstacle"), tr("A length such as 12, 0.1L or 5mm"))
        self.length = EnteredField(
            tr("Length of the cylinder"), tr("Between the centres of its round ends, such as 12, 0.1L or 5mm")
        )
        self._fields = self.place, self.axis, self.radius, self.length
        for field in self._fields:
            field.value_entered.connect(self._type)
        self._labels = [
            QLabel(text, objectName="quiet") for text in (tr("Place"), "", tr("Radius"), tr("Length"))
        ]
        self._make_distance()
        self.reset = small_button(tr("Reset obstacle"), tr("Return the obstacle to its initial place"))
        self.reset.clicked.connect(self.reset_requested)
        grid = QGridLayout(horizontalSpacing=8, verticalSpacing=4)
        for row, (label, field) in enumerate(zip(self._labels, self._fields, strict=True)):
            grid.addWidget(label, row, 0)
            grid.addWidget(field, row, 1)
        row = len(self._fields)
        grid.addWidget(QLabel(trc("amount", "Move by"), objectName="quiet"), row, 0)
        grid.addLayout(row_layout((self.distance, 1), self.reset), row, 1)
        grid.addWidget(self.along, row + 1, 1)
        grid.setColumnStretch(1, 1)
        grid.setContentsMargins(0, 4, 0, 4)
        self.setLayout(grid)

    def _make_distance(self) -> None:
        self.distance = TextField(
            accessibleName=tr("Distance"), placeholderText=editable_number("0.1") + "L", toolTip=_BY
        )
        self.problem = ErrorBubble(self.distance)
        self.distance.textChanged.connect(self.problem.hide)  # also when Esc restores the text
        self.distance.focus_lost.connect(self.problem.hide_later)
        self.distance.returnPressed.connect(self._move)
        self.along = ComboBox(accessibleName=tr("Direction of the distance"), toolTip=_BY)
        self.along.addItem("", None)
        for axis, letter in enumerate("XYZ"):
            self.along.addItem(tr("along {axis}").format(axis=letter), axis)

    def show_obstacle(self, state: State, k: int, values: TypedValues) -> None:
        """Show obstacle ``k`` of a state; ``values`` parses the typed texts."""
        obstacle, size = state.document.obstacles[k], float(max(state.inspection.size))
        self._values = values
        self._shown = obstacle.with_shift_applied(state.obstacle_shifts[k])
        kind = obstacle.kind
        title, tip = _AXIS[kind]
        self._labels[1].setText(title)
        self.axis.setToolTip(tip)
        self.along.setItemText(0, tr("along normal") if kind is ObstacleKind.PLATE else tr("along axis"))
        if kind is ObstacleKind.SPHERE:
            self.along.setItemText(0, tr("in direction"))
        self.place.show_text(obstacle_readings.coordinates_text(self._shown.place, size, _DIGITS))
        self.axis.show_text(obstacle_readings.coordinates_text(obstacle.axis, digits=_DIGITS - 1))
        self.radius.show_text(format_editable(obstacle.radius, _DIGITS))
        self.length.show_text(format_editable(obstacle.length, _DIGITS))
        for part in (self._labels[2], self.radius):
            part.setVisible(kind is not ObstacleKind.PLATE)
        for part in (self._labels[3], self.length):
            part.setVisible(kind is ObstacleKind.CYLINDER)
        self.reset.setEnabled(bool(obstacle.shift.any()))

    def show_unit(self, unit: Unit) -> None:
        """Show the unit of the lengths."""
        for field in (self.place, self.radius, self.length, self.distance):
            field.show_unit(unit.format_length("").strip())

    def show_error(self, sentence: str) -> None:
        """Show an input error below the edited field."""
        field = next((field for field in self._fields if field.is_changed), self.place)
        field.show_error(sentence)

    def show_distance_error(self, sentence: str) -> None:
        """Show an input error below the distance field."""
        self.problem.show_message(sentence)
        self.distance.selectAll()

    def finish_entry(self) -> None:
        """Hide the error and return the focus after a motion, so that Ctrl+Z undoes it."""
        self.problem.hide()
        return_focus(self.distance)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icon."""
        self.reset.setIcon(icon("reset", theme))

    def _type(self) -> None:
        field = self.sender()
        assert isinstance(field, EnteredField)
        try:
            obstacle = self._edited_obstacle()
        except InputError as error:
            field.show_error(str(error))
        else:
            self.obstacle_entered.emit(obstacle)

    def _edited_obstacle(self) -> NamedObstacle:
        """Obstacle with the edited values; all others keep their full precision."""
        assert self._shown is not None
        assert self._values is not None
        obstacle, values = self._shown, self._values
        if self.place.is_changed:
            obstacle = replace(obstacle, place=frozen(values.parse_point(self.place.text())))
        if self.axis.is_changed:
            obstacle = replace(
                obstacle, axis=frozen(checked_direction(values.parse_vector(self.axis.text())))
            )
        if self.radius.is_changed:
            obstacle = replace(obstacle, radius=_positive_length(values.parse_length(self.radius.text())))
        if self.length.is_changed:
            obstacle = replace(obstacle, length=_positive_length(values.parse_length(self.length.text())))
        return obstacle

    def _move(self) -> None:
        self.distance_entered.emit(self.along.currentData(), self.distance.text())


def _positive_length(length: float) -> float:
    if not 0.0 < length < np.inf:
        raise InputError(tr("Enter a length greater than 0."))
    return length


class EnteredField(TextField):
    """Line edit for a value; emits an edited one on Enter or loss of focus."""

    value_entered = Signal()

    def __init__(self, name: str, tip: str) -> None:
        super().__init__(accessibleName=name, toolTip=tip)
        self._shown = ""
        self.error = ErrorBubble(self)
        self.textEdited.connect(self.error.hide)
        self.returnPressed.connect(self._enter)

    @property
    def is_changed(self) -> bool:
        """True if the text was edited since the value was shown."""
        return self.text() != self._shown

    def show_text(self, text: str) -> None:
        """Show a value, but keep an edit in progress if the shown value is unchanged."""
        if not (self.hasFocus() and self.is_changed and text == self._shown):
            self._shown = text
            if self.text() != text:
                self.setText(text)
                self.setCursorPosition(0)

    def show_error(self, sentence: str) -> None:
        """Show an error below the field; the text stays while the field has the focus."""
        self.error.show_message(sentence)
        if self.hasFocus():
            self.selectAll()
        else:
            self.setText(self._shown)
            self.error.hide_later()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Emit an edited value."""
        super().focusOutEvent(event)
        if self.is_changed and event.reason() is not Qt.FocusReason.PopupFocusReason:
            self.value_entered.emit()
        self.error.hide_later()

    def restore(self) -> None:
        """Show the current value again and hide the error."""
        self.setText(self._shown)  # the value may have changed since the field got the focus
        self.error.hide()

    def hideEvent(self, event: QHideEvent) -> None:
        """Hide the error together with the field."""
        self.error.hide()
        super().hideEvent(event)

    def _enter(self) -> None:
        if self.is_changed:
            self.value_entered.emit()
        if not self.error.isVisible():
            return_focus(self)
