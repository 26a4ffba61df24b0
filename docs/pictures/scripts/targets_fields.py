"""The panel with a typed target for the area, and the volume kept."""

from PySide6.QtGui import QImage
from stage import Stage


def draw(stage: Stage) -> QImage:
    """Ask for 105 percent of the area and all of the volume."""
    stage.open_sample("bottle")
    session = stage.window.session
    session.settings.change(volume=100.0)
    session.settings.change(area=102.0)
    stage.settle()
    stage.twist("30deg")
    return stage.picture(stage.panel_box(stage.window.panel.method))
