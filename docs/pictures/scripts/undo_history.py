"""The history, with a step for every motion and setting."""

from PySide6.QtGui import QImage
from stage import Stage


def draw(stage: Stage) -> QImage:
    """Make some steps, and take two of them back."""
    stage.size = (1120, 760)
    stage.open_sample("bottle")
    session = stage.window.session
    session.settings.set_contact(False)
    stage.twist("30deg")
    stage.twist("2", "MOVE_X")
    session.settings.change(stiffness=1e-3)
    stage.settle()
    stage.twist("20deg", "BEND_Z")
    session.gestures.undo()
    stage.settle()
    stage.window.docks["history"].show()
    stage.pause(80)
    stage.window.canvas.frame_mesh()
    stage.settle()
    stage.mark(stage.window.docks["history"])
    return stage.picture()
