"""Dialog to press the mesh between two plates, with wall properties and curves."""

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np
from PySide6.QtCore import QObject
from PySide6.QtWidgets import QHBoxLayout, QLabel, QWidget

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import save_mesh, suffix_for
from apd_viewer.geometry.contact.mesh_contact import contact_thickness
from apd_viewer.geometry.energy.cell_bending import load_excess
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.solver.methods import DEFAULT_METHOD, METHODS, method_material
from apd_viewer.geometry.solver.plate_press import DEFAULT_ITERATIONS, DEFAULT_STEPS, MOST_STEPS, plate_travel
from apd_viewer.language import tr
from apd_viewer.presentation import number_format, obstacle_readings
from apd_viewer.presentation.number_format import format_editable, format_short
from apd_viewer.session.model import memo
from apd_viewer.session.model.document_parts import kept_percentages
from apd_viewer.session.model.plate_pair import PROPOSED_STIFFNESS
from apd_viewer.session.model.state import State
from apd_viewer.session.model.view import SESSION_SUFFIX, View
from apd_viewer.session.quantities.expressions import unambiguous_text
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import Wall, WallText, parse_wall
from apd_viewer.session.quantities.wall_material import DEFAULT_POISSON, WALL_MATERIALS
from apd_viewer.session.storage.session_file import save_session
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.studies.run_dialog import RunBar, RunDialog, count_field
from apd_viewer.ui.widgets.box_layouts import STRETCH, row_layout
from apd_viewer.ui.widgets.display_names import window_title_text
from apd_viewer.ui.widgets.fields import CheckBox, ComboBox, NumberField, TextField

_AXES = "xyz"


class PressDialog(RunDialog):
    """Dialog to press the mesh of the document open at its creation.

    Parameters
    ----------
    view : View
        With the unit of lengths, as the user reads and types them.
    """

    def __init__(self, window: QWidget, state: State, view: View, preferences: Preferences) -> None:
        document, unit = state.document, Unit(view.unit)
        mesh = document.mesh
        self._pressed, self._crushed = (f"{name}{suffix_for(mesh)}" for name in ("pressed", "crushed"))
        run = RunBar(tr("Press"), f"{mesh.stem}-press", preferences, self._pressed)
        title = tr("Press between plates – {name}").format(name=window_title_text(mesh.name))
        super().__init__(window, title, run, "press.png", tr("Curves of load and volume"))
        run.start_requested.connect(self.begin)
        self._state, self._view, self._document, self._unit = state, view, document, unit
        self._points = mesh.V[np.unique(mesh.F)]
        self._extents = np.ptp(self._points, axis=0)
        about = tr(
            "Presses the mesh, with nothing held, between two plates that close on it in steps, and plots "
            "load and volume."
        )
        self._cells = memo.cell_stiffness(mesh.V, mesh.joined_F)
        usual = contact_thickness(diagonal(self._points), None)
        self.wall = WallFields(self, unit, usual, document.settings.thickness)
        rows = (
            (tr("Direction"), self._make_direction()),
            (tr("End at"), self._make_end()),
            (tr("Steps"), self._make_steps()),
            (tr("Method"), self._make_method()),
            (tr("Stiffness"), self._make_stiffness()),
            *self.wall.rows,
            (tr("Begin with"), self._make_start()),
        )
        self.wall.on_change(self._show_stiffness)
        self.lay_out(about, rows)
        self.wall.material.currentIndexChanged.connect(lambda _: self._fit(self.width()))

    def _make_direction(self) -> QHBoxLayout:
        self.direction = ComboBox(accessibleName=tr("Direction to press in"))
        for axis, extent in zip(_AXES, self._extents, strict=True):
            self.direction.addItem(f"{axis.upper()} ({self._length_text(extent)})", axis)
        self.direction.currentIndexChanged.connect(self._show_distance)
        return row_layout(self.direction, STRETCH, spacing=16)

    def _make_end(self) -> QHBoxLayout:
        self.to = count_field(tr("Distance of the plates in the end"), 1, 99, 50, " %")
        self.to.valueChanged.connect(self._show_distance)
        self.distance = QLabel()
        self._show_distance()
        return row_layout(self.to, self.distance, STRETCH)

    def _make_steps(self) -> QHBoxLayout:
        self.steps = count_field(tr("Number of steps"), 1, MOST_STEPS, DEFAULT_STEPS)
        self.iterations = count_field(tr("Iterations per step"), 1, 100_000, DEFAULT_ITERATIONS)
        words = tr("with at most"), tr("iterations each")
        first, second = map(QLabel, words)
        return row_layout(self.steps, first, self.iterations, second, STRETCH)

    def _make_method(self) -> QHBoxLayout:
        own = (
            self._document.settings.method
            if self._document.settings.traits.may_use_contact
            else DEFAULT_METHOD
        )
        self.method = ComboBox(accessibleName=tr("Method"))
        for name, method in METHODS.items():
            if method.may_use_contact:
                self.method.addItem(method.title, name)
        self.method.setCurrentIndex(self.method.findData(own))
        return row_layout(self.method, STRETCH, spacing=16)

    def _make_stiffness(self) -> QHBoxLayout:
        own = self._document.settings.stiffness
        value = own or PROPOSED_STIFFNESS
        self.stiffness = NumberField(
            brief=True, accessibleName=tr("Stiffness"), minimum=0.0, maximum=1.0, decimals=5, value=value
        )
        self.stiffness.setFixedWidth(72)
        self.hint = QLabel(objectName="quiet")
        self.stiffness.valueChanged.connect(self._show_stiffness)
        self.method.currentIndexChanged.connect(self._show_stiffness)
        self._show_stiffness()
        return row_layout(self.stiffness, self.hint, STRETCH)

    def _show_stiffness(self) -> None:
        """Show the expected load excess and the stiffness of the wall."""
        material = self._material()
        self.stiffness.setEnabled(not material.thickness)
        said = [obstacle_readings.excess_phrase(load_excess(material, self._cells))]
        own = None
        with suppress(InputError):
            own = self.wall.value.model_stiffness(self._state.inspection.area, material.young)
        if own is not None and material.bending > 0.0:
            said.append(tr("this wall has {own:.1g}").format(own=own))
        self.hint.setText("; ".join(said))

    def _material(self, yield_radius: float | None = None) -> Material:
        """Material as entered; raises InputError on creases without stiffness."""
        method, document = METHODS[self.method.currentData()], self._document
        return method_material(
            method,
            self.stiffness.value(),
            document.settings.area_stiffness,
            document.settings.shear_stiffness,
            yield_radius,
        )

    def _make_start(self) -> QHBoxLayout:
        self.from_current = CheckBox(
            tr("the current shape, which springs back first as far as it has no creases")
        )
        self.from_current.setToolTip(tr("Without, the mesh at rest is pressed"))
        self.from_current.setEnabled(not self._state.is_at_rest)
        return row_layout(self.from_current, STRETCH, spacing=16)

    @property
    def _distance(self) -> float:
        """Final distance of the plates, mesh units."""
        return float(self.to.value() / 100.0 * self._extents[self.direction.currentIndex()])

    def _length_text(self, distance: float) -> str:
        return self._unit.format_length(number_format.format_length(distance, float(self._extents.max())))

    def _show_distance(self) -> None:
        words = tr("of the extent, with the plates {distance} apart")
        self.distance.setText(words.format(distance=self._length_text(self._distance)))

    def begin(self) -> None:
        """Start the press with the options chosen."""
        axis = np.eye(3)[self.direction.currentIndex()]
        try:
            wall = self.wall.value
            self._material(wall.yield_radius)
            plate_travel(self._points, axis, self._distance, wall.thickness)
            options = self._options | self._targets | self.wall.options
        except InputError as error:
            self.run.show_failure(str(error))
            return
        opens = self.wall.release.isChecked()
        flags = ["--release"] if opens else []
        self.run.mesh = self._crushed if opens else self._pressed
        from_current = self.from_current.isChecked()
        mesh = self._document.mesh

        def prepared(scratch: Path, results: Path) -> list[str]:
            rest = scratch / f"{mesh.stem}{suffix_for(mesh)}"
            source = scratch / f"{mesh.stem}{SESSION_SUFFIX}" if from_current else rest
            if from_current:
                save_session(source, self._state, self._view, embed=True)
            else:
                save_mesh(mesh, mesh.V, rest)
            files = {
                "-o": self._pressed,
                "--curve": "curve.csv",
                "--figure": "press.png",
                "--report": "report.json",
            }
            if opens:
                files["--crushed"] = self._crushed
            asked = options | {option: str(results / name) for option, name in files.items()}
            return ["press", str(source), *flags, *(word for pair in asked.items() for word in pair)]

        self.run.begin(prepared)

    @property
    def _targets(self) -> dict[str, str]:
        """Command options for the targets kept by the method."""
        area, volume, *_ = kept_percentages(self._document.with_settings(method=self.method.currentData()))
        said = {"--area": area, "--volume": volume}
        return {option: f"{value!r}%" for option, value in said.items() if value is not None}

    @property
    def _options(self) -> dict[str, str]:
        """Command options for plates, steps, method and stiffness."""
        return {
            "--axis": self.direction.currentData(),
            "--to": f"{self.to.value():.0f}%",
            "--steps": f"{self.steps.value():.0f}",
            "--iterations": f"{self.iterations.value():.0f}",
            "--method": self.method.currentData(),
            "--stiffness": repr(self.stiffness.value()),
            "--area-stiffness": repr(self._document.settings.area_stiffness),
            "--shear-stiffness": repr(self._document.settings.shear_stiffness),
        }


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
        wall = parse_wall(text, self._unit)
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
