"""Fields for the wall of a mesh to press: material and derived properties."""

from collections.abc import Callable

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QHBoxLayout, QLabel

from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.presentation.number_format import format_editable, format_short
from apd_viewer.session.quantities.expressions import unambiguous_text
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import Wall, WallText, wall_from
from apd_viewer.session.quantities.wall_material import DEFAULT_POISSON, WALL_MATERIALS
from apd_viewer.ui.widgets.box_layouts import STRETCH, row_layout
from apd_viewer.ui.widgets.fields import CheckBox, ComboBox, TextField

_DIGITS, _AIR = 3, "1atm"
_OWN = tr("your own numbers")


class WallFields(QObject):
    """Fields for material, thickness, elasticity and creases of a wall.

    A material fills in the other fields; where one of them is typed, it is a material of the user's own.

    Parameters
    ----------
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
        usual = unit.format_length(format_short(default_thickness))
        self.thickness = _entry(tr("Wall thickness"), tip, usual)
        self.thickness.setText("" if thickness is None else format_editable(thickness, 12))
        tip = tr("Walls bent to a smaller radius keep a crease: 6mm, or a number in the unit of the mesh")
        self.radius = _entry(tr("Yield radius"), tip, tr("no creases"))
        self.release = CheckBox(tr("open the plates again, to see what remains"))
        self.air = CheckBox(tr("air that cannot leave, an atmosphere of it"))
        self.air.setToolTip(tr("Openings are capped; needs the wall in newtons"))
        self.young = _entry(tr("Young's modulus"), tr("For loads in newtons: 2.8GPa"), tr("no newtons"))
        self.poisson = _entry(tr("Poisson's ratio"), tr("From 0 to 0.5"), format_short(DEFAULT_POISSON))
        self.density = _entry(tr("Density"), tr("For the mass: 1.38 g/cm³"), tr("no mass"))
        self.source = QLabel(_OWN, objectName="quiet", wordWrap=True)
        self.material.currentIndexChanged.connect(self._fill)
        for field in (self.thickness, self.radius, self.young, self.poisson, self.density):
            field.textEdited.connect(self._choose_own_material)

    @property
    def rows(self) -> tuple[tuple[str, QHBoxLayout], ...]:
        """Titled rows of fields for a dialog."""
        ratio, heavy = QLabel(tr("Poisson's ratio")), QLabel(tr("Density"))
        return (
            (tr("Material"), row_layout(self.material, STRETCH, spacing=16)),
            (tr("Source"), row_layout((self.source, 1))),
            (tr("Wall thickness"), row_layout(self.thickness, STRETCH, spacing=16)),
            (
                tr("Young's modulus"),
                row_layout(self.young, ratio, self.poisson, heavy, self.density, STRETCH),
            ),
            (tr("Yield radius"), row_layout(self.radius, self.release, STRETCH, spacing=16)),
            (tr("Inside"), row_layout(self.air, STRETCH, spacing=16)),
        )

    def on_change(self, callback: Callable[[], object]) -> None:
        """Register a callback for edits of thickness, Young's modulus or Poisson's ratio."""
        for field in (self.thickness, self.young, self.poisson):
            field.textChanged.connect(lambda _: callback())

    @property
    def value(self) -> Wall:
        """Wall as typed; raises InputError."""
        fields = (self.thickness, self.density, self.young, self.poisson, self.radius)
        thickness, density, young, poisson, radius = (
            unambiguous_text(field.text().strip()) for field in fields
        )
        text = WallText(thickness, density, young, poisson if young else "", radius)
        wall = wall_from(text, self._unit)
        if young and wall.thickness is None:
            raise InputError(tr("Newtons need the thickness of the wall as well; enter one such as 0.3mm."))
        if young and self._unit is Unit.NONE:
            raise InputError(tr("Newtons need the unit of the mesh; choose it next to the area."))
        return wall

    @property
    def options(self) -> dict[str, str]:
        """Command options of the wall; raises InputError."""
        wall, young = self.value, self.young.text().strip()
        if self.air.isChecked() and not young:
            raise InputError(
                tr("Air inside needs the wall in newtons; choose a material or type its modulus.")
            )
        said = {
            "--unit": self._unit.symbol,
            "--thickness": _number_text(wall.thickness),
            "--yield-radius": _number_text(wall.yield_radius),
            "--young": young,
            "--poisson": self.poisson.text().strip() if young else "",
            "--gas": _AIR if self.air.isChecked() else "",
            "--density": _number_text(wall.density),
            "--material": getattr(self.material.currentData(), "name", ""),
        }
        return {option: text for option, text in said.items() if text}

    def _fill(self) -> None:
        """Fill the fields with the properties of the chosen material."""
        material = self.material.currentData()
        self.source.setText(_OWN if material is None else material.source)
        if material is None:
            return
        radius = material.yield_radius(material.thickness)
        self.thickness.setText(f"{format_editable(material.thickness)}mm")
        self.radius.setText("" if radius is None else f"{format_editable(radius, _DIGITS)}mm")
        self.young.setText("" if material.young is None else f"{format_editable(material.young)}GPa")
        self.poisson.setText("" if material.poisson is None else format_editable(material.poisson))
        self.density.setText("" if material.density is None else f"{format_editable(material.density)} g/cm³")

    def _choose_own_material(self) -> None:
        self.material.setCurrentIndex(0)


def _number_text(number: float | None) -> str:
    return "" if number is None else repr(number)


def _entry(name: str, tip: str, usual: str) -> TextField:
    return TextField(toolTip=tip, placeholderText=usual, accessibleName=name, maximumWidth=110)
