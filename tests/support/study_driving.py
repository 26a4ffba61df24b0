"""Driving a dialog that runs a command."""

from driving import LEFT, Mouse, centre, idle
from meshes import box, ends
from PySide6.QtCore import QPointF, Qt

from apd_viewer.geometry.mesh.mesh import Mesh


def click(button):
    """A click of the mouse, as a user makes it."""
    assert button.isVisible()
    assert button.isEnabled()
    mouse = Mouse(button)
    mouse.move(centre(button))
    mouse.press(centre(button))
    mouse.release(centre(button))


def finish(qtbot, dialog):
    # 5 s on two quiet cores; beside other programs a minute was too short.
    qtbot.waitUntil(lambda: not dialog.run.is_running, timeout=240_000)


def open_bar(qtbot, window):
    """Open a bar, paint its ends, and wait until it has settled."""
    V, F = box(2, 2, 5)
    window.session.files.open_mesh(Mesh(V, F))
    idle(qtbot, window)
    base, handle = ends(V)
    window.session.gestures.begin()
    window.session.painting.paint(base, 0)
    window.session.painting.paint(handle, 2)
    window.session.painting.end_stroke("Paint")
    idle(qtbot, window)


def finished(window, count):
    """Whether the study runs no more, and so many of its cases are done."""
    panel = window.case_studies.panel
    return (
        not window.case_studies.run.is_running
        and [row.status for row in panel.model.rows].count("done") == count
    )


def tick(check):
    """Click on a box beside its words."""
    at = QPointF(8.0, check.height() / 2.0)
    mouse = Mouse(check)
    mouse.press(at)
    mouse.release(at)


def press_row(panel, row, modifiers=Qt.KeyboardModifier.NoModifier):
    """Click on a row of the table."""
    view = panel.table.viewport()
    panel.table.scrollTo(panel.model.index(row, 0))
    at = QPointF(panel.table.visualRect(panel.model.index(row, 0)).center())
    mouse = Mouse(view)
    mouse.move(at)
    mouse.press(at, LEFT, modifiers)
    mouse.release(at, LEFT, modifiers)
