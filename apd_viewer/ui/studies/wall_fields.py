"""Fields of the wall of a mesh to press: its material, and what follows from it."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QHBoxLayout, QLabel

from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.presentation.number_format import format_editable, format_short
from apd_viewer.session.quantities.ambiguous_numbers import unambiguous_text
from apd_viewer.session.quantities.elastic_wall import (
    DEFAULT_POISSON,
    ElasticWall,
    metres_per_unit,
    parse_poisson_ratio,
    parse_young_modulus,
)
from apd_viewer.session.quantities.expressions import parse_length
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall_mass import parse_density
from apd_viewer.session.quantities.wall_materials import WALL_MATERIALS, yield_radius
from apd_viewer.ui.studies.run_dialog import widget_row
from apd_viewer.ui.widgets.fields import CheckBox, ComboBox, TextField

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
    default_thickness : float
        Distance that walls keep where no thickness is typed, mesh units.
    thickness : float or None
        Thickness at first, mesh units.
    """

    def __init__(self, owner: QObject, unit: Unit, default_thickness: float, thickness: float | None) -> None:
        super().__init__(owner)
        self._unit = unit
        self.material = ComboBox(accessibleName=tr("Material of the wall"))
        self.material.addItem(tr("Custom"), None)
        for material in WALL_MATERIALS:
            self.material.addItem(material.title, material)
        tip = tr(
            "Thickness of the wall, and distance that walls keep: 0.3mm, or a number in the unit of the mesh"
        )
        self.thickness = LengthField(
            tr("Wall thickness"), tip, unit.format_length(format_short(default_thickness)), unit, thickness
        )
        tip = tr("Walls bent to a smaller radius keep a crease: 6mm, or a number in the unit of the mesh")
        self.radius = LengthField(tr("Yield radius"), tip, tr("no creases"), unit)
        self.release = CheckBox(tr("open the plates again, to see what remains"))
        self.air = CheckBox(tr("air that cannot leave, an atmosphere of it"))
        self.air.setToolTip(tr("Openings are capped; needs the wall in newtons"))
        self.young = _entry(tr("Young's modulus"), tr("For loads in newtons: 2.8GPa"), tr("no newtons"))
        self.poisson = _entry(tr("Poisson's ratio"), tr("From 0 to 0.5"), format_short(DEFAULT_POISSON))
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
            (tr("Material"), widget_row(self.material)),
            (tr("Source"), source),
            (tr("Wall thickness"), widget_row(self.thickness)),
            (
                tr("Young's modulus"),
                widget_row(self.young, ratio, self.poisson, heavy, self.density, spacing=8),
            ),
            (tr("Yield radius"), widget_row(self.radius, self.release)),
            (tr("Inside"), widget_row(self.air)),
        )

    def on_change(self, callback: Callable[[], object]) -> None:
        """Call back when what the wall is made of has changed."""
        for field in (self.thickness, self.young, self.poisson):
            field.textChanged.connect(lambda _: callback())

    @property
    def elastic(self) -> ElasticWall | None:
        """The wall in newtons and metres, None where it is not known; raises InputError."""
        metre, thickness = metres_per_unit(self._unit), self.thickness.value
        if not self.young.text().strip():
            return None
        young = parse_young_modulus(unambiguous_text(self.young.text()))
        if thickness is None:
            raise InputError(tr("Newtons need the thickness of the wall as well; enter one such as 0.3mm."))
        if metre is None:
            raise InputError(tr("Newtons need the unit of the mesh; choose it next to the area."))
        typed = unambiguous_text(self.poisson.text().strip())
        return ElasticWall(thickness * metre, young, parse_poisson_ratio(typed) if typed else DEFAULT_POISSON)

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
            "--density": repr(parse_density(unambiguous_text(self.density.text())))
            if self.density.text().strip()
            else "",
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
        self.thickness.setText(f"{format_editable(material.thickness)}mm")
        self.radius.setText(
            ""
            if strain is None
            else f"{format_editable(yield_radius(material.thickness, strain), _DIGITS)}mm"
        )
        self.young.setText("" if material.young is None else f"{format_editable(material.young)}GPa")
        self.poisson.setText("" if material.poisson is None else format_editable(material.poisson))
        self.density.setText("" if material.density is None else f"{format_editable(material.density)} g/cm³")

    def _own(self) -> None:
        self.material.setCurrentIndex(0)


def _entry(name: str, tip: str, usual: str) -> TextField:
    field = TextField(toolTip=tip, placeholderText=usual)
    field.setAccessibleName(name)
    field.setMaximumWidth(110)
    return field


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
