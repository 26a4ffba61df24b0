"""The sample bottle while the green ring of its gizmo is dragged."""

from PySide6.QtGui import QImage
from stage import Stage


def draw(stage: Stage) -> QImage:
    """Drag the ring about the bottle's axis to the right, and do not let go."""
    stage.open_sample("bottle")
    way = stage.along_ring(1, 0.2, 0.85, 3)
    trail = stage.along_ring(1, 0.2, 0.85, 20)
    stage.drag(way, let_go=False)
    stage.trail(trail)
    stage.cursor(way[-1], pressed=True)
    return stage.picture()
