"""A handle is painted with the brush."""

import numpy as np
from PySide6.QtGui import QImage
from stage import Stage

from apd_viewer.ui.tools.tool_modes import Tool


def draw(stage: Stage) -> QImage:
    """Drag the brush from the tip of the duck's tail, and do not let go."""
    stage.open_sample("duck")
    stage.window.session.painting.clear_all()
    stage.look(-0.6, 0.45, 1.0, 60.0)
    stage.take(Tool.HANDLE)
    stage.window.canvas.brush.size.radius = 34.0
    way = [stage.at(stage.near(point)) for point in _way(stage.state.document.mesh.V)]
    stage.press(way[0])
    for point in way[1:]:
        stage.move(point, pressed=True)
        stage.pause(40)
    stage.settle()
    stage.trail(way)
    stage.cursor(way[-1])
    stage.callout("H, then drag", way[0], (-40, -110))
    picture = stage.picture()
    stage.release(way[-1])
    return picture


def _way(V: np.ndarray) -> np.ndarray:
    """Points on the side of the tail, from its tip."""
    tip = V[np.argmax(V[:, 0])]
    return tip + np.linspace(0.0, 1.0, 6)[:, None] * [-1.9, -1.1, 1.4]
