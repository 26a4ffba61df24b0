"""A user of a window: clicks, drags, keys and typed texts, each of which is one input and counted."""

from functools import partial

import numpy as np
from driving import LEFT, NONE, Mouse, centre, idle, work_off
from PySide6.QtCore import QPoint, QPointF, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from apd_viewer.ui.preferences.action_maker import without_mnemonic
from apd_viewer.ui.tools.gizmo_drag import RINGS

_RING = 72  # points of a ring
_TRIES, _PAUSE = 200, 25  # looks for a dialog, and ms between them
_PATIENCE = 600_000  # ms, for a shape to come


class User:
    """What a user does in a window, with the mouse and the keys alone.

    Each input lands where a user's would: on what has the keys, or on what is seen at that place. Then the
    user waits until the shape has come.

    Attributes
    ----------
    inputs : list of str
        What was done: a click, a drag, a key or a typed text each.
    """

    def __init__(self, qtbot, window):
        self._qtbot, self.window = qtbot, window
        self.inputs = []

    @property
    def count(self):
        """Number of inputs so far."""
        return len(self.inputs)

    def wait(self):
        """Look on until nothing moves any more."""
        QApplication.processEvents()
        idle(self._qtbot, self.window, _PATIENCE)
        work_off()

    # Inputs

    def click(self, widget, at=None, name=""):
        """Click on a widget, in its middle or at a position."""
        at = centre(widget) if at is None else QPointF(at)
        _assert_reached(widget, at)
        self._qtbot.mouseClick(widget, LEFT, pos=at.toPoint())
        self._note(f"click {name or widget.accessibleName() or type(widget).__name__}")

    def tick(self, check):
        """Click on the box of a check box."""
        self.click(check, QPoint(8, check.height() // 2), check.text())

    def drag(self, *way, modifiers=NONE):
        """Drag in the view along positions."""
        view = self.window.canvas.viewport
        _assert_reached(view, QPointF(*way[0]))
        mouse = Mouse(view)
        mouse.move(way[0])
        mouse.drag(*way, modifiers=modifiers)
        self._note("drag")

    def key(self, key, modifiers=NONE, answer=None):
        """Press a key; ``answer`` does what the dialog that it opens asks for."""
        if answer is not None:
            QTimer.singleShot(0, partial(self._answer, answer))
        self._note(f"key {key.name}")
        QTest.keyClick(self._with_keys, key, modifiers)
        self.wait()

    def type(self, text):
        """Type a text into the field that has the keys."""
        QTest.keyClicks(self._with_keys, text)
        self._note(f"type {text}")

    def choose(self, *titles):
        """Choose an entry of the menus, with a click on each title."""
        menu = self.window.shell.menuBar()
        for title in titles:
            self._qtbot.waitUntil(menu.isVisible)
            action = next(each for each in menu.actions() if _plain(each.text()) == title)
            self.click(menu, menu.actionGeometry(action).center(), title)
            menu = action.menu()

    def _note(self, text):
        self.inputs.append(text)
        self.wait()

    @property
    def _with_keys(self):
        return QApplication.focusWidget() or QApplication.activeWindow()

    def _answer(self, answer, tries=_TRIES):
        dialog, with_keys = QApplication.activeModalWidget(), QApplication.focusWidget()
        if dialog is None or not dialog.isAncestorOf(with_keys):
            assert tries, "no dialog has opened"
            QTimer.singleShot(_PAUSE, partial(self._answer, answer, tries - 1))
            return
        try:
            answer()
        finally:
            if dialog.isVisible():  # it would be there for ever
                dialog.reject()


def _assert_reached(widget, at):
    """Let no input pass at what is hidden, disabled, covered or scrolled away."""
    top = widget.window()
    assert widget.isVisible()
    assert widget.isEnabled()
    found = top.childAt(widget.mapTo(top, at.toPoint())) or top
    assert widget is found or widget.isAncestorOf(found), f"{found} is in the way"
    modal = QApplication.activeModalWidget()
    assert modal is None or top is modal


def _plain(text):
    return without_mnemonic(text).rstrip("…")


def ring_way(window, axis, degrees):
    """Positions along a ring of the gizmo by so many degrees, in sight as far as can be."""
    frame, view = window.canvas.gizmo.frame, window.canvas.viewport.rect()
    points, near = frame.ring(axis)
    turned = np.arange(round(abs(degrees) / (360 / _RING)) + 1) * int(np.sign(degrees))
    good = [bool(near[k]) and view.contains(QPointF(*points[k]).toPoint()) for k in range(_RING)]
    grips = [k for k in range(_RING) if good[k] and frame.handle_at(*points[k]) == RINGS[axis]]
    first = max(grips, key=lambda k: sum(good[i] for i in (k + turned) % _RING))
    return [tuple(points[k]) for k in (first + turned) % _RING]


def facing(window, chosen):
    """Position of the vertex nearest to the viewer, of those that are chosen by a mask."""
    camera, U = window.canvas.viewport.camera_controller.camera, window.session.store.state.frame.U[chosen]
    return camera.project(U[[np.argmin(camera.depth(U))]])[0]


def line(start, end, count=8):
    """Positions along a line on the screen."""
    return [tuple(point) for point in np.linspace(start, end, count)]
