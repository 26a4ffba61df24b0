"""Driving a dialog that runs a command."""

from driving import Mouse, centre, idle
from meshes import box, ends

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
    qtbot.waitUntil(lambda: not dialog.run.running, timeout=60_000)


def open_bar(qtbot, window):
    """Open a bar, and paint its ends."""
    V, F = box(2, 2, 5)
    window.session.files.open_mesh(Mesh(V, F))
    idle(qtbot, window)
    base, handle = ends(V)
    window.session.gestures.begin()
    window.session.painting.paint(base, 0)
    window.session.painting.paint(handle, 2)
    window.session.painting.end_stroke("Paint")
