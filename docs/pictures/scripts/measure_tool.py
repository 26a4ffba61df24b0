"""A distance, a geodesic and a section of the twisted bottle."""

import numpy as np
from PySide6.QtGui import QImage
from stage import Stage

from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.tools.tool_modes import Tool


def draw(stage: Stage) -> QImage:
    """Twist a little, and click on the mesh."""
    stage.open_sample("bottle")
    stage.window.choose_unit(Unit.CENTIMETRE)
    stage.window.session.settings.set_contact(False)
    stage.twist("60deg")
    stage.take(Tool.MEASURE)
    measure = stage.window.measurements
    for kind, heights in (
        (MeasurementKind.DISTANCE, (17.0, 3.5)),
        (MeasurementKind.GEODESIC, (15.0, 5.0)),
        (MeasurementKind.SECTION, (8.6,)),
    ):
        measure.choose_kind(kind)
        for number, height in enumerate(heights):
            stage.click(
                stage.at(_front(stage, height, -1.2 if kind is MeasurementKind.GEODESIC and number else 0.9))
            )
    stage.settle()
    stage.window.panel.measure.reveal()
    stage.pause(50)
    return stage.picture()


def _front(stage: Stage, height: float, x: float) -> int:
    """The vertex in front at a height, as far right as ``x``."""
    U, eye = stage.state.frame.U, stage.window.canvas.viewport.camera_controller.camera
    near = np.flatnonzero(np.abs(U[:, 1] - height) < 0.4)
    return int(near[np.argmin(eye.depth(U[near]) + np.abs(U[near, 0] - x))])
