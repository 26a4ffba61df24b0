"""Dialog to press the mesh between two plates, with curves."""

from contextlib import suppress
from pathlib import Path

import numpy as np
from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QWidget

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import save_mesh, suffix_for
from apd_viewer.geometry.energy.cell_bending import load_excess
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.mesh.arrays import diagonal, used_vertices
from apd_viewer.geometry.solver.methods import DEFAULT_METHOD, METHODS, method_material
from apd_viewer.geometry.solver.plate_press import DEFAULT_ITERATIONS, DEFAULT_STEPS, MOST_STEPS, plate_travel
from apd_viewer.geometry.solver.press_band import DEEPEST_DENTS, DEFAULT_DENTS, MOST_RUNS
from apd_viewer.geometry.solver.settings import Settings
from apd_viewer.language import tr, trc
from apd_viewer.presentation import number_format, obstacle_readings
from apd_viewer.session.model import memo
from apd_viewer.session.model.document_parts import goal_percentages
from apd_viewer.session.model.obstacle_pair import PROPOSED_STIFFNESS
from apd_viewer.session.model.state import State
from apd_viewer.session.model.view import SESSION_SUFFIX, View
from apd_viewer.session.quantities.expressions import unambiguous_text
from apd_viewer.session.quantities.newton_conversion import settings_pascals
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import WallText, parse_wall, press_method
from apd_viewer.session.quantities.wall_distribution import TABLE_SUFFIX, WallDistribution, write_distribution
from apd_viewer.session.quantities.wall_material import parse_pressure_difference
from apd_viewer.session.storage.session_file import save_session
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.studies.run_dialog import RunBar, RunDialog, count_field
from apd_viewer.ui.widgets.box_layouts import STRETCH, row_layout
from apd_viewer.ui.widgets.display_names import window_title_text
from apd_viewer.ui.widgets.fields import CheckBox, ComboBox, NumberField, TextField

_AXES, _AIR = "xyz", "1atm"
_VACUUM = "-50 mbar"
_GAS, _PRESSURE = 1, 2  # choices of what is inside
_OF_BUCKLING = {"--axis", "--unit", "--material", "--thickness", "--young", "--poisson"}


class PressDialog(RunDialog):
    """Dialog to press the mesh of the document open at its creation.

    Parameters
    ----------
    view : View
        View with the unit of lengths and the wall.

    Attributes
    ----------
    wall_requested : Signal()
        The fields of the wall are to be shown.
    """

    wall_requested = Signal()

    def __init__(self, window: QWidget, state: State, view: View, preferences: Preferences) -> None:
        document, unit = state.document, Unit(view.unit)
        mesh = document.mesh
        self._pressed, self._crushed = (f"{name}{suffix_for(mesh)}" for name in ("pressed", "crushed"))
        run = RunBar(tr("Press"), f"{mesh.stem}-press", preferences, self._pressed)
        title = tr("Press between plates – {name}").format(name=window_title_text(mesh.name))
        super().__init__(window, title, run, "press.png", tr("Curves of load and volume"))
        run.start_requested.connect(self.begin)
        tip = tr("Shows how a perfect wall would fold first, and at which load, without pressing it")
        self.modes = QPushButton(tr("Buckling modes"), toolTip=tip)
        self.modes.clicked.connect(lambda: self.begin(buckles=True))
        run.add_button(self.modes)
        self._state, self._view, self._document, self._unit = state, view, document, unit
        self._points = mesh.V[used_vertices(mesh.F)]
        self._extents = np.ptp(self._points, axis=0)
        about = tr(
            "Presses the mesh, with nothing held, between two plates that close on it in steps, and plots "
            "load and volume."
        )
        self._cells = memo.cell_stiffness(mesh.V, mesh.joined_F)
        self.release = CheckBox(tr("open the plates again, to see what remains"))
        rows = (
            (tr("Direction"), self._make_direction()),
            (tr("End at"), self._make_end()),
            (tr("Steps"), self._make_steps()),
            (tr("Method"), self._make_method()),
            (tr("Wall"), self._make_wall()),
            (tr("Stiffness"), self._make_stiffness()),
            (tr("Begin with"), self._make_start()),
            (tr("At the end"), row_layout(self.release, STRETCH, spacing=16)),
            (tr("Inside"), self._make_air()),
            (tr("Runs"), self._make_runs()),
        )
        self.show_wall(view.wall)
        self.lay_out(about, rows)

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
        self.method = ComboBox(accessibleName=tr("Method"))
        for name, method in METHODS.items():
            if method.may_use_contact:
                self.method.addItem(method.title, name)
        self._proposed = str(self.method.currentData())
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
        return row_layout(self.stiffness, self.hint, STRETCH)

    def _make_wall(self) -> QHBoxLayout:
        self.wall = QLabel(accessibleName=tr("Wall"))
        tip = tr("Shows the wall in the panel, under “Size and mass”")
        self.change = QPushButton(trc("wall", "Change"), toolTip=tip)
        self.change.clicked.connect(self.wall_requested)
        return row_layout(self.wall, self.change, STRETCH)

    def show_wall(self, wall: WallText) -> None:
        """Show a wall, and press with it."""
        self._wall = wall
        self.wall.setText(wall.text(self._unit) or tr("not known, so no newtons and no creases"))
        if self.method.currentData() == self._proposed:  # no other one was chosen
            self._proposed = _proposed_method(self._document.settings, wall, self._unit)
            self.method.setCurrentIndex(self.method.findData(self._proposed))
        self._show_stiffness()

    def _show_stiffness(self) -> None:
        """Show the load excess and the wall's stiffness; enable runs of a known wall."""
        material = self._material()
        self.stiffness.setEnabled(not material.thickness)
        said = [obstacle_readings.excess_phrase(load_excess(material, self._cells))]
        own = None
        with suppress(InputError):
            own = parse_wall(self._wall, self._unit).model_stiffness(
                self._state.inspection.area, material.tensile_stiffness
            )
        if own is not None and material.bending > 0.0:
            said.append(tr("this wall has {own:.1g}").format(own=own))
        self.hint.setText("; ".join(said))
        known = bool(material.thickness) and self._wall.usable_thickness(self._unit) is not None
        self.runs.setEnabled(known)
        self.modes.setEnabled(known)
        self.dents.setEnabled(known and self.runs.value() > 1)
        words = tr("of the wall thickness")
        self.band_hint.setText(words if known else tr("by the method Wall, thickness known"))

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

    def _make_air(self) -> QHBoxLayout:
        self.air = ComboBox(accessibleName=tr("Inside"))
        said = tr("air that goes in and out"), tr("air that cannot leave, at one atmosphere")
        self.air.addItems([*said, tr("a constant pressure, inside less outside")])
        self.air.setToolTip(
            tr("Openings are capped; needs the wall in newtons, and a pressure the method Wall")
        )
        settings, size = self._document.settings, diagonal(self._document.mesh.V)
        pascals = settings_pascals(settings, size, self._view.wall, self._unit)
        pressure = settings.pressure if settings.traits.is_wall else None
        text = _VACUUM
        if pressure is not None and pascals is not None:
            text = number_format.format_pressure(pressure * pascals)
        tip = tr("Such as 30mbar, or -50mbar for a vacuum")
        self.pressure = TextField(text=text, toolTip=tip, accessibleName=tr("Pressure"))
        self.pressure.setFixedWidth(84)
        self.air.currentIndexChanged.connect(lambda chosen: self.pressure.setEnabled(chosen == _PRESSURE))
        self.pressure.setEnabled(False)
        self.air.setCurrentIndex(0 if pressure is None else _PRESSURE)
        return row_layout(self.air, self.pressure, STRETCH)

    def _make_runs(self) -> QHBoxLayout:
        self.runs = count_field(tr("Number of runs"), 1, MOST_RUNS, 1)
        self.dents = count_field(tr("Depth of the dents"), 1, DEEPEST_DENTS, DEFAULT_DENTS, " %")
        self.runs.setToolTip(tr("10 show how much a top load depends on dents that nobody sees"))
        self.dents.setToolTip(tr("How uneven the wall is at rest, in percent of its thickness"))
        self.runs.valueChanged.connect(self._show_stiffness)
        self.band_hint = QLabel()
        words = QLabel(tr("each with other dents of"))
        return row_layout(self.runs, words, self.dents, self.band_hint, STRETCH)

    @property
    def _distance(self) -> float:
        """Final distance of the plates, mesh units."""
        return float(self.to.value() / 100.0 * self._extents[self.direction.currentIndex()])

    def _length_text(self, distance: float) -> str:
        return self._unit.format_length(number_format.format_length(distance, float(self._extents.max())))

    def _show_distance(self) -> None:
        words = tr("of the extent, with the plates {distance} apart")
        self.distance.setText(words.format(distance=self._length_text(self._distance)))

    def begin(self, buckles: bool = False) -> None:
        """Start the press with the options chosen, or find buckling modes instead."""
        axis = np.eye(3)[self.direction.currentIndex()]
        try:
            options = self._options | self._targets | self._wall_options
            lengths = "--yield-radius", "--thickness"
            radius, apart = (float(options[name]) if name in options else None for name in lengths)
            self._material(radius)
            plate_travel(self._points, axis, self._distance, apart)
        except InputError as error:
            self.run.show_failure(str(error))
            return
        if buckles:
            up = self._view.up_axis
            options = {name: options[name] for name in _OF_BUCKLING & options.keys()}
            options |= {} if up is None else {"--up": up.value}
        opens = self.release.isChecked() and not buckles
        flags = ["--release"] if opens else []
        mode = f"mode{suffix_for(self._document.mesh)}"
        self.run.mesh = f"mode-1{Path(mode).suffix}" if buckles else self._crushed if opens else self._pressed
        self.figure_is_drawn = not buckles
        self.figure_caption = tr("Buckling modes") if buckles else tr("Curves of load and volume")
        from_current = self.from_current.isChecked() and not buckles
        mesh, thickness, unit = self._document.mesh, self._wall.thickness, self._unit

        def prepared(scratch: Path, results: Path) -> list[str]:
            rest = scratch / f"{mesh.stem}{suffix_for(mesh)}"
            source = scratch / f"{mesh.stem}{SESSION_SUFFIX}" if from_current else rest
            if from_current:
                save_session(source, self._state, self._view, embed=True)
            else:
                save_mesh(mesh, mesh.V, rest)
            if isinstance(thickness, WallDistribution):
                table = scratch / f"thickness{TABLE_SUFFIX}"
                write_distribution(table, thickness.in_unit(unit))
                options["--thickness"] = str(table)
            files = {"--figure": "press.png", "--json": "report.json"}
            files |= {"--output": mode} if buckles else {"--output": self._pressed, "--curve": "curve.csv"}
            if opens:
                files["--crushed"] = self._crushed
            asked = options | {option: str(results / name) for option, name in files.items()}
            words = [f"{option}={word}" for option, word in asked.items()]
            return ["buckle" if buckles else "press", str(source), *flags, *words]

        self.run.begin(prepared)

    @property
    def _targets(self) -> dict[str, str]:
        """Command options for the targets kept by the method."""
        area, volume, *_ = goal_percentages(self._document.with_settings(method=self.method.currentData()))
        said = {"--area": area, "--volume": volume}
        return {option: f"{value!r}%" for option, value in said.items() if value is not None}

    @property
    def _options(self) -> dict[str, str]:
        """Command options for plates, steps, method, stiffness and runs."""
        runs = {"--runs": self.runs, "--dents": self.dents} if self.dents.isEnabled() else {}
        return {
            "--axis": self.direction.currentData(),
            "--to": f"{self.to.value():.0f}%",
            "--steps": f"{self.steps.value():.0f}",
            "--iterations": f"{self.iterations.value():.0f}",
            "--method": self.method.currentData(),
            "--stiffness": repr(self.stiffness.value()),
            "--area-stiffness": repr(self._document.settings.area_stiffness),
            "--shear-stiffness": repr(self._document.settings.shear_stiffness),
            **{option: f"{field.value():.0f}" for option, field in runs.items()},
        }

    @property
    def _wall_options(self) -> dict[str, str]:
        """Command options of the wall; raises InputError."""
        text, wall = self._wall, parse_wall(self._wall, self._unit)
        for word in text[:-1]:
            unambiguous_text(word)
        if text.young and wall.thickness is None:
            raise InputError(tr("Newtons need the thickness of the wall as well; enter one such as 0.3mm."))
        if text.young and self._unit is Unit.NONE:
            raise InputError(tr("Newtons need the unit of the mesh; choose it next to the area."))
        inside = self.air.currentIndex()
        if inside == _PRESSURE and not METHODS[self.method.currentData()].is_wall:
            raise InputError(tr("Only the method Wall has a pressure; choose it, or omit the pressure."))
        if inside == _PRESSURE and wall.young is None:
            raise InputError(
                tr("A pressure needs thickness and Young's modulus of the wall; enter them in Size and mass.")
            )
        if inside == _GAS and wall.young is None:
            raise InputError(
                tr("Air inside needs the wall in newtons; choose a material or type its modulus.")
            )
        apart = text.contact_distance(self._unit) or (
            None if text.material else self._document.settings.thickness
        )
        said = {
            "--unit": self._unit.symbol,
            "--material": text.field_texts[-1],
            "--thickness": _number_text(apart),
            "--density": text.density and _number_text(wall.density),
            "--young": text.young.strip(),
            "--poisson": text.poisson.strip() if text.young else "",
            "--yield-radius": text.yield_radius and _number_text(wall.yield_radius),
            "--gas": _AIR if inside == _GAS else "",
            "--pressure": f"{_pascals(self.pressure.text())!r}Pa" if inside == _PRESSURE else "",
        }
        return {option: word for option, word in said.items() if word}


def _proposed_method(settings: Settings, wall: WallText, unit: Unit) -> str:
    """Method that the command takes for the wall, else that of the document."""
    own = settings.method if settings.traits.may_use_contact else DEFAULT_METHOD
    with suppress(InputError):
        return press_method(parse_wall(wall, unit), settings.stiffness, own)
    return own


def _pascals(text: str) -> float:
    return parse_pressure_difference(unambiguous_text(text))


def _number_text(number: float | None) -> str:
    return "" if number is None else repr(number)
