"""The sample cloth at rest, folded in half, and folded once more across."""

import numpy as np
from pairs import side_by_side
from PySide6.QtGui import QImage
from stage import Stage

from apd_viewer.geometry.pose.constraints import BASE, HANDLE


def draw(stage: Stage) -> QImage:
    """Type both half turns, and paint the cloth anew between them."""
    stage.open_sample("cloth")
    session = stage.window.session
    pictures = [_look(stage)]
    stage.twist("180deg", "TURN_X")
    pictures.append(_look(stage))
    x = stage.state.frame.U[:, 0]
    session.painting.clear_all()
    session.gestures.begin()
    session.painting.paint(np.flatnonzero(x < -5.0), BASE)
    session.painting.paint(np.flatnonzero(x > 5.0), HANDLE)
    session.painting.end_stroke("Paint")
    session.handles.set_pivot(np.array([0.0, 2.0, 0.0]), 0)
    stage.settle()
    stage.twist("180deg", "TURN_Z")
    pictures.append(_look(stage))
    return side_by_side(pictures, ["Flat", "Folded in half", "Folded once more"])


def _look(stage: Stage) -> QImage:
    stage.look(0.35, 0.5, 1.0)
    return stage.scene(300, 240)
