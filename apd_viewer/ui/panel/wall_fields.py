"""Fields for the material and the thickness of the wall."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QLabel, QMenu, QWidget

from apd_viewer.language import tr
from apd_viewer.presentation.number_format import format_editable, format_short
from apd_viewer.session.quantities.expressions import MOST_CHARACTERS
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import NO_WALL, WallText
from apd_viewer.session.quantities.wall_material import DEFAULT_POISSON, WALL_MATERIALS
from apd_viewer.ui.widgets.box_layouts import column_layout, row_layout
from apd_viewer.ui.widgets.fields import ComboBox, TextField, attach_menu, return_focus, small_button
from apd_viewer.ui.widgets.folding_section import Heading, quiet_label
from apd_viewer.ui.widgets.theme import Theme, icon

_UNITS = "g/cm³", "GPa", ""  # of density, Young's modulus and Poisson's ratio
_DIGITS, _WIDTH = 3, 120  # digits of a computed radius; px of a field


class WallFields(QWidget):
    """Material and thickness of the wall, and the folding properties of the material.

    A material determines its properties; typing one of them makes it a custom material.

    Attributes
    ----------
    entered : Signal(WallText)
    places : QToolButton
        Opens a menu of ways to a thickness that differs from place to place.
    from_file : QAction
        Asks for a file of it; first in the menu.
    heading : Heading
        Folds density, elasticity and creases.
    """

    entered = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self._unit, self._typed, self._kept = Unit.NONE, NO_WALL, ""
        tip = tr("Material of the wall: says density, elasticity and creases, and a usual thickness")
        self.material = ComboBox(accessibleName=tr("Material of the wall"), toolTip=tip)
        self.material.setMinimumWidth(_WIDTH)
        self.material.addItem(tr("Custom"), None)
        for material in WALL_MATERIALS:
            self.material.addItem(material.title, material)
        self._add_fields()
        self.source = quiet_label(tr("Source of the properties"))
        self.heading = Heading(tr("Material properties"))
        self._lay_out()
        self.material.activated.connect(self._choose)
        for field in self._own:
            field.textEdited.connect(self._make_custom)
        for field in (self.thickness, *self._own):
            field.setMaxLength(MOST_CHARACTERS)
            field.editingFinished.connect(self._enter)
            field.returnPressed.connect(partial(return_focus, field))

    def _add_fields(self) -> None:
        tip = tr(
            "Thickness of the wall: 0.3mm, or a number in the unit of the mesh; if typed, also the distance "
            "that walls in contact keep"
        )
        self.thickness = _entry(tr("Wall thickness"), tip)
        tip = tr("Density of the material: 1.38 (g/cm³, as of PET), 1380 kg/m³ or 86 lb/ft³")
        self.density = _entry(tr("Density"), tip, tr("no mass"))
        tip = tr("Wall distribution: from a file, or of a painted part; a thin line is a folding line")
        self.places = small_button(tr("Thickness from place to place"), tip)
        attach_menu(self.places, QMenu(self.places, toolTipsVisible=True))
        self.from_file = self.places.menu().addAction(tr("Thickness from file…"))
        self.from_file.setToolTip(
            tr("A table such as height,thickness or x,y,z,thickness, or a PLY, VTK or glTF file of the mesh")
        )
        self.young = _entry(tr("Young's modulus"), tr("For loads in newtons: 2.8GPa"), tr("no newtons"))
        self.poisson = _entry(tr("Poisson's ratio"), tr("From 0 to 0.5"), format_short(DEFAULT_POISSON))
        tip = tr("Walls bent to a smaller radius keep a crease: 6mm, or a number in the unit of the mesh")
        self.yield_radius = _entry(tr("Yield radius"), tip, tr("no creases"))
        self._own = self.density, self.young, self.poisson, self.yield_radius

    def _lay_out(self) -> None:
        body = QWidget()
        rows = [_row(field.accessibleName(), field) for field in self._own]
        column_layout(*rows, self.source, margins=(0, 0, 0, 4), parent=body)
        self.heading.toggled.connect(body.setVisible)
        label = QLabel(tr("Material"), objectName="quiet", buddy=self.material)
        chosen = row_layout(label, (self.material, 1))
        thick = _row(self.thickness.accessibleName(), self.thickness, self.places)
        column_layout(chosen, thick, self.heading, body, margins=(0, 4, 0, 0), parent=self)

    @property
    def value(self) -> WallText:
        """Wall as typed and chosen."""
        material = self.material.currentData()
        own = ["" if material else field.text() for field in self._own]
        known, text = self._typed.thickness, self.thickness.text()
        return WallText._make((known if str(known) == text else text, *own, material))

    def show_wall(self, wall: WallText, unit: Unit) -> None:
        """Show a wall, with its lengths in the unit of the mesh."""
        is_other = wall.material is not self._typed.material or wall == NO_WALL
        self._typed, self._unit, self._kept = wall, unit, ""
        self._show_symbols()
        self.material.setCurrentIndex(self.material.findData(wall.material))
        self.thickness.setText(wall.thickness)
        for field, text in zip(self._own, wall[1:-1], strict=True):
            field.setText(text)
        self._show_properties()
        if is_other:
            self.heading.setChecked(wall.material is None)

    def show_unit(self, unit: Unit) -> None:
        """Show the lengths in another unit."""
        if unit is not self._unit:
            self._unit = unit
            self._show_properties()
            self._show_symbols()

    def _show_symbols(self) -> None:
        """Show the units of bare numbers."""
        length = self._unit.format_length("").strip()
        for field, symbol in zip((self.thickness, *self._own), (length, *_UNITS, length), strict=True):
            field.show_unit(symbol)

    def _show_properties(self) -> None:
        """Show the properties of the chosen material and their source."""
        known = self.material.currentData()
        usual = "" if known is None else f"{format_editable(known.thickness)}\u00a0mm"
        self.thickness.setPlaceholderText(usual or tr("no mass"))
        self.source.setText("" if known is None else known.source)
        self.source.setVisible(known is not None)
        if known is None:
            return
        typed = self.value.usable_thickness(self._unit)
        across, symbol = (known.thickness, "mm") if typed is None else (typed, self._unit.symbol)
        amounts = known.density, known.young, known.poisson, known.yield_radius(across)
        for field, amount, unit in zip(self._own, amounts, (*_UNITS, symbol), strict=True):
            digits = _DIGITS if field is self.yield_radius else 6
            field.setText("" if amount is None else f"{format_editable(amount, digits)} {unit}".strip())

    def _choose(self) -> None:
        is_custom = self.material.currentData() is None
        if is_custom:
            self._keep_thickness()
        elif self.thickness.text() == self._kept:
            self.thickness.clear()
        self.heading.setChecked(is_custom)
        self._enter()

    def _make_custom(self) -> None:
        self.material.setCurrentIndex(0)
        self._keep_thickness()

    def _keep_thickness(self) -> None:
        """Make the usual thickness of the former material a typed one."""
        known = self._typed.material
        if known is not None and not self.thickness.text().strip():
            self._kept = f"{format_editable(known.thickness)} mm"
            self.thickness.setText(self._kept)

    def _enter(self) -> None:
        self._show_properties()
        if self.value != self._typed:
            self._typed = self.value
            self.entered.emit(self.value)

    def set_theme(self, theme: Theme) -> None:
        """Apply the theme to the heading."""
        self.heading.set_theme(theme)
        self.places.setIcon(icon("open", theme))


def _entry(name: str, tip: str, usual: str = "") -> TextField:
    field = TextField(toolTip=tip, placeholderText=usual, accessibleName=name)
    field.setFixedWidth(_WIDTH)
    return field


def _row(title: str, field: TextField, *before: QWidget) -> QWidget:
    row = QWidget()
    label = QLabel(title, objectName="quiet", toolTip=field.toolTip(), buddy=field)
    row_layout((label, 1), *before, field, parent=row)
    return row
