"""A sheet for each theme, with a picture of every dialog: to be looked at, and no part of the site.

    python docs/pictures/dialog_sheet.py FOLDER  # in the language of APD_VIEWER_LANGUAGE, or English

It needs Xvfb, and no display. The dialogs are those that ``tests/support/walked_dialogs.py`` opens.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from make_pictures import HERE, _display, environment

_GAP, _WIDTH = 24, 2400  # px


class Walk:
    """What opens dialogs one after the other, and takes a picture of each."""

    def __init__(self, stage):
        self.stage, self.window, self.pictures = stage, stage.window, []

    def wait(self):
        """Let the window work for a while."""
        self.stage.pause(50)

    def scene(self, name):
        """Take a picture of the dialog, or of the sheet where there is none."""
        self.stage.pause(400)
        shown = [each for each in self.stage.application.topLevelWidgets() if each.isVisible()]
        dialogs = [each for each in shown if each is not self.window.shell and each.layout()]
        self.pictures.append((name, (dialogs or [self.window.help.sheet])[0].grab().toImage()))


def draw(folder: Path, dark: bool) -> None:
    """Write the sheet of one theme."""
    from PySide6.QtCore import QPoint
    from PySide6.QtGui import QColor, QImage, QPainter
    from PySide6.QtWidgets import QApplication
    from stage import Stage
    from walked_dialogs import dialogs

    with tempfile.TemporaryDirectory() as scratch:
        stage = Stage(Path(scratch), quick=True)
        stage.dark, stage.size = dark, (1280, 800)
        stage.open_sample("bottle")
        stage.twist("40deg")
        stage.application = QApplication.instance()
        walk = Walk(stage)
        dialogs(walk)
        corner, row, places = QPoint(_GAP, _GAP), 0, []
        for name, image in walk.pictures:
            if corner.x() + image.width() > _WIDTH and row:
                corner, row = QPoint(_GAP, corner.y() + row + 2 * _GAP), 0
            places.append((corner, name, image))
            corner, row = corner + QPoint(image.width() + _GAP, 0), max(row, image.height())
        sheet = QImage(_WIDTH, corner.y() + row + _GAP, QImage.Format.Format_RGB32)
        sheet.fill(QColor("#808890"))
        painter = QPainter(sheet)
        for place, name, image in places:
            painter.drawText(place - QPoint(0, 6), name)
            painter.drawImage(place, image)
            image.save(str(folder / f"{'dark' if dark else 'light'}-{name}.png"))
        painter.end()
        sheet.save(str(folder / f"dialogs-{'dark' if dark else 'light'}.png"))
        stage.close()
    os._exit(0)  # threads of the window may still be about to end


if __name__ == "__main__":
    if len(sys.argv) == 3:
        draw(Path(sys.argv[1]), sys.argv[2] == "dark")
    Path(sys.argv[1]).mkdir(exist_ok=True)
    with _display() as display:
        own = environment(display) | {"QT_SCALE_FACTOR": "1"}
        own["APD_VIEWER_LANGUAGE"] = os.environ.get("APD_VIEWER_LANGUAGE", "en")
        own["PYTHONPATH"] += os.pathsep + str(HERE.parents[1] / "tests" / "support")
        for theme in ("light", "dark"):
            subprocess.run([sys.executable, __file__, sys.argv[1], theme], env=own, check=True)
