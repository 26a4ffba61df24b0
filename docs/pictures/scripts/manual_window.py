"""The window with a number at each of its parts."""

from PySide6.QtCore import QPointF
from PySide6.QtGui import QImage
from stage import Stage

from apd_viewer.presentation.scales import Measure


def draw(stage: Stage) -> QImage:
    """Twist a little, so that there is something to be read."""
    stage.size = (1120, 760)
    stage.open_sample("bottle")
    stage.window.session.settings.set_contact(False)
    stage.twist("45deg")
    stage.overlay(Measure.AREA)
    shell, panel = stage.window.shell, stage.window.panel
    stage.number(1, shell.menuBar(), (-150, 0))
    stage.number(2, QPointF(-24.0, 40.0), (26, 0))
    stage.number(3, stage.view, (200, 40))
    stage.number(4, QPointF(*stage.window.canvas.gizmo.frame.screen_centre), (-110, -40))
    stage.number(5, stage.window.display_options.legend, (128, -70))
    stage.number(6, panel.area, (-160, -30))
    stage.number(7, panel.parts, (-160, -30))
    stage.number(8, stage.window.status, (-40, 0))
    stage.number(9, stage.window.findings.badge, (-58, 0))
    return stage.picture()
