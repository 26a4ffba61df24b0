"""The dialog that runs the cases with exact answers, while it runs."""

from PySide6.QtGui import QImage
from stage import Stage


def draw(stage: Stage) -> QImage:
    """Run the cases, and wait for those from the tube to the catenoid."""
    stage.open_sample("bottle")
    stage.window.actions_.help["verify"].trigger()
    dialog = stage.window.runs.dialogs["verify"]
    if not stage.quick:
        dialog.run.start.click()
        stage.wait(lambda: dialog.table.topLevelItemCount() > 8)
    stage.view.setFocus()
    stage.pause(300)
    return stage.dialog(dialog)
