"""Pens, fingers and trackpads, as mouse events or moves of the camera.

A pen is a mouse with a pressure. One finger drags as the left button does; two fingers, on a screen or a
trackpad, pan, zoom and turn. What is taken here is accepted, so that Qt makes no event of the mouse from it.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from PySide6.QtCore import QEvent, QPointF, Qt
from PySide6.QtGui import (
    QEventPoint,
    QInputDevice,
    QInputEvent,
    QMouseEvent,
    QNativeGestureEvent,
    QPointingDevice,
    QTabletEvent,
    QTouchEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QWidget

from apd_viewer.ui.scene.camera_controller import CameraController

LEAST_SHARE = 0.15  # of the radius of a brush, under a pen without any pressure
SLOP = 4.0  # px: a finger that moves no farther taps
LEAST_TURN = 15.0  # degrees: fingers that turn less only pan and zoom
_LEAST_FACTOR = 0.2  # of one pinch event
_PIXELS_PER_NOTCH = 60.0  # of a trackpad that reports no angles

_PRESS, _MOVE = QEvent.Type.MouseButtonPress, QEvent.Type.MouseMove
_RELEASE = QEvent.Type.MouseButtonRelease
_OF_PEN = {
    QEvent.Type.TabletPress: _PRESS,
    QEvent.Type.TabletMove: _MOVE,
    QEvent.Type.TabletRelease: _RELEASE,
}


class PenEvent(QMouseEvent):
    """Mouse event of a pen.

    Attributes
    ----------
    pressure : float
        From 0 to 1; 1 of a pen that measures none.
    erases : bool
        Whether the eraser end touches.
    """

    def __init__(self, event: QTabletEvent) -> None:
        kind, at, device = _OF_PEN[event.type()], event.position(), event.pointingDevice()
        keys = event.button(), event.buttons(), event.modifiers()
        super().__init__(kind, at, event.globalPosition(), *keys, device)
        has_pressure = bool(device.capabilities() & QInputDevice.Capability.Pressure)
        self.pressure = min(max(event.pressure(), 0.0), 1.0) if has_pressure else 1.0
        self.erases = event.pointerType() == QPointingDevice.PointerType.Eraser


def brush_share(event: QInputEvent) -> float:
    """Share of its radius that a brush has, by the pressure of a pen; 1 of a mouse."""
    return LEAST_SHARE + (1.0 - LEAST_SHARE) * event.pressure if isinstance(event, PenEvent) else 1.0


def wheel_notches(event: QWheelEvent) -> float:
    """Notches of a turn of the wheel; a small fraction for two fingers on a trackpad."""
    angle, pixels = event.angleDelta(), event.pixelDelta()
    if not angle.y() and event.modifiers() & Qt.KeyboardModifier.AltModifier:
        angle, pixels = angle.transposed(), pixels.transposed()  # as Qt has it while Alt is down
    if pixels.isNull():
        return angle.y() / 120.0
    notches = angle.y() / 120.0 or pixels.y() / _PIXELS_PER_NOTCH
    return min(max(notches, -1.0), 1.0)  # a flick comes in few large steps


class WheelSteps:
    """Whole notches of the wheel, gathered from the fractions of a trackpad."""

    def __init__(self) -> None:
        self._rest = 0.0

    def take(self, event: QWheelEvent) -> int:
        """Whole notches that this turn completes."""
        self._rest += wheel_notches(event)
        steps = int(round(self._rest, 6))
        self._rest -= steps
        return steps


class Pointing:
    """Pen, fingers and trackpad gestures of a viewport.

    Parameters
    ----------
    abandon : callable
        Cancels the drag in progress, with the event that ends it.
    leave : callable
        Tells the tools that nothing points at the viewport any more.
    """

    def __init__(
        self,
        viewport: QWidget,
        camera_controller: CameraController,
        abandon: Callable[[QMouseEvent], None],
        leave: Callable[[], None],
    ) -> None:
        self._viewport = viewport
        self._gesture = _CameraGesture(camera_controller)
        self._fingers = _Fingers(viewport, self._gesture, abandon, leave)
        self._pen_is_down = False
        viewport.setAttribute(Qt.WidgetAttribute.WA_AcceptTouchEvents)

    def take(self, event: QEvent) -> bool:
        """Handle an event of a pen, a finger or a trackpad; False for all others."""
        if isinstance(event, QNativeGestureEvent):
            self._gesture.take(event)
        elif isinstance(event, QTabletEvent):
            event.setAccepted(self._take_pen(event))
        elif isinstance(event, QTouchEvent):
            event.setAccepted(self._fingers.take(event))
        else:
            return False
        return True

    def _take_pen(self, event: QTabletEvent) -> bool:
        """Draw with a pen; one in the air is left to Qt, which makes it a mouse."""
        if event.type() == QEvent.Type.TabletPress:
            self._pen_is_down = self._pen_is_down or not is_covered(self._viewport, event.position())
        if not self._pen_is_down or event.type() not in _OF_PEN:
            return False
        self._pen_is_down = event.buttons() != Qt.MouseButton.NoButton
        send(self._viewport, PenEvent(event))
        return True


def is_covered(viewport: QWidget, position: QPointF) -> bool:
    """True where a card or another widget lies over the viewport."""
    return viewport.childAt(position.toPoint()) is not None


def send(viewport: QWidget, event: QMouseEvent) -> None:
    """Have the viewport handle an event as one of the mouse."""
    if event.type() == _PRESS:
        viewport.mousePressEvent(event)
    elif event.type() == _MOVE:
        viewport.mouseMoveEvent(event)
    else:
        viewport.mouseReleaseEvent(event)


class _Fingers:
    """Fingers on a screen: one drags, two move the camera.

    The press waits until the finger has moved or is lifted, since a second one may follow.
    """

    def __init__(
        self,
        viewport: QWidget,
        gesture: _CameraGesture,
        abandon: Callable[[QMouseEvent], None],
        leave: Callable[[], None],
    ) -> None:
        self._viewport, self._gesture = viewport, gesture
        self._cancel, self._leave = abandon, leave
        self._most = 0  # fingers at once since the first one touched; 0 if the touch is none of ours
        self._drags = False
        self._pair: tuple[QPointF, QPointF] | None = None

    def take(self, event: QTouchEvent) -> bool:
        if event.pointingDevice().type() != QInputDevice.DeviceType.TouchScreen:
            return False  # fingers on a trackpad move the cursor, too
        points = event.points()
        if event.type() == QEvent.Type.TouchBegin:
            self._most, self._pair = int(not is_covered(self._viewport, points[0].position())), None
        if self._most == 0:
            return False
        down = [point for point in points if point.state() != QEventPoint.State.Released]
        self._most = max(self._most, len(down))
        if event.type() == QEvent.Type.TouchCancel or self._most > 1:
            self._abandon(points[0], event)
            self._follow(down)
        else:
            self._drag(points[0], event)
        return True

    def _drag(self, point: QEventPoint, event: QTouchEvent) -> None:
        """Drag by the only finger."""
        start, here = point.pressPosition(), point.position()
        lifted = point.state() == QEventPoint.State.Released
        if not self._drags and (lifted or (here - start).manhattanLength() > SLOP):
            self._drags = True
            self._send(_PRESS, start, point, event)
        if self._drags and here != start:
            self._send(_MOVE, here, point, event)
        if lifted:
            self._drags = False
            self._send(_RELEASE, here, point, event)
            self._leave()  # a lifted finger points at nothing

    def _abandon(self, point: QEventPoint, event: QTouchEvent) -> None:
        """Cancel the drag of the first finger."""
        if self._drags:
            self._drags = False
            self._cancel(_mouse_event(_RELEASE, point.position(), point, event))
            self._leave()

    def _follow(self, down: list[QEventPoint]) -> None:
        """Have the camera follow two fingers."""
        if len(down) < 2:
            self._pair = None
            return
        a, b = (point.position() for point in sorted(down, key=lambda point: point.id())[:2])
        if self._pair is None:
            self._gesture.begin()
        else:
            (c, d), shift = self._pair, (a + b - self._pair[0] - self._pair[1]) / 2.0
            was, now = d - c, b - a
            self._gesture.pan(shift)
            self._gesture.zoom((a + b) / 2.0, max(_length(now), 1.0) / max(_length(was), 1.0))
            angle = math.degrees(math.atan2(now.y(), now.x()) - math.atan2(was.y(), was.x()))
            self._gesture.turn((angle + 180.0) % 360.0 - 180.0)
        self._pair = a, b

    def _send(self, kind: QEvent.Type, at: QPointF, point: QEventPoint, event: QTouchEvent) -> None:
        send(self._viewport, _mouse_event(kind, at, point, event))


def _mouse_event(kind: QEvent.Type, at: QPointF, point: QEventPoint, event: QTouchEvent) -> QMouseEvent:
    """Event of the left button for a finger."""
    left, none = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton
    button, buttons = none if kind == _MOVE else left, none if kind == _RELEASE else left
    place = at + point.globalPosition() - point.position()
    return QMouseEvent(kind, at, place, button, buttons, event.modifiers(), event.pointingDevice())


def _length(way: QPointF) -> float:
    return math.hypot(way.x(), way.y())


class _CameraGesture:
    """Moves of the camera by two fingers."""

    def __init__(self, camera_controller: CameraController) -> None:
        self._look = camera_controller
        self._turned = 0.0  # degrees since the fingers touched

    def begin(self) -> None:
        """Begin anew: small turns do nothing at first."""
        self._turned = 0.0

    def take(self, event: QNativeGestureEvent) -> None:
        """Follow the fingers on a trackpad."""
        kind = event.gestureType()
        if kind == Qt.NativeGestureType.BeginNativeGesture:
            self.begin()
        elif kind == Qt.NativeGestureType.ZoomNativeGesture:
            self.zoom(event.position(), 1.0 + event.value())
        elif kind == Qt.NativeGestureType.RotateNativeGesture:
            self.turn(event.value())
        elif kind == Qt.NativeGestureType.PanNativeGesture:
            self.pan(event.delta())

    def pan(self, way: QPointF) -> None:
        if not way.isNull():
            self._look.camera = self._look.camera.panned(way.x(), way.y())

    def zoom(self, centre: QPointF, factor: float) -> None:
        if factor != 1.0:
            self._look.zoom_at(centre, max(factor, _LEAST_FACTOR))

    def turn(self, degrees: float) -> None:
        """Turn clockwise about the up axis, once the fingers have clearly turned."""
        if abs(self._turned) > LEAST_TURN and degrees != 0.0:
            self._look.camera = self._look.camera.turned(degrees)
        elif abs(self._turned) <= LEAST_TURN:
            self._turned += degrees
