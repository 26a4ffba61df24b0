"""Fields of the wall of a mesh to press: its material, and what follows from it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QHBoxLayout, QLabel

from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.presentation.number_format import short, to_type
from apd_viewer.session.quantities.clear_numbers import as_typed
from apd_viewer.session.quantities.elastic_wall import (
    DEFAULT_POISSON,
    ElasticWall,
    metres,
    poisson_ratio,
    young_modulus,
)
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall_mass import density
from apd_viewer.session.quantities.wall_materials import WALL_MATERIALS, yield_radius
from apd_viewer.ui.studies.length_field import LengthField
from apd_viewer.ui.studies.study_dialog import row_of
from apd_viewer.ui.widgets.fields import Check, Choice, Entry

if TYPE_CHECKING:
    from collections.abc import Callable

_DIGITS, _AIR = 3, "1atm"
_OWN = tr("your own numbers")


class WallFields(QObject):
    """Material, thickness, elasticity and creases of a wall.

    A material fills in the other fields; where one of them is typed, it is a material of the user's own.

    Parameters
    ----------
    owner : QObject
    unit : Unit
        Of the mesh.
    usual : float
        Distance that walls keep where no thickness is typed, mesh units.
    given : float or None
        Thickness at first, mesh units.
    """

    def __init__(self, owner: QObject, unit: Unit, usual: float, given: float | None) -> None:
        super().__init__(owner)
        self._unit = unit
        self.material = Choice(accessibleName=tr("Material of the wall"))
        self.material.addItem(tr("Custom"), None)
        for material in WALL_MATERIALS:
            self.material.addItem(material.title, material)
        tip = tr(
            "Thickness of the wall, and distance that walls keep: 0.3mm, or a number in the unit of the mesh"
        )
        self.thickness = LengthField(tr("Wall thickness"), tip, unit.length(short(usual)), unit, given)
        tip = tr("Walls bent to a smaller radius keep a crease: 6mm, or a number in the unit of the mesh")
        self.radius = LengthField(tr("Yield radius"), tip, tr("no creases"), unit)
        self.release = Check(tr("open the plates again, to see what remains"))
        self.air = Check(tr("air that cannot leave, an atmosphere of it"))
        self.air.setToolTip(tr("Openings are capped; needs the wall in newtons"))
        self.young = _entry(tr("Young's modulus"), tr("For loads in newtons: 2.8GPa"), tr("no newtons"))
        self.poisson = _entry(tr("Poisson's ratio"), tr("From 0 to 0.5"), short(DEFAULT_POISSON))
        self.density = _entry(tr("Density"), tr("For the mass: 1.38 g/cm³"), tr("no mass"))
        self.source = QLabel(_OWN, objectName="quiet", wordWrap=True)
        self.material.currentIndexChanged.connect(self._fill)
        for field in (self.thickness, self.radius, self.young, self.poisson, self.density):
            field.textEdited.connect(self._own)

    @property
    def rows(self) -> tuple[tuple[str, QHBoxLayout], ...]:
        """Rows for a dialog, each with its title."""
        source = QHBoxLayout()
        source.addWidget(self.source, 1)
        ratio, heavy = QLabel(tr("Poisson's ratio")), QLabel(tr("Density"))
        return (
            (tr("Material"), row_of(self.material)),
            (tr("Source"), source),
            (tr("Wall thickness"), row_of(self.thickness)),
            (tr("Young's modulus"), row_of(self.young, ratio, self.poisson, heavy, self.density, spacing=8)),
            (tr("Yield radius"), row_of(self.radius, self.release)),
            (tr("Inside"), row_of(self.air)),
        )

    def when_changed(self, call: Callable[[], object]) -> None:
        """Call back when what the wall is made of has changed."""
        for field in (self.thickness, self.young, self.poisson):
            field.textChanged.connect(lambda _: call())

    @property
    def elastic(self) -> ElasticWall | None:
        """The wall in newtons and metres, None where it is not known; raises InputError."""
        metre, thickness = metres(self._unit), self.thickness.value
        if not self.young.text().strip():
            return None
        young = young_modulus(as_typed(self.young.text()))
        if thickness is None:
            raise InputError(tr("Newtons need the thickness of the wall as well; enter one such as 0.3mm."))
        if metre is None:
            raise InputError(tr("Newtons need the unit of the mesh; choose it next to the area."))
        typed = as_typed(self.poisson.text().strip())
        return ElasticWall(thickness * metre, young, poisson_ratio(typed) if typed else DEFAULT_POISSON)

    @property
    def options(self) -> dict[str, str]:
        """Options of the command; raises InputError."""
        elastic, thickness, radius = self.elastic, self.thickness.value, self.radius.value
        if self.air.isChecked() and elastic is None:
            raise InputError(
                tr("Air inside needs the wall in newtons; choose a material or type its modulus.")
            )
        said = {
            "--unit": self._unit.symbol,
            "--thickness": "" if thickness is None else repr(thickness),
            "--yield-radius": "" if radius is None else repr(radius),
            "--young": self.young.text().strip() if elastic else "",
            "--poisson": self.poisson.text().strip() if elastic else "",
            "--gas": _AIR if self.air.isChecked() else "",
            "--density": repr(density(as_typed(self.density.text()))) if self.density.text().strip() else "",
            "--material": getattr(self.material.currentData(), "name", ""),
        }
        return {option: text for option, text in said.items() if text}

    def _fill(self) -> None:
        """Fill in what the material has."""
        material = self.material.currentData()
        self.source.setText(_OWN if material is None else material.source)
        if material is None:
            return
        strain = material.yield_strain
        self.thickness.setText(f"{to_type(material.thickness)}mm")
        self.radius.setText(
            "" if strain is None else f"{to_type(yield_radius(material.thickness, strain), _DIGITS)}mm"
        )
        self.young.setText("" if material.young is None else f"{to_type(material.young)}GPa")
        self.poisson.setText("" if material.poisson is None else to_type(material.poisson))
        self.density.setText("" if material.density is None else f"{to_type(material.density)} g/cm³")

    def _own(self) -> None:
        self.material.setCurrentIndex(0)


def _entry(name: str, tip: str, usual: str) -> Entry:
    field = Entry(toolTip=tip, placeholderText=usual)
    field.setAccessibleName(name)
    field.setMaximumWidth(110)
    return field
