"""The same as in ``window.py``, in the dark scheme."""

from make_pictures import drawer
from PySide6.QtGui import QImage
from stage import Stage


def draw(stage: Stage) -> QImage:
    """Drive the window as in the light scheme."""
    stage.dark = True
    picture: QImage = drawer("window")(stage)
    return picture
