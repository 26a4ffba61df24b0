"""Field for the distance that walls keep."""

from __future__ import annotations

from typing import TYPE_CHECKING

from apd_viewer.geometry.contact.mesh_contact import thickness_of
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.language import tr
from apd_viewer.presentation.number_format import short
from apd_viewer.session.quantities.expressions import length
from apd_viewer.ui.widgets.fields import Entry

if TYPE_CHECKING:
    import numpy as np

    from apd_viewer.session.quantities.units import Unit


class ThicknessField(Entry):
    """Wall thickness as typed; an empty field stands for the usual one.

    Parameters
    ----------
    thickness : float or None
        At first, mesh units.
    points : (k, 3) float array
        Of the mesh, whose size decides the usual one.
    unit : Unit
        Of the mesh.
    """

    def __init__(self, thickness: float | None, points: np.ndarray, unit: Unit) -> None:
        tip = tr("Distance that walls keep: 0.3mm, or a number in the unit of the mesh")
        usual = unit.length(short(thickness_of(diagonal(points), None)))
        super().__init__(toolTip=tip, placeholderText=usual)
        self._unit = unit
        self.setAccessibleName(tr("Wall thickness"))
        self.setMaximumWidth(110)
        self.setText("" if thickness is None else f"{thickness:.12g}")

    @property
    def value(self) -> float | None:
        """Thickness in mesh units, None where nothing was typed; raises InputError."""
        text = self.text()
        return length(text, self._unit, {}) if text.strip() else None
