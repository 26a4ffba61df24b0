"""Field for a length that need not be given."""

from __future__ import annotations

from apd_viewer.presentation.number_format import format_editable
from apd_viewer.session.quantities.ambiguous_numbers import unambiguous_text
from apd_viewer.session.quantities.expressions import parse_length
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.widgets.fields import TextField


class LengthField(TextField):
    """Length as typed; an empty field stands for the usual one, or for none.

    Parameters
    ----------
    name, tip, placeholder : str
        Its accessible name, its tip, and the words of an empty field.
    unit : Unit
        Of the mesh.
    length : float or None
        At first, mesh units.
    """

    def __init__(
        self, name: str, tip: str, placeholder: str, unit: Unit, length: float | None = None
    ) -> None:
        super().__init__(toolTip=tip, placeholderText=placeholder)
        self._unit = unit
        self.setAccessibleName(name)
        self.setMaximumWidth(110)
        self.setText("" if length is None else format_editable(length, 12))

    @property
    def value(self) -> float | None:
        """Length in mesh units, None where nothing was typed; raises InputError."""
        text = self.text()
        return parse_length(unambiguous_text(text), self._unit, {}) if text.strip() else None
