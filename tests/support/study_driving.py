"""Driving a dialog that runs a command."""

from driving import Mouse, centre


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
