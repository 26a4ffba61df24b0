"""What a lasso would choose is shown before the button is released."""

import numpy as np
from PySide6.QtCore import QPointF
from PySide6.QtGui import QImage
from stage import Stage

from apd_viewer.ui.tools.tool_modes import SelectionMode, Tool


def draw(stage: Stage) -> QImage:
    """Draw an outline around the duck's head."""
    stage.open_sample("duck")
    stage.window.session.painting.clear_all()
    stage.look(-0.55, 0.3, 1.0, 50.0)
    stage.take(Tool.BASE)
    stage.window.tools.choose_mode(SelectionMode.LASSO)
    V = stage.state.document.mesh.V
    head = V[(V[:, 1] > 0.6 * V[:, 1].max()) & (V[:, 0] < 0)].mean(axis=0)
    middle = stage.at(stage.near(head + np.array([0.0, 0.0, 3.0])))
    turn = np.linspace(-1.2, 4.7, 40)
    way = [middle + QPointF(112 * np.cos(t) * (1 + 0.05 * np.sin(3 * t)), 100 * np.sin(t) - 12) for t in turn]
    stage.press(way[0])
    for point in way[1:]:
        stage.move(point, pressed=True)
    stage.settle()
    stage.cursor(way[-1], pressed=True)
    picture = stage.picture(stage.view_box)
    stage.release(way[-1])
    return picture
