"""Field for a length that need not be given."""

from __future__ import annotations

from typing import TYPE_CHECKING

from apd_viewer.presentation.number_format import to_type
from apd_viewer.session.quantities.clear_numbers import as_typed
from apd_viewer.session.quantities.expressions import length
from apd_viewer.ui.widgets.fields import Entry

if TYPE_CHECKING:
    from apd_viewer.session.quantities.units import Unit


class LengthField(Entry):
    """Length as typed; an empty field stands for the usual one, or for none.

    Parameters
    ----------
    name, tip, usual : str
        Its accessible name, its tip, and the words of an empty field.
    unit : Unit
        Of the mesh.
    given : float or None
        At first, mesh units.
    """

    def __init__(self, name: str, tip: str, usual: str, unit: Unit, given: float | None = None) -> None:
        super().__init__(toolTip=tip, placeholderText=usual)
        self._unit = unit
        self.setAccessibleName(name)
        self.setMaximumWidth(110)
        self.setText("" if given is None else to_type(given, 12))

    @property
    def value(self) -> float | None:
        """Length in mesh units, None where nothing was typed; raises InputError."""
        text = self.text()
        return length(as_typed(text), self._unit, {}) if text.strip() else None
