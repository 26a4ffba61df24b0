"""Driving a window from a test: a mouse, waiting for the draws, and a plain colour."""

import numpy as np
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QGuiApplication, QMouseEvent, QWheelEvent
from PySide6.QtWidgets import QApplication

from apd_viewer.session.store import Activity

NONE = Qt.KeyboardModifier.NoModifier
LEFT = Qt.MouseButton.LeftButton


class Mouse:
    """Mouse events sent straight to a widget.

    QTest.mouseMove without a pressed button warps the X cursor, and the event comes some time later.
    """

    def __init__(self, widget):
        self.widget = widget
        self.buttons = Qt.MouseButton.NoButton

    def move(self, to, modifiers=NONE):
        self._send(QEvent.Type.MouseMove, to, Qt.MouseButton.NoButton, modifiers)

    def press(self, at, button=LEFT, modifiers=NONE):
        self.buttons |= button
        self._send(QEvent.Type.MouseButtonPress, at, button, modifiers)

    def release(self, at, button=LEFT, modifiers=NONE):
        self.buttons &= ~button
        self._send(QEvent.Type.MouseButtonRelease, at, button, modifiers)

    def drag(self, *way, button=LEFT, modifiers=NONE):
        """Press at the first point, move over the others and let go at the last."""
        self.press(way[0], button, modifiers)
        for point in way[1:]:
            self.move(point, modifiers)
        self.release(way[-1], button, modifiers)

    def double_click(self, at):
        """The second press of two quick ones, and its release."""
        self.buttons |= LEFT
        self._send(QEvent.Type.MouseButtonDblClick, at, LEFT, NONE)
        self.release(at)

    def wheel(self, at, notches, modifiers=NONE):
        at = _point(at)
        turn = QPoint(0, round(120 * notches))
        phase = Qt.ScrollPhase.NoScrollPhase
        event = QWheelEvent(
            at, self.widget.mapToGlobal(at), QPoint(), turn, self.buttons, modifiers, phase, False
        )
        QApplication.sendEvent(self.widget, event)

    def _send(self, kind, at, button, modifiers):
        at = _point(at)
        event = QMouseEvent(kind, at, self.widget.mapToGlobal(at), button, self.buttons, modifiers)
        QApplication.sendEvent(self.widget, event)


def _point(at):
    return QPointF(at) if isinstance(at, QPointF | QPoint) else QPointF(*map(float, at))


def show(qtbot, widget, view):
    """Show a window and wait until its viewport has drawn."""
    widget.show()
    qtbot.waitExposed(widget)
    if QGuiApplication.platformName() != "offscreen":
        qtbot.waitUntil(lambda: view.draws > 0, timeout=10_000)
        settle(qtbot, view)


def settle(qtbot, view):
    """Wait until the scene is drawn, and leave out the smooth frame of a resting view."""
    if QGuiApplication.platformName() != "offscreen":
        qtbot.waitUntil(lambda: not view._stale, timeout=5_000)
        view.antialiasing.still.stop()


def grey(n):
    return np.tile(np.array([200, 200, 200, 255], dtype=np.uint8), (n, 1))


def centre(view):
    return QPointF(view.width() / 2, view.height() / 2)


def idle(qtbot, window, timeout=60_000):
    """Let the event loop run until nothing is opened, written or refined any more."""
    session = window.session
    qtbot.waitUntil(
        lambda: session.jobs.current is None and session.store.activity is not Activity.REFINING,
        timeout=timeout,
    )


def document(window):
    return window.session.store.state.document


def on_screen(window, vertex):
    return window.canvas.viewport.look.eye.project(window.session.store.state.frame.U[[vertex]])[0]


def stroke(qtbot, window, middle, half_width=30):
    """Paint a horizontal stroke around a point on the screen."""
    mouse = Mouse(window.canvas.viewport)
    points = [(middle[0] + dx, middle[1]) for dx in np.linspace(-half_width, half_width, 7)]
    mouse.move(points[0])
    mouse.drag(*points)
    qtbot.wait(10)


def drag(qtbot, window, start, way, steps=12, pause=20):
    """Drag with the left button in small steps, letting the window work in between."""
    mouse = Mouse(window.canvas.viewport)
    start, way = np.asarray(start, float), np.asarray(way, float)
    mouse.move(start)
    mouse.press(start)
    for t in np.linspace(0.0, 1.0, steps + 1)[1:]:
        mouse.move(start + t * way)
        qtbot.wait(pause)
    mouse.release(start + way)


def ring_grip(window, axis):
    """A point of the gizmo's ring about an axis that no other part of the gizmo is nearer to."""
    frame = window.canvas.gizmo.frame
    points, near = frame.ring(axis)
    taken = [frame.handle_at(*p) for p in points]
    name = max(set(taken) - {None}, key=lambda n: sum(t == n for t in taken))
    good = [p for p, t, n in zip(points, taken, near, strict=True) if n and t == name]
    return good[len(good) // 2]


def arrow_grip(window, axis):
    frame = window.canvas.gizmo.frame
    return frame.arrow(axis)[1]
