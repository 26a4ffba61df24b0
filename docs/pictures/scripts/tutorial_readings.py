"""What the panel says of the bottle that was twisted by half a turn."""

from PySide6.QtGui import QImage
from stage import Stage

from apd_viewer.session.quantities.units import Unit


def draw(stage: Stage) -> QImage:
    """Twist by typing; show area and volume."""
    stage.open_sample("bottle")
    stage.window.choose_unit(Unit.CENTIMETRE)
    stage.twist("180deg")
    panel = stage.window.panel
    return stage.picture(stage.panel_box(panel.area, panel.volume, panel.strain))
