"""The window on the sample bottle, with the names of its parts."""

from PySide6.QtCore import QPointF
from PySide6.QtGui import QImage
from stage import Stage


def draw(stage: Stage) -> QImage:
    """Name what the tutorial speaks of."""
    stage.open_sample("bottle")
    ring = stage.window.canvas.gizmo.frame.ring(1)[0]
    stage.callout("Base: stays in place", stage.at(stage.near((2.5, 0.6, 2.2))), (170, -20))
    stage.callout("Handle: what you move", stage.at(stage.near((1.2, 20.6, 0.5))), (175, -55))
    stage.callout("Gizmo: arrows move,\nrings rotate", QPointF(*ring[52]), (-135, 40))
    stage.callout("Tools", QPointF(-22.0, 330.0), (90, 0))
    stage.callout("Readings and settings", stage.window.panel.area, (-290, 10))
    return stage.picture()
