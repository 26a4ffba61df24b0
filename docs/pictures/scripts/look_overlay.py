"""The bottle coloured by local area change, with plots of the gesture below."""

from PySide6.QtGui import QImage
from PySide6.QtWidgets import QAbstractButton
from stage import Stage

from apd_viewer.presentation.scales import Measure
from apd_viewer.session.model.state import State
from apd_viewer.session.processes.document_deformation import deformation_of


def draw(stage: Stage) -> QImage:
    """Twist by ARAP, which changes the area."""
    stage.size = (1120, 800)
    stage.open_sample("bottle")
    stage.window.session.settings.set_contact(False)
    stage.window.session.settings.change(method="arap")
    stage.window.docks["plots"].show()
    for chip in stage.window.plots.findChildren(QAbstractButton):
        if chip.text() == "Area and volume" and chip.isChecked():
            chip.click()  # its axis is time, which is another one each time
    rest = stage.state
    stage.twist("60deg")
    _plot_every_frame(stage, rest)
    stage.overlay(Measure.AREA)
    stage.window.canvas.frame_mesh()
    stage.settle()
    return stage.picture()


def _plot_every_frame(stage: Stage, rest: State) -> None:
    """Plot all frames of the motion: which of them a window shows depends on its pace."""
    document, trace = stage.state.document, stage.window.session.store.trace
    held = document.constraints()
    solver = deformation_of(document, held)
    solver.aim(held.targets, rest.frame.U)
    trace.begin(rest)
    while not solver.settled:
        trace.add_frame(document, solver.step())
    stage.window.plots.refresh()
