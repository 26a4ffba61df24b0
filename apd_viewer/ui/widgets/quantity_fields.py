"""Number fields for lengths and volumes in any unit, and rows of fields."""

from __future__ import annotations

import re
from contextlib import suppress
from typing import Any

from PySide6.QtWidgets import QLabel, QWidget

from apd_viewer.errors import InputError
from apd_viewer.session.quantities.expressions import parse_length, parse_volume, unambiguous_text
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.widgets.box_layouts import STRETCH, row_layout
from apd_viewer.ui.widgets.fields import NumberField

_WITH_UNIT = re.compile(r"[\d.]\s*(?!e[-+]?\d)[a-zA-Z\"″'′µμ]")  # not the exponent of 1e-3


class LengthField(NumberField):
    """Number field for a length in the unit of the mesh, typed in any unit."""

    def __init__(self, **properties: Any) -> None:
        self._unit = Unit.NONE
        super().__init__(**properties)

    def show_unit(self, unit: Unit) -> None:
        """Set the unit of the mesh."""
        self._unit = unit
        self.setSuffix(unit.format_length(""))

    def _parsed(self, text: str) -> float:
        return parse_length(text, self._unit, {})

    def _digits(self, text: str) -> str:
        digits = super()._digits(text)
        if _WITH_UNIT.search(digits):
            with suppress(InputError):
                return repr(self._parsed(unambiguous_text(self._number_text(text))))
        return digits

    def _problem(self, text: str) -> str:
        digits = super()._digits(text)
        if _WITH_UNIT.search(digits) and not self._is_special(text):
            try:
                self._parsed(unambiguous_text(self._number_text(text)))
            except InputError as error:
                return str(error)
        return super()._problem(text)


class VolumeField(LengthField):
    """Number field for a volume in cubic units of the mesh, typed in any unit."""

    def show_unit(self, unit: Unit) -> None:
        """Set the unit of the mesh."""
        self._unit = unit
        self.setSuffix(unit.format_volume(""))

    def _parsed(self, text: str) -> float:
        return parse_volume(text, self._unit)


def field_row(title: str, field: NumberField, *before: QWidget) -> QWidget:
    """Row with a title on the left, and ``before`` and a field on the right."""
    row = QWidget()
    label = QLabel(title, toolTip=field.toolTip(), buddy=field)
    row_layout(label, STRETCH, *before, field, parent=row, spacing=-1)
    return row
