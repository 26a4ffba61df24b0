"""Four methods side by side, in the window that compares them."""

from PySide6.QtGui import QImage
from stage import Stage


def draw(stage: Stage) -> QImage:
    """Twist by 60 degrees and compare; times are left out."""
    stage.open_sample("bottle")
    stage.window.session.settings.set_contact(False)
    stage.twist("60deg")
    stage.window.comparison.open()
    side = stage.window.comparison.window
    side.resize(1320, 820)
    stage.wait(
        lambda: all(view.status_texts[0] != "" and view.values is not None for view in side.views.values())
    )
    stage.wait(lambda: not side.stop.isEnabled() or stage.quick)
    stage.pause(600)
    table = side.table
    for column in range(table.columnCount()):
        if table.horizontalHeaderItem(column).text() == "Time":  # another one each time
            table.setColumnHidden(column, True)
    stage.pause(50)
    return stage.dialog(side)
