"""The Settings page."""

from PySide6.QtGui import QImage
from stage import Stage


def draw(stage: Stage) -> QImage:
    """Open the page; the number of cores depends on the machine."""
    stage.open_sample("bottle")
    stage.window.settings_page.open()
    dialog = stage.window.settings_page.dialog
    stage.wait(lambda: dialog.isVisible())
    threads = dialog.findChild(object, "threads")
    threads.setItemText(0, "All cores")
    stage.view.setFocus()
    stage.pause(80)
    return stage.dialog(dialog)
