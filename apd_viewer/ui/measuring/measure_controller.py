"""Controller and drawing of the Measure tool, in step with the session."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QColor, QGuiApplication, QPainter
from PySide6.QtWidgets import QMenu

from apd_viewer.geometry.measuring.measurement import Measurement, Plane, measure
from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.geometry.measuring.surface_point import SurfacePoint, point_positions
from apd_viewer.language import tr
from apd_viewer.presentation import measurement_text as words
from apd_viewer.session.measurement_readings import MeasurementReading
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.session import Session
from apd_viewer.ui.measuring.measure_section import MeasureSection
from apd_viewer.ui.measuring.measure_tool import MeasureTool, OpeningTool
from apd_viewer.ui.preferences.action_maker import ActionMaker
from apd_viewer.ui.scene.navigation import MouseTool
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.tools.polylines import (
    LIQUID,
    axis_rectangle,
    draw_labels,
    draw_lines,
    draw_plane,
    draw_points,
    fill_contours,
)
from apd_viewer.ui.tools.tool_modes import Tool


class MeasureController(QObject):
    """Adds, lists, draws and copies measurements.

    Parameters
    ----------
    section : MeasureSection
        Of the panel.
    choose_tool : callable
        Puts a tool into the hand.
    show_message : callable
        Says a sentence to the user.

    Attributes
    ----------
    kind_chosen : Signal(object)
        Another Kind is to be measured.
    """

    kind_chosen = Signal(object)

    def __init__(
        self,
        canvas: Canvas,
        section: MeasureSection,
        session: Session,
        choose_tool: Callable[[Tool], object],
        show_message: Callable[[str], object],
    ) -> None:
        super().__init__(canvas)
        self._section, self._session, self._take, self._tell = section, session, choose_tool, show_message
        self._chosen = 0
        self._F: np.ndarray | None = None
        self.tool = MeasureTool(canvas.viewport, canvas.surface)
        self.view = MeasureView(canvas.viewport, canvas.surface, self.tool)
        self._openings = OpeningTool(canvas.viewport, canvas.surface, self.tool)
        canvas.viewport.tools += [self._openings, self.tool, self.view]
        self._openings.clicked.connect(session.measurements.toggle_opening)
        self.tool.picked.connect(lambda points, plane: self._add(points, plane, self.tool.kind))
        section.list.chosen.connect(self._choose)
        section.list.renamed.connect(session.measurements.rename)
        section.list.removed.connect(self._remove)
        section.contents.valueChanged.connect(lambda volume: session.measurements.fill(self._chosen, volume))
        section.copy.clicked.connect(self.copy)
        section.clear.clicked.connect(self.clear)
        section.shown.toggled.connect(self._show_in_view)

    @property
    def hint(self) -> str:
        """Hint for the status line."""
        return KIND_TEXTS[self.tool.kind].hint

    def choose_kind(self, kind: MeasurementKind) -> None:
        """Set the kind of measurement, and activate the Measure tool."""
        self.tool.kind = kind
        self.kind_chosen.emit(kind)
        self._take(Tool.MEASURE)

    def refresh(self) -> None:
        """Update the list and the drawing to the session's state."""
        state = self._session.store.state
        if state is None:
            return
        if state.document.mesh.F is not self._F:
            self._F = state.document.mesh.F
            self.tool.cancel()  # the clicked points belong to another mesh
        self._openings.show_document(state.document)
        if not state.document.measurements and not self._section.list.rows:
            return
        unit, readings = self._session.store.unit, self._session.measurement_readings.readings(state)
        self._chosen = max(0, min(self._chosen, len(readings) - 1))
        self._section.show_readings(readings, unit, self._chosen)
        self.view.show_readings(readings, unit, self._chosen)

    def copy(self) -> None:
        """Copy all measured values to the clipboard, separated by tabs."""
        state = self._session.store.state
        if state is None or not state.document.measurements:
            self._tell(tr("There are no measurements to copy; choose the tool Measure and click the mesh."))
            return
        readings = self._session.measurement_readings.readings(state)
        QGuiApplication.clipboard().setText(words.value_table(readings, self._session.store.unit))
        self._tell(tr("Measurements copied; paste them into a text or a spreadsheet."))

    def clear(self) -> None:
        """Remove all measurements."""
        if self._session.store.state is not None:
            self._session.measurements.clear()

    def add_section(self, point: np.ndarray, normal: np.ndarray) -> None:
        """Measure the section in the plane through a point (3,) with a unit normal (3,)."""
        x, y, z = normal.tolist()
        self._add((), Plane((x, y, z), float(point @ normal)), MeasurementKind.SECTION)

    def _add(self, points: tuple[SurfacePoint, ...], plane: Plane | None, kind: MeasurementKind) -> None:
        state = self._session.store.state
        if state is not None:
            self._chosen = len(state.document.measurements)
            self._session.measurements.add(kind, points, plane)
            self._section.reveal()

    def _choose(self, k: int) -> None:
        self._chosen = k
        self.refresh()

    def _remove(self, k: int) -> None:
        if k < self._chosen:
            self._chosen -= 1
        self._session.measurements.remove(k)

    def _show_in_view(self, on: bool) -> None:
        self.view.visible = on


_PLANE, _HALO = QColor("#2f6fde"), QColor(255, 255, 255, 200)
# Picked points are measured as the corners of a mesh with one triangle.
_TRIANGLE = np.array([[0, 1, 2]])
_CORNERS = (
    SurfacePoint(0, (1.0, 0.0, 0.0)),
    SurfacePoint(0, (0.0, 1.0, 0.0)),
    SurfacePoint(0, (0.0, 0.0, 1.0)),
)


class MeasureView(MouseTool):
    """Overlay of the measurements and the points being picked.

    Attributes
    ----------
    visible : bool
        Whether measurements are drawn.
    """

    def __init__(self, viewport: Viewport, surface: Surface, tool: MeasureTool) -> None:
        self._viewport, self._surface, self._tool = viewport, surface, tool
        self._readings: Sequence[MeasurementReading] = ()
        self._unit = Unit.NONE
        self._chosen = 0
        self._shown = True

    @property
    def visible(self) -> bool:
        """True if measurements are drawn."""
        return self._shown

    @visible.setter
    def visible(self, on: bool) -> None:
        self._shown = on
        self._viewport.tool_layer.update()

    def show_readings(self, readings: Sequence[MeasurementReading], unit: Unit, chosen: int) -> None:
        """Draw the given measurements with their current readings."""
        self._readings, self._unit, self._chosen = readings, unit, chosen
        self._viewport.tool_layer.update()

    def paint(self, painter: QPainter) -> None:
        """Draw the measurements, unless a blend of shapes is displayed."""
        self._draw_plane(painter)
        if self._shown and not self._surface.is_blended:
            self._draw_measurements(painter)
        self._draw_picking(painter)

    def _draw_measurements(self, painter: QPainter) -> None:
        skin, eye, labels = self._surface.picking_index, self._viewport.camera_controller.camera, []
        if skin is None:
            return
        for k, reading in enumerate(self._readings):
            chosen = k == self._chosen
            if reading.measurement.contents is not None:
                fill_contours(painter, eye, reading.now.segments, LIQUID)
            draw_lines(painter, eye, reading.now, chosen)
            draw_points(
                painter, eye, point_positions(reading.measurement.points, self._surface.U, skin.F), chosen
            )
            labels.append((reading.now, self._label(reading), chosen))
        draw_labels(painter, eye, labels)

    def _label(self, reading: MeasurementReading) -> list[str]:
        names = words.value_names(reading) if len(reading.now.values) > 1 else ("",)
        texts = names, words.current_texts(reading, self._unit), words.change_texts(reading)
        return ["  ".join(filter(None, line)) for line in zip(*texts, strict=True)]

    def _draw_plane(self, painter: QPainter) -> None:
        if (plane := self._tool.plane) is not None:
            axis = int(np.argmax(np.abs(plane.normal)))
            corners = axis_rectangle(self._surface.U, axis, plane.offset * plane.normal[axis])
            draw_plane(painter, self._viewport.camera_controller.camera, corners, _PLANE, _HALO)

    def _draw_picking(self, painter: QPainter) -> None:
        tool, eye = self._tool, self._viewport.camera_controller.camera
        points = tool.points
        if tool.plane is not None:
            return
        draw_points(painter, eye, points, chosen=True)
        if len(points) < 2:
            return
        kind = MeasurementKind.ANGLE if len(points) == 3 else MeasurementKind.DISTANCE
        measured = measure(
            Measurement("", kind, _CORNERS[: len(points)]), np.vstack([points, points[:1]])[:3], _TRIANGLE
        )
        draw_lines(painter, eye, measured, chosen=True)
        if tool.kind is kind:
            said = words.value_text(measured.values[0], kind.powers[0], self._unit)
            draw_labels(painter, eye, [(measured, [said], True)])


class KindTexts(NamedTuple):
    """Menu title, icon, tooltip and status hint of a kind of measurement."""

    title: str
    icon: str
    tip: str
    hint: str


KIND_TEXTS = {
    MeasurementKind.DISTANCE: KindTexts(
        tr("&Distance"),
        "measure-distance",
        tr("Measure the straight distance between two points"),
        tr("Measure distance: click two points on the mesh; Esc cancels"),
    ),
    MeasurementKind.ANGLE: KindTexts(
        tr("&Angle"),
        "measure-angle",
        tr("Measure the angle of three points, at the second one"),
        tr("Measure angle: click three points on the mesh, the vertex second; Esc cancels"),
    ),
    MeasurementKind.GEODESIC: KindTexts(
        tr("&Geodesic"),
        "measure-geodesic",
        tr("Measure the shortest path over the surface between two points"),
        tr("Measure geodesic: click two points on the mesh; Esc cancels"),
    ),
    MeasurementKind.SECTION: KindTexts(
        tr("&Section"),
        "measure-section",
        tr("Measure the contour in which a plane cuts the mesh, and the area in it"),
        tr("Measure section: click where the plane cuts the mesh, wheel changes the axis, Ctrl+wheel zooms"),
    ),
    MeasurementKind.FILL_LEVEL: KindTexts(
        tr("&Fill level"),
        "measure-level",
        tr("Fill the shape up to a point: its level, freeboard and what is spilled, however it deforms"),
        tr("Measure fill level: click the height to which it is filled, or an opening to close it"),
    ),
}


class MeasureActions:
    """Actions to choose a kind of measurement, and to copy or clear all measurements."""

    def __init__(self, maker: ActionMaker, measurements: MeasureController) -> None:
        self.kinds = {
            kind: maker.make(
                f"measure_kind:{kind.name}",
                words.title,
                words.icon,
                words.tip,
                None,
                partial(measurements.choose_kind, kind),
            )
            for kind, words in KIND_TEXTS.items()
        }
        maker.make_exclusive(self.kinds.values())
        self.kinds[measurements.tool.kind].setChecked(True)
        measurements.kind_chosen.connect(lambda kind: self.kinds[kind].setChecked(True))
        tip = tr("Copy the values of all measurements as text, for a spreadsheet")
        self.copy = maker.make(
            "copy_measurements", tr("&Copy measurements"), "copy", tip, None, measurements.copy
        )
        tip = tr("Remove all measurements")
        title = tr("&Remove all measurements")
        self.clear = maker.make(
            "clear_measurements", title, "clear-measurements", tip, None, measurements.clear
        )

    def add_to_menu(self, menu: QMenu) -> None:
        """Add the measuring actions to the Tools menu."""
        menu.addSeparator()
        own = menu.addMenu(tr("Me&asurements"))
        own.addActions(list(self.kinds.values()))
        own.addSeparator()
        own.addActions([self.copy, self.clear])
