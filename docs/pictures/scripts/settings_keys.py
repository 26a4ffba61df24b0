"""The sheet of all keys."""

from PySide6.QtGui import QImage
from stage import Stage


def draw(stage: Stage) -> QImage:
    """Open the sheet over the view."""
    stage.open_sample("bottle")
    stage.window.help.toggle_sheet()
    stage.settle()
    stage.view.setFocus()
    stage.pause(50)
    return stage.picture()
