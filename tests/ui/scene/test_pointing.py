"""Pens, fingers and trackpads, by events made here and sent to the window; no device was at hand."""

import numpy as np
import pytest
from driving import centre, document, settle
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import (
    QImage,
    QInputDevice,
    QNativeGestureEvent,
    QPainter,
    QPointingDevice,
    QPointingDeviceUniqueId,
    QTabletEvent,
    QWheelEvent,
)
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLabel

from apd_viewer.geometry.pose.constraints import BASE, FREE
from apd_viewer.ui.scene.navigation import MouseTool
from apd_viewer.ui.scene.pointing import LEAST_SHARE, LEAST_TURN, SLOP
from apd_viewer.ui.tools.brush_tool import BrushTool
from apd_viewer.ui.tools.outline_tool import SlabTool
from apd_viewer.ui.tools.tool_modes import Tool

PRESS, MOVE, RELEASE = QEvent.Type.TabletPress, QEvent.Type.TabletMove, QEvent.Type.TabletRelease
LEFT, RIGHT = Qt.MouseButton.LeftButton, Qt.MouseButton.RightButton
NO_BUTTON, NO_KEY = Qt.MouseButton.NoButton, Qt.KeyboardModifier.NoModifier
Tip = QPointingDevice.PointerType
Gesture = Qt.NativeGestureType
NOWHERE, BESIDE_THE_MIDDLE = QPointF(0, 0), QPointF(370, 200)
POSITION = QInputDevice.Capability.Position


class Pen:
    """Events of a pen, sent to the window as the window system sends them."""

    def __init__(self, view, tip=Tip.Pen, abilities=POSITION | QInputDevice.Capability.Pressure):
        kind = QInputDevice.DeviceType.Stylus
        self.view = view
        self.device = QPointingDevice("pen", 7, kind, tip, abilities, 1, 3, "", QPointingDeviceUniqueId())

    def send(self, kind, at, pressure=0.0, button=NO_BUTTON, buttons=NO_BUTTON):
        """Send an event; True if it was taken, so that Qt makes none of the mouse."""
        window = self.view.window()
        place = QPointF(self.view.mapTo(window, at.toPoint())) + at - QPointF(at.toPoint())
        event = QTabletEvent(
            kind,
            self.device,
            place,
            self.view.mapToGlobal(at),
            pressure,
            0,
            0,
            0.0,
            0.0,
            0.0,
            NO_KEY,
            button,
            buttons,
        )
        QApplication.sendEvent(window.windowHandle(), event)
        return event.isAccepted()

    def drag(self, pressures, *way, button=LEFT):
        taken = [self.send(PRESS, way[0], pressures[0], button, button)]
        for at, pressure in zip(way[1:], pressures[1:], strict=True):
            taken.append(self.send(MOVE, at, pressure, NO_BUTTON, button))
        return [*taken, self.send(RELEASE, way[-1], 0.0, button)]


@pytest.fixture
def brush(view, surface):
    brush = BrushTool(view, surface)
    brush.enabled = True
    view.tools.append(brush)
    return brush


@pytest.fixture
def painted(brush):
    """Vertices of all strokes, one array a stroke."""
    strokes = []
    brush.stroke_began.connect(lambda _: strokes.append(np.empty(0, dtype=int)))
    brush.vertices_painted.connect(lambda ids: strokes.append(np.append(strokes.pop(), ids)))
    return strokes


def within(view, surface, brush, at, share):
    """Vertices of the ball within a share of the radius around a point of the screen."""
    hit = surface.hit(at)
    radius = share * brush.size.radius * view.camera_controller.camera.world_per_pixel(hit.point)
    return np.flatnonzero(np.linalg.norm(surface.U - hit.point, axis=1) <= radius)


@pytest.mark.parametrize("pressure", [1.0, 0.5, 0.0])
def test_brush_tool_paints_the_radius_that_the_pressure_allows(view, surface, brush, painted, pressure):
    brush.size.radius = 150.0
    at = centre(view)
    assert all(Pen(view).drag([pressure], at))
    share = LEAST_SHARE + (1.0 - LEAST_SHARE) * pressure
    np.testing.assert_array_equal(np.sort(painted[0]), within(view, surface, brush, at, share))
    assert len(painted[0]) > 5


def test_brush_tool_widens_a_stroke_evenly_with_the_pressure(view, surface, brush, painted):
    """A stroke in one leap from light to firm is a wedge: as wide at each place as the pressure there."""
    brush.size.radius = 40.0
    start, end = QPointF(240, 240), QPointF(400, 240)
    Pen(view).drag([0.0, 1.0], start, end)
    places = view.camera_controller.camera.project(surface.U[painted[0]])
    for x, share in ((270, 0.34), (320, 0.58), (370, 0.84)):
        near = np.abs(places[:, 0] - x) < 8.0
        assert np.abs(places[near, 1] - 240.0).max() == pytest.approx(40.0 * share, abs=7.0)


def test_brush_tool_takes_a_pen_without_pressure_as_a_mouse(view, surface, brush, painted, mouse):
    at = centre(view)
    mouse(view).drag(at, at)
    Pen(view, abilities=POSITION).drag([0.0], at)
    np.testing.assert_array_equal(painted[0], painted[1])


def ring_span(view, brush):
    """Width of the ring that the brush draws, in pixels."""
    image = QImage(view.size(), QImage.Format.Format_ARGB32)
    image.fill(0)
    with QPainter(image) as painter:
        brush.paint(painter)
    alpha = np.frombuffer(image.constBits(), dtype=np.uint8).reshape(image.height(), image.width(), 4)
    return int(np.ptp(np.flatnonzero(alpha[:, :, 3].any(axis=0))))


def test_brush_tool_has_a_ring_of_the_pressure_and_the_whole_one_in_the_air(view, brush, mouse):
    brush.size.radius = 60.0
    at, pen, mouse = centre(view), Pen(view), mouse(view)
    assert not pen.send(MOVE, at)  # left to Qt, which makes a move of the mouse from it
    mouse.move(at)
    whole = ring_span(view, brush)
    pen.send(PRESS, at, 0.2, LEFT, LEFT)
    assert ring_span(view, brush) == pytest.approx(whole * (LEAST_SHARE + 0.2 * (1 - LEAST_SHARE)), abs=6)
    pen.send(MOVE, at + QPointF(1, 0), 1.0, NO_BUTTON, LEFT)
    assert ring_span(view, brush) == pytest.approx(whole, abs=2)
    pen.send(RELEASE, at, 0.0, LEFT)
    mouse.move(at)
    assert ring_span(view, brush) == whole


def labels_at(window, at):
    """Labels of the triangle at a point of the screen."""
    hit = window.canvas.surface.hit(at)
    return document(window).labels[document(window).mesh.F[hit.face]]


def test_stroke_effect_of_the_eraser_end_is_to_remove(qtbot, bottle):
    view = bottle.canvas.viewport
    bottle.tools.choose_tool(Tool.BASE)
    bottle.canvas.brush.size.radius = 60.0
    settle(qtbot, view)
    at = centre(view)
    Pen(view).drag([1.0], at)
    assert (labels_at(bottle, at) == BASE).all()
    Pen(view, Tip.Eraser).drag([1.0], at)
    assert (labels_at(bottle, at) == FREE).all()
    bottle.session.gestures.undo()
    assert (labels_at(bottle, at) == BASE).all()


def test_pointing_has_the_button_of_a_pen_orbit_and_paint_nothing(view, brush, painted):
    before, at = view.camera_controller.camera, centre(view)
    Pen(view).drag([0.4, 0.4], at, at + QPointF(50, 0), button=RIGHT)
    after = view.camera_controller.camera
    assert painted == []
    assert np.abs(after.axes - before.axes).max() > 0.1


def test_pointing_leaves_a_pen_on_a_card_to_the_card(view, brush, painted):
    card = QLabel("card", view)
    card.setGeometry(300, 220, 60, 60)
    card.show()
    pen, at = Pen(view), QPointF(320, 240)
    assert pen.drag([1.0, 1.0], at, QPointF(420, 240)) == [False] * 3
    assert painted == []
    assert all(pen.drag([1.0], QPointF(420, 240)))
    assert len(painted) == 1


@pytest.fixture(scope="module")
def screen(qapp):
    return QTest.createTouchDevice()


class Fingers:
    """Fingers on a screen; Qt makes events of the mouse from what is not taken."""

    def __init__(self, view, device):
        self.view, self.device, self.down = view, device, {}

    def _commit(self, act, places):
        sequence = QTest.touchEvent(self.view, self.device, False)
        for finger, at in self.down.items():  # a resting one would be at the origin
            if finger not in places:
                sequence.move(finger, QPoint(*map(round, at)), self.view)
        for finger, at in places.items():
            getattr(sequence, act)(finger, QPoint(*map(round, at)), self.view)
        sequence.commit()

    def press(self, **places):
        places = numbered(places)
        self._commit("press", places)
        self.down |= places

    def move(self, **places):
        self._commit("move", numbered(places))
        self.down |= numbered(places)

    def release(self, *names):
        places = {ord(name): self.down.pop(ord(name)) for name in names}
        self._commit("release", places)

    def drag(self, *way):
        self.press(a=way[0])
        for at in way[1:]:
            self.move(a=at)
        self.release("a")


def numbered(places):
    return {ord(name): at for name, at in places.items()}


@pytest.fixture
def fingers(view, surface, screen):
    return Fingers(view, screen)


class Pressed(MouseTool):
    """Notes the presses and releases that tools get."""

    def __init__(self):
        self.events = []

    def press(self, event):
        self.events.append((event.type(), event.position().toTuple()))
        return True

    def release(self, event):
        self.events.append((event.type(), event.position().toTuple()))


def test_pointing_gives_tools_one_press_for_one_finger(view, fingers):
    tool = Pressed()
    view.tools.append(tool)
    fingers.drag((200, 200), (230, 210), (260, 220))
    fingers.drag((100, 110))
    press, release = QEvent.Type.MouseButtonPress, QEvent.Type.MouseButtonRelease
    places = [(press, (200, 200)), (release, (260, 220)), (press, (100, 110)), (release, (100, 110))]
    assert tool.events == places


def test_pointing_paints_by_a_finger_what_the_mouse_paints(view, fingers, brush, painted, mouse):
    way = [(280, 240), (320, 250), (360, 260)]
    mouse(view).drag(*way)
    fingers.drag(*way)
    np.testing.assert_array_equal(np.sort(painted[0]), np.sort(painted[1]))
    assert brush.cancel() is False


def test_pointing_orbits_by_a_finger_beside_the_mesh_as_the_mouse_does(view, fingers, mouse):
    way, before = [(10, 10), (60, 40), (90, 60)], view.camera_controller.camera
    mouse(view).drag(*way)
    expected, view.camera_controller.camera = view.camera_controller.camera, before
    fingers.drag(*way)
    np.testing.assert_allclose(view.camera_controller.camera.position, expected.position)
    assert not np.allclose(expected.position, before.position)


def test_pointing_paints_nothing_by_the_first_of_two_fingers(view, fingers, brush, painted):
    cancelled = []
    brush.stroke_cancelled.connect(lambda: cancelled.append(True))
    fingers.press(a=(300, 240))
    fingers.move(a=(300 + SLOP / 2, 240))
    fingers.press(b=(360, 240))
    fingers.move(a=(290, 240), b=(370, 240))
    fingers.release("a", "b")
    assert (painted, cancelled) == ([], [])
    fingers.press(a=(300, 240))
    fingers.move(a=(330, 240))
    fingers.press(b=(380, 240))
    fingers.release("a", "b")
    assert (len(painted), cancelled) == (1, [True])


def test_pointing_zooms_about_the_middle_of_two_fingers(view, surface, fingers):
    look, middle = view.camera_controller, QPointF(370, 200)
    point, before = surface.hit(middle).point, look.camera
    fingers.press(a=(330, 200), b=(410, 200))
    for half in range(40, 81, 5):
        fingers.move(a=(370 - half, 200), b=(370 + half, 200))
    fingers.release("a", "b")
    nearer = np.linalg.norm(look.camera.position - point) / np.linalg.norm(before.position - point)
    assert nearer == pytest.approx(0.5, rel=1e-6)
    np.testing.assert_allclose(look.camera.project(point[None])[0], [370, 200], atol=1e-6)
    np.testing.assert_allclose(look.camera.axes, before.axes, atol=1e-9)


def test_pointing_pans_by_two_fingers_and_not_by_the_one_that_stays(view, fingers):
    look = view.camera_controller
    before = look.camera
    fingers.press(a=(300, 200), b=(380, 200))
    fingers.move(a=(320, 230), b=(400, 230))
    fingers.release("b")
    after = look.camera
    np.testing.assert_allclose(after.position, before.panned(20, 30).position, atol=1e-9)
    fingers.move(a=(250, 300))
    fingers.release("a")
    np.testing.assert_array_equal(look.camera.position, after.position)


def around(degrees, radius=60.0):
    """Two places opposite to each other around the middle of the view."""
    way = radius * np.array([np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))])
    return {"a": np.array([320, 240]) + way, "b": np.array([320, 240]) - way}


def test_pointing_turns_the_mesh_as_two_fingers_turn_seen_from_above(view, surface, fingers):
    look = view.camera_controller
    look.show_standard_view("top")
    before, point = look.camera, np.array([0.5, 0.0, 0.0])
    start = before.project(np.array([point]))[0] - [320, 240]
    fingers.press(**around(0))
    for degrees in range(5, 66, 5):
        fingers.move(**around(degrees))
    fingers.release("a", "b")
    end = look.camera.project(np.array([point]))[0] - [320, 240]
    # Clockwise on the screen, whose y points down, angles grow.
    turned = np.rad2deg(np.arctan2(*end[::-1]) - np.arctan2(*start[::-1]))
    assert 65 - LEAST_TURN - 7 <= turned <= 65 - LEAST_TURN + 2


def gesture(view, kind, value=0.0, delta=NOWHERE, at=BESIDE_THE_MIDDLE):
    """Send a gesture on a trackpad to the window."""
    device = QPointingDevice.primaryPointingDevice()
    place = QPointF(view.mapTo(view.window(), at.toPoint()))
    event = QNativeGestureEvent(kind, device, 2, place, place, view.mapToGlobal(at), value, delta)
    QApplication.sendEvent(view.window().windowHandle(), event)


def test_pointing_zooms_by_a_pinch_on_the_trackpad_about_the_cursor(view, surface):
    look, point = view.camera_controller, surface.hit(QPointF(370, 200)).point
    before = look.camera
    gesture(view, Gesture.BeginNativeGesture)
    gesture(view, Gesture.ZoomNativeGesture, 0.25)
    nearer = np.linalg.norm(look.camera.position - point) / np.linalg.norm(before.position - point)
    assert nearer == pytest.approx(0.8)
    np.testing.assert_allclose(look.camera.project(point[None])[0], [370, 200], atol=1e-6)
    gesture(view, Gesture.ZoomNativeGesture, -3.0)  # no camera behind itself
    assert look.camera.axes[2] @ before.axes[2] == pytest.approx(1.0)
    assert (look.camera.depth(surface.U) > 0.0).all()


def test_pointing_pans_and_turns_by_a_trackpad(view, surface):
    look = view.camera_controller
    before = look.camera
    gesture(view, Gesture.PanNativeGesture, delta=QPointF(12, -7))
    np.testing.assert_allclose(look.camera.position, before.panned(12, -7).position, atol=1e-9)
    gesture(view, Gesture.BeginNativeGesture)
    panned = look.camera
    gesture(view, Gesture.RotateNativeGesture, LEAST_TURN - 1.0)
    np.testing.assert_array_equal(look.camera.position, panned.position)
    gesture(view, Gesture.RotateNativeGesture, 2.0)
    gesture(view, Gesture.RotateNativeGesture, 10.0)
    np.testing.assert_allclose(look.camera.position, panned.turned(10.0).position, atol=1e-9)


def scroll(view, pixels, angle):
    """Send what two fingers on a trackpad send, at the middle of the view."""
    at, phase = centre(view), Qt.ScrollPhase.ScrollUpdate
    event = QWheelEvent(
        at, view.mapToGlobal(at), QPoint(*pixels), QPoint(*angle), NO_BUTTON, NO_KEY, phase, False
    )
    QApplication.sendEvent(view, event)


def test_wheel_notches_of_a_trackpad_zoom_as_far_as_those_of_a_mouse(view, surface, mouse):
    look = view.camera_controller
    before = look.camera
    mouse(view).wheel(centre(view), 1)
    expected, look.camera = look.camera.position, before
    for _ in range(40):
        scroll(view, (0, 2), (0, 3))
    np.testing.assert_allclose(look.camera.position, expected, rtol=1e-6)
    look.camera = before
    for _ in range(30):
        scroll(view, (0, 2), (0, 0))  # a trackpad that reports pixels alone
    np.testing.assert_allclose(look.camera.position, expected, rtol=1e-6)


def test_wheel_notches_of_a_flick_do_not_jump_and_those_aside_do_nothing(view, surface, mouse):
    look = view.camera_controller
    before = look.camera
    scroll(view, (30, 0), (60, 0))
    np.testing.assert_array_equal(look.camera.position, before.position)
    mouse(view).wheel(centre(view), 1)
    expected, look.camera = look.camera.position, before
    scroll(view, (0, 900), (0, 1800))
    np.testing.assert_allclose(look.camera.position, expected, rtol=1e-6)


def test_wheel_steps_of_a_trackpad_change_the_axis_once_a_notch(view, surface):
    tool, axes = SlabTool(view, surface), []
    tool.enabled = True
    view.tools.append(tool)
    tool.axis_changed.connect(axes.append)
    for _ in range(60):
        scroll(view, (0, 2), (0, 4))
    assert axes == [0, 2]
