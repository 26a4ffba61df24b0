"""The sample bottle twisted by half a turn, wall against wall, coloured by local area change."""

from PySide6.QtGui import QImage
from stage import Stage

from apd_viewer.presentation.scales import Measure
from apd_viewer.session.quantities.units import Unit


def draw(stage: Stage) -> QImage:
    """Twist by typing, and choose the overlay."""
    stage.open_sample("bottle")
    stage.window.choose_unit(Unit.CENTIMETRE)
    stage.twist("180deg")
    stage.overlay(Measure.AREA)
    return stage.picture()
