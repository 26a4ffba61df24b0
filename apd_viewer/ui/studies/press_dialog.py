"""Dialog that presses the mesh between two plates, and shows the curves."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtWidgets import QHBoxLayout, QLabel, QWidget

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import save_mesh, suffix_for
from apd_viewer.geometry.contact.mesh_contact import thickness_of
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.pressing.plate_press import DEFAULT_ITERATIONS, DEFAULT_STEPS, MOST_STEPS
from apd_viewer.geometry.pressing.plate_way import plate_way
from apd_viewer.geometry.pressing.press_options import check_yield
from apd_viewer.geometry.solver.methods import DEFAULT_METHOD, METHODS
from apd_viewer.language import tr
from apd_viewer.presentation import number_format
from apd_viewer.presentation.number_format import short
from apd_viewer.ui.studies.length_field import LengthField
from apd_viewer.ui.studies.run_bar import RunBar
from apd_viewer.ui.studies.study_dialog import StudyDialog, count_field, row_of
from apd_viewer.ui.widgets.fields import Check, Choice, Number

if TYPE_CHECKING:
    from apd_viewer.session.model.document import Document
    from apd_viewer.session.quantities.units import Unit
    from apd_viewer.ui.preferences.preferences import Preferences

_AXES = "xyz"
_PROPOSED_STIFFNESS = 0.001


class PressDialog(StudyDialog):
    """Presses the mesh at rest, as it was when the dialog opened.

    Parameters
    ----------
    window : QWidget
    document : Document
    unit : Unit
        Of lengths, as the user reads and types them.
    memory : Preferences
    """

    def __init__(self, window: QWidget, document: Document, unit: Unit, memory: Preferences) -> None:
        mesh = document.mesh
        run = RunBar(tr("Press"), f"{mesh.stem}-press", memory)
        title = tr("Press between plates – {name}").format(name=mesh.name)
        super().__init__(window, title, run, "press.png", tr("Curves of load and volume"))
        self._document, self._unit = document, unit
        self._points = mesh.V[np.unique(mesh.F)]
        self._extents = np.ptp(self._points, axis=0)
        about = tr(
            "Presses the mesh at rest, with nothing held, between two plates that close on it in steps, "
            "and plots load and volume."
        )
        rows = (
            (tr("Direction"), self._make_direction()),
            (tr("End at"), self._make_end()),
            (tr("Steps"), self._make_steps()),
            (tr("Method"), self._make_method()),
            (tr("Stiffness"), self._make_stiffness()),
            (tr("Wall thickness"), self._make_thickness(document.thickness)),
            (tr("Yield radius"), self._make_creases()),
        )
        self.lay_out(about, rows)

    def _make_direction(self) -> QHBoxLayout:
        self.direction = Choice(accessibleName=tr("Direction to press in"))
        for axis, extent in zip(_AXES, self._extents, strict=True):
            self.direction.addItem(f"{axis.upper()} ({self._written(extent)})", axis)
        self.direction.currentIndexChanged.connect(self._show_distance)
        return row_of(self.direction)

    def _make_end(self) -> QHBoxLayout:
        self.to = count_field(tr("Distance of the plates in the end"), 1, 99, 50, " %")
        self.to.valueChanged.connect(self._show_distance)
        self.distance = QLabel()
        self._show_distance()
        return row_of(self.to, self.distance, spacing=8)

    def _make_steps(self) -> QHBoxLayout:
        self.steps = count_field(tr("Number of steps"), 1, MOST_STEPS, DEFAULT_STEPS)
        self.iterations = count_field(tr("Iterations per step"), 1, 100_000, DEFAULT_ITERATIONS)
        words = tr("with at most"), tr("iterations each")
        first, second = map(QLabel, words)
        return row_of(self.steps, first, self.iterations, second, spacing=8)

    def _make_method(self) -> QHBoxLayout:
        own = self._document.method if self._document.traits.may_touch else DEFAULT_METHOD
        self.method = Choice(accessibleName=tr("Method"))
        for name, method in METHODS.items():
            if method.may_touch:
                self.method.addItem(method.title, name)
        self.method.setCurrentIndex(self.method.findData(own))
        return row_of(self.method)

    def _make_stiffness(self) -> QHBoxLayout:
        own = self._document.stiffness
        value = own or _PROPOSED_STIFFNESS
        self.stiffness = Number(
            brief=True, accessibleName=tr("Stiffness"), minimum=0.0, maximum=1.0, decimals=5, value=value
        )
        self.stiffness.setFixedWidth(72)
        self.hint = QLabel(tr("without stiffness, walls crumple and loads mean little"), objectName="quiet")
        self.hint.setHidden(own > 0.0)
        return row_of(self.stiffness, self.hint, spacing=8)

    def _make_thickness(self, given: float | None) -> QHBoxLayout:
        tip = tr("Distance that walls keep: 0.3mm, or a number in the unit of the mesh")
        usual = self._unit.length(short(thickness_of(diagonal(self._points), None)))
        self.thickness = LengthField(tr("Wall thickness"), tip, usual, self._unit, given)
        return row_of(self.thickness)

    def _make_creases(self) -> QHBoxLayout:
        tip = tr("Walls bent to a smaller radius keep a crease: 6mm, or a number in the unit of the mesh")
        self.radius = LengthField(tr("Yield radius"), tip, tr("no creases"), self._unit)
        self.release = Check(tr("open the plates again, to see what remains"))
        return row_of(self.radius, self.release)

    @property
    def _distance(self) -> float:
        """Of the plates in the end, mesh units."""
        return float(self.to.value() / 100.0 * self._extents[self.direction.currentIndex()])

    def _written(self, distance: float) -> str:
        return self._unit.length(number_format.length(distance, float(self._extents.max())))

    def _show_distance(self) -> None:
        words = tr("of the extent, with the plates {distance} apart")
        self.distance.setText(words.format(distance=self._written(self._distance)))

    def begin(self) -> None:
        """Start the press with the options chosen."""
        axis = np.eye(3)[self.direction.currentIndex()]
        try:
            thickness, radius = self.thickness.value, self.radius.value
            check_yield(radius, self.stiffness.value())
            plate_way(self._points, axis, self._distance, thickness)
        except InputError as error:
            self.run.fail(str(error))
            return
        options = self._options
        if thickness is not None:
            options["--thickness"] = repr(thickness)
        if radius is not None:
            options["--yield-radius"] = repr(radius)
        flags = ["--release"] if self.release.isChecked() else []
        mesh = self._document.mesh

        def prepared(scratch: Path, results: Path) -> list[str]:
            rest = scratch / f"{mesh.stem}{suffix_for(mesh)}"
            save_mesh(mesh, mesh.V, rest)
            files = {
                "-o": f"pressed{rest.suffix}",
                "--curve": "curve.csv",
                "--figure": "press.png",
                "--report": "report.json",
            }
            asked = options | {option: str(results / name) for option, name in files.items()}
            return ["press", str(rest), *flags, *(word for pair in asked.items() for word in pair)]

        self.run.begin(prepared)

    @property
    def _options(self) -> dict[str, str]:
        """Options of the command that set how to press."""
        return {
            "--axis": self.direction.currentData(),
            "--to": f"{self.to.value():.0f}%",
            "--steps": f"{self.steps.value():.0f}",
            "--iterations": f"{self.iterations.value():.0f}",
            "--method": self.method.currentData(),
            "--stiffness": repr(self.stiffness.value()),
            "--area-stiffness": repr(self._document.area_stiffness),
            "--shear-stiffness": repr(self._document.shear_stiffness),
        }
