"""Field for what is held inside: percent, a volume or a pressure, as typed."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QHideEvent

from apd_viewer.errors import InputError
from apd_viewer.geometry.solver.settings import Settings
from apd_viewer.language import tr
from apd_viewer.presentation.number_format import format_editable, format_pressure
from apd_viewer.session.quantities.expressions import MOST_CHARACTERS
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.volume_target import parse_volume_target
from apd_viewer.session.quantities.wall_material import has_pressure_unit, parse_pressure_difference
from apd_viewer.ui.widgets.fields import ErrorBubble, TextField, return_focus

_ML = 1e3  # per litre
_DIGITS = 6


class VolumeTargetField(TextField):
    """Text field for a target of the volume; invalid input is explained.

    Attributes
    ----------
    valueChanged : Signal(float)
        A percentage was entered.
    entered : Signal(object)
        Another target was entered: changes of settings by name.
    find_pascals : callable
        Pascals of a pressure of 1 in the settings; None where the wall is unknown.
    """

    valueChanged = Signal(float)  # noqa: N815 (as of a spin box)
    entered = Signal(object)

    def __init__(self, **properties: Any) -> None:
        super().__init__(alignment=Qt.AlignmentFlag.AlignRight, maxLength=MOST_CHARACTERS, **properties)
        self.setFixedWidth(84)
        self.error = ErrorBubble(self)
        self.find_pascals: Callable[[], float | None] = lambda: None
        self._value, self._unit_of_mesh, self._is_wall = 100.0, Unit.NONE, False
        self._typed: dict[tuple[str, float], str] = {}
        self._shown = self.text()
        self.textEdited.connect(self.error.hide)
        self.editingFinished.connect(self._enter)
        self.focus_lost.connect(self.error.hide_later)
        self.returnPressed.connect(partial(return_focus, self))

    def hideEvent(self, event: QHideEvent) -> None:
        """Hide the error together with the field."""
        self.error.hide()
        super().hideEvent(event)

    def textFromValue(self, value: float) -> str:
        """Percentage without its sign."""
        return format_editable(value, _DIGITS)

    def suffix(self) -> str:
        """Sign of a percentage."""
        return " %"

    def value(self) -> float:
        """Last percentage."""
        return self._value

    def setValue(self, value: float) -> None:
        """Enter a percentage."""
        self.setText(f"{value!r}%")
        self._enter()

    def show_value(self, value: float) -> None:
        """Show a percentage without emitting a signal."""
        self._value = value
        self._show(f"{self.textFromValue(value)}{self.suffix()}")

    def show_settings(self, settings: Settings) -> None:
        """Show the target among settings; empty without one."""
        self._is_wall = settings.traits.is_wall
        volume, pressure = settings.filled_volume, settings.pressure
        if volume is not None:
            self._show(self._typed.get(("filled_volume", volume)) or self._volume(volume))
        elif pressure is not None and self._is_wall:
            self._show(self._typed.get(("pressure", pressure)) or self._pressure(pressure))
        elif settings.volume is not None:
            self.show_value(settings.volume)
        else:
            self._value = 100.0
            self._show("")

    def show_unit_of_mesh(self, unit: Unit) -> None:
        """Read volumes in a unit of length."""
        self._unit_of_mesh = unit

    def _volume(self, volume: float) -> str:
        litres = self._unit_of_mesh.to_litres(volume)
        if litres is None:
            return self._unit_of_mesh.format_volume(format_editable(volume, _DIGITS))
        return f"{format_editable(_ML * litres, _DIGITS)} ml"

    def _pressure(self, pressure: float) -> str:
        pascals = self.find_pascals()
        return format_editable(pressure, _DIGITS) if pascals is None else format_pressure(pressure * pascals)

    def renewed_pressure(self, settings: Settings, pascals: float | None) -> dict[str, float | None]:
        """Change that keeps the shown pressure, for another wall; empty without one."""
        if settings.pressure is None or pascals is None or not has_pressure_unit(self._shown):
            return {}
        pressure = parse_pressure_difference(self._shown) / pascals
        self._typed["pressure", pressure] = self._shown
        return {} if pressure == settings.pressure else {"pressure": pressure}

    def _show(self, text: str) -> None:
        self._shown = text
        if self.text() != text:
            self.setText(text)

    def _enter(self) -> None:
        text = self.text().strip()
        if text == self._shown or not text:
            self._show(self._shown)
            return
        try:
            changes = self._changes(text)
        except InputError as error:
            self.error.show_message(str(error))
            self._show(self._shown)
            return
        self._shown = text
        self.error.hide()
        if changes["volume"] is not None:
            self.valueChanged.emit(changes["volume"])
            return
        name, value = next((name, value) for name, value in changes.items() if value is not None)
        self._typed[name, value] = text
        self.entered.emit(changes)

    def _changes(self, text: str) -> dict[str, float | None]:
        """Changes of settings, by name, from a text; raises InputError."""
        if not has_pressure_unit(text):
            return {**parse_volume_target(text, self._unit_of_mesh)._asdict(), "pressure": None}
        if not self._is_wall:
            raise InputError(tr("Only the method Wall has a pressure; choose it, or omit the pressure."))
        pascals = self.find_pascals()
        if pascals is None:
            raise InputError(
                tr("A pressure needs thickness and Young's modulus of the wall; enter them in Size and mass.")
            )
        pressure = parse_pressure_difference(text) / pascals
        return {"volume": None, "filled_volume": None, "pressure": pressure}
