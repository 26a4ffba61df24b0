"""The parts of the gizmo, by their names."""

import numpy as np
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QImage
from stage import Stage


def draw(stage: Stage) -> QImage:
    """Name what can be dragged."""
    stage.open_sample("bottle")
    V = stage.state.document.mesh.V
    look = stage.window.canvas.viewport.camera_controller
    look.frame(V[V[:, 1] > 13.0], 0.0)
    look.camera = look.camera.zoomed(look.camera.focal, 0.62)
    stage.settle()
    frame = stage.window.canvas.gizmo.frame

    def spot(point: np.ndarray) -> QPointF:
        return QPointF(*point)

    stage.callout("Arrow: move along an axis", spot(frame.arrow(1)[2]), (150, -12))
    stage.callout("Square: move in a plane", spot(frame.square(2).mean(axis=0)), (185, 45))
    stage.callout("Ring: rotate", spot(frame.ring(1)[0][52]), (-110, 35))
    stage.callout("Corner: scale", spot(frame.scale_corner), (120, 0))
    stage.callout("Dot: move in the plane\nof the view", spot(frame.screen_centre), (-175, -70))
    stage.callout("Patch: drag it itself", stage.at(stage.near((0.9, 18.9, 1.3))), (165, 60))
    middle = stage.place(spot(frame.screen_centre))
    return stage.picture(QRectF(middle.x() - 330, middle.y() - 190, 660, 380) & stage.view_box)
