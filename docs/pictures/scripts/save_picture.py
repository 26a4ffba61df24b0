"""The dialog for a picture of the view."""

from PySide6.QtCore import QSize
from PySide6.QtGui import QImage
from stage import Stage

from apd_viewer.ui.sharing.picture_dialog import PictureDialog, PictureSettings


def draw(stage: Stage) -> QImage:
    """Twist the bottle and ask for a picture without background."""
    stage.open_sample("bottle")
    stage.window.session.settings.set_contact(False)
    stage.twist("60deg")
    pictures = stage.window.reports.pictures
    dialog = PictureDialog(stage.window.shell, pictures, PictureSettings(QSize(1600, 1200), transparent=True))
    dialog.show()
    stage.wait(lambda: not dialog.preview.image.isNull())
    stage.pause(200)
    picture = stage.dialog(dialog)
    dialog.close()
    return picture
