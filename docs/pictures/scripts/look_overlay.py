"""The bottle coloured by local area change, with plots of the gesture below."""

from PySide6.QtGui import QImage
from PySide6.QtWidgets import QAbstractButton
from stage import Stage

from apd_viewer.presentation.scales import Measure


def draw(stage: Stage) -> QImage:
    """Twist by ARAP, which changes the area."""
    stage.size = (1120, 800)
    stage.open_sample("bottle")
    stage.window.session.settings.keep_apart(False)
    stage.window.session.settings.set_method("arap")
    stage.window.docks["plots"].show()
    for chip in stage.window.plots.findChildren(QAbstractButton):
        if chip.text() == "Area and volume" and chip.isChecked():
            chip.click()  # its axis is time, which is another one each time
    stage.twist("60deg")
    stage.overlay(Measure.AREA)
    stage.window.canvas.frame_mesh()
    stage.settle()
    return stage.picture()
