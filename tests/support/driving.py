"""Driving a window from a test: a mouse, waiting for the draws, and a plain colour."""

import time

import numpy as np
from PySide6.QtCore import QCoreApplication, QEvent, QObject, QPoint, QPointF, Qt
from PySide6.QtGui import QGuiApplication, QMouseEvent, QWheelEvent
from PySide6.QtWidgets import QApplication

from apd_viewer.session.state_store import Activity

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


class _Bustle(QObject):
    """Notes whether anything was delivered to anybody."""

    def __init__(self):
        super().__init__()
        self.any = False

    def eventFilter(self, _receiver, _event):
        self.any = True
        return False


def work_off(rounds=100):
    """Deliver what waits for the event loop until nothing new comes: layouts, paints, deletions.

    What takes a time of its own, such as a frame of the solver or a timer, needs a condition of its own.
    """
    bustle, application = _Bustle(), QApplication.instance()
    application.installEventFilter(bustle)
    try:
        for _ in range(rounds):
            bustle.any = False
            QGuiApplication.sync()
            QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
            if not bustle.any:
                return
    finally:
        application.removeEventFilter(bustle)
    raise AssertionError("the window goes on and on")


def show(qtbot, widget, view):
    """Show a window and wait until its viewport has drawn."""
    widget.show()
    qtbot.waitExposed(widget)
    if QGuiApplication.platformName() != "offscreen":
        qtbot.waitUntil(lambda: view.draw_count > 0)
        settle(qtbot, view)


def settle(qtbot, view):
    """Wait until the scene is drawn, and leave out the smooth frame of a resting view."""
    if QGuiApplication.platformName() != "offscreen":
        still = view.antialiasing.idle_timer
        interval = still.interval()
        still.setInterval(10**6)  # on a busy machine it would be over before the draw is seen
        qtbot.waitUntil(lambda: not view.is_stale)
        still.stop()
        still.setInterval(interval)


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


def rest(qtbot, value, seconds=0.1):
    """Let the event loop run until a value has stayed the same for so long."""
    last, since = value(), time.perf_counter()

    def rests():
        nonlocal last, since
        if (now := value()) is not last:
            last, since = now, time.perf_counter()
        return time.perf_counter() - since > seconds

    qtbot.waitUntil(rests, timeout=60_000)


def follow(qtbot, window, act):
    """Do something, and let the event loop run until the shape has followed."""
    store = window.session.store
    before = store.state.frame
    act()
    QApplication.processEvents()
    qtbot.waitUntil(
        lambda: store.activity is not Activity.REFINING or store.state.frame is not before, timeout=60_000
    )


def document(window):
    return window.session.store.state.document


def on_screen(window, vertex):
    return window.canvas.viewport.camera_controller.camera.project(
        window.session.store.state.frame.U[[vertex]]
    )[0]


def stroke(qtbot, window, middle, half_width=30):
    """Paint a horizontal stroke around a point on the screen."""
    mouse = Mouse(window.canvas.viewport)
    points = [(middle[0] + dx, middle[1]) for dx in np.linspace(-half_width, half_width, 7)]
    mouse.move(points[0])
    mouse.drag(*points)
    QApplication.processEvents()


def drag(qtbot, window, start, way, steps=5):
    """Drag with the left button in small steps, each of which the shape follows."""
    mouse = Mouse(window.canvas.viewport)
    start, way = np.asarray(start, float), np.asarray(way, float)
    mouse.move(start)
    mouse.press(start)
    for t in np.linspace(0.0, 1.0, steps + 1)[1:]:
        follow(qtbot, window, lambda t=t: mouse.move(start + t * way))
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
