"""The dialog that presses a mesh between plates, with its curves."""

from meshes_by_code import can
from PySide6.QtGui import QImage
from stage import Stage

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.quantities.units import Unit


def draw(stage: Stage) -> QImage:
    """Press a can to 60 percent of its width, and wait for the curves."""
    stage.open_mesh(Mesh(*can(*((24, 14) if stage.quick else (48, 32)))))
    stage.window.choose_unit(Unit.CENTIMETRE)
    stage.window.actions_.simulate.press.trigger()
    dialog = stage.window.runs.dialogs["press"]
    dialog.to.setValue(60)
    dialog.steps.setValue(2 if stage.quick else 16)
    if not stage.quick:
        dialog.run.start.click()
        stage.wait(lambda: not dialog.run.is_running)
    stage.view.setFocus()
    stage.pause(300)
    return stage.dialog(dialog)
