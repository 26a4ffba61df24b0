"""Measurements drawn over the shape."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PySide6.QtGui import QColor, QPainter

from apd_viewer.geometry.measuring.measurement import Measurement, measure
from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.geometry.measuring.surface_point import SurfacePoint, point_positions
from apd_viewer.presentation import measurement_text as words
from apd_viewer.session.measurement_readings import MeasurementReading
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.measuring.measure_drawing import draw_labels, draw_lines, draw_points
from apd_viewer.ui.measuring.measure_tool import MeasureTool
from apd_viewer.ui.scene.mouse_tool import MouseTool
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.polylines import axis_rectangle, draw_plane

_PLANE, _HALO = QColor("#2f6fde"), QColor(255, 255, 255, 200)
# What is being picked is measured as a shape of its own.
_TRIANGLE = np.array([[0, 1, 2]])
_CORNERS = (
    SurfacePoint(0, (1.0, 0.0, 0.0)),
    SurfacePoint(0, (0.0, 1.0, 0.0)),
    SurfacePoint(0, (0.0, 0.0, 1.0)),
)


class MeasureView(MouseTool):
    """Draws measurements, and what is being picked.

    Parameters
    ----------
    viewport : Viewport
    surface : Surface
    tool : MeasureTool

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
        """Draw other measurements, or others of the same."""
        self._readings, self._unit, self._chosen = readings, unit, chosen
        self._viewport.tool_layer.update()

    def paint(self, painter: QPainter) -> None:
        """Draw the measurements of the shape, unless a blend is on screen."""
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
            draw_lines(painter, eye, reading.now, chosen)
            draw_points(
                painter, eye, point_positions(reading.measurement.points, self._surface.U, skin.F), chosen
            )
            labels.append((reading.now, self._label(reading), chosen))
        draw_labels(painter, eye, labels)

    def _label(self, reading: MeasurementReading) -> list[str]:
        pairs = zip(words.current_texts(reading, self._unit), words.change_texts(reading), strict=True)
        return ["  ".join(filter(None, pair)) for pair in pairs]

    def _draw_plane(self, painter: QPainter) -> None:
        if (plane := self._tool.plane) is not None:
            corners = axis_rectangle(self._surface.U, self._tool.axis, plane.offset)
            draw_plane(painter, self._viewport.camera_controller.camera, corners, _PLANE, _HALO)

    def _draw_picking(self, painter: QPainter) -> None:
        tool, eye = self._tool, self._viewport.camera_controller.camera
        points = tool.points
        if tool.kind is MeasurementKind.SECTION:
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
