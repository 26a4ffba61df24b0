"""The tool Measure in a window, with a real mouse: picking, the list, the drawing, undo and copy."""

import meshes
import numpy as np
import pytest
from driving import Mouse, document, on_screen
from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication

from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.geometry.measuring.surface_point import point_positions
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.tools.tool_modes import Tool


def front(window, height):
    """A vertex in front, near a height in shares of the bottle."""
    U = window.session.store.state.frame.U
    eye = window.canvas.viewport.camera_controller.camera
    near = np.abs(U[:, 1] - height * U[:, 1].max()) < 0.02 * U[:, 1].max()
    return int(np.flatnonzero(near)[np.argmin(eye.depth(U[near]))])


def click(window, vertex):
    mouse = Mouse(window.canvas.viewport)
    at = on_screen(window, vertex)
    mouse.move(at)
    mouse.press(at)
    mouse.release(at)
    return at


def measured(window):
    return document(window).measurements


def readings(window):
    return window.session.measurement_readings.readings(window.session.store.state)


@pytest.fixture
def measuring(qtbot, bottle):
    """The bottle, and the tool in the hand by its key."""
    bottle.shell.activateWindow()
    qtbot.waitUntil(bottle.shell.isActiveWindow)
    qtbot.keyClick(bottle.shell, Qt.Key.Key_Q)
    assert bottle.canvas.tool is Tool.MEASURE
    return bottle


def test_measure_tool_measures_by_clicks_and_undo_takes_back(qtbot, measuring):
    window, section = measuring, measuring.panel.measure
    view = window.canvas.viewport
    assert window.kind_bar.isVisible()
    assert "click two points" in window.status.currentMessage() + window.measurements.hint
    assert not section.empty.isHidden()
    low, high = front(window, 0.3), front(window, 0.6)
    click(window, low)
    assert measured(window) == ()
    qtbot.keyClick(view, Qt.Key.Key_Escape)  # the first point is taken back, and not the tool
    assert window.canvas.tool is Tool.MEASURE
    click(window, low)
    click(window, high)
    (distance,) = measured(window)
    U = window.session.store.state.frame.U
    found = point_positions(distance.points, U, document(window).mesh.F)
    pixel = view.camera_controller.camera.world_per_pixel(U[low])
    assert np.abs(found - U[[low, high]]).max() < 3 * pixel
    assert section.list.rows[0].name.text() == "Distance 1"
    qtbot.waitUntil(lambda: not section.list.rows[0].visibleRegion().isEmpty())  # the panel scrolls there
    window.measurements.choose_kind(MeasurementKind.ANGLE)
    for height in (0.3, 0.6, 0.5):
        click(window, front(window, height))
    window.measurements.choose_kind(MeasurementKind.SECTION)
    axis = window.measurements.tool.axis
    Mouse(view).wheel(on_screen(window, low), -1)
    assert window.measurements.tool.axis == (axis + 1) % 3
    Mouse(view).wheel(on_screen(window, low), 1)
    click(window, low)
    assert measured(window)[2].plane.offset == pytest.approx(U[low, 1], abs=3 * pixel)
    assert [each.kind for each in measured(window)] == [
        MeasurementKind.DISTANCE,
        MeasurementKind.ANGLE,
        MeasurementKind.SECTION,
    ]
    assert not section.list.rows[2].details.isHidden()  # the newest is the chosen one
    qtbot.keyClick(window.shell, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert [row.name.text() for row in section.list.rows] == ["Distance 1", "Angle 1"]
    section.list.rows[0].remove.click()
    assert [each.name for each in measured(window)] == ["Angle 1"]
    section.clear.click()
    assert measured(window) == ()
    assert not section.empty.isHidden()
    assert not section.copy.isVisible()
    window.actions_.display.switches["cut"].trigger()
    window.display_options.cutting_plane.measure.click()
    point, normal = window.display_options.cutting_plane.plane
    assert measured(window)[0].plane.offset == pytest.approx(point @ normal)
    click(window, low)  # one of two points
    before = document(window).mesh
    window.files.show_mesh(Mesh(*meshes.sphere(2)))
    qtbot.waitUntil(lambda: document(window).mesh is not before, timeout=30_000)
    assert not len(window.measurements.tool.points)
    assert section.list.rows == []


def test_measure_controller_has_values_follow_shape_and_unit_and_copies_them(qtbot, measuring):
    window, section = measuring, measuring.panel.measure
    click(window, front(window, 0.3))
    click(window, front(window, 0.7))
    window.measurements.choose_kind(MeasurementKind.SECTION)
    click(window, front(window, 0.6))
    window.choose_unit(Unit.MILLIMETRE)
    row = section.list.rows[0]
    assert row.reading.text().endswith("mm")
    assert "%" not in row.reading.text()
    window.session.gestures.begin()
    pose = np.eye(4)
    pose[:3, 3] = 1.0, 2.0, 0.0
    window.session.handles.drag(pose)
    rest = document(window).mesh.V
    qtbot.waitUntil(lambda: window.session.store.state.frame.U is not rest, timeout=30_000)
    qtbot.waitUntil(lambda: row.reading.text().endswith("%"))
    reading = readings(window)[0]
    now, was = reading.now.values[0], reading.rest.values[0]
    said = row.reading.text().replace("\N{MINUS SIGN}", "-").split("  ")[1]
    assert float(said.removesuffix("%")) == pytest.approx(100 * (now / was - 1), abs=0.006)
    window.session.gestures.cancel()
    check_copy(window, section, row)
    check_drawing(window, section)


def test_measure_tool_fills_up_to_the_click_and_by_a_typed_volume(qtbot, measuring):
    window, section = measuring, measuring.panel.measure
    window.choose_unit(Unit.CENTIMETRE)
    assert not section.contents.isVisible()
    window.measurements.choose_kind(MeasurementKind.FILL_LEVEL)
    before = window.canvas.viewport.tool_layer.grab().toImage()
    vertex = front(window, 0.5)
    click(window, vertex)
    V = document(window).mesh.V
    (filled,) = measured(window)
    pixel = window.canvas.viewport.camera_controller.camera.world_per_pixel(V[vertex])
    level = readings(window)[0].now.values[0]
    assert level == pytest.approx(V[vertex, 1] - V[:, 1].min(), abs=3 * pixel)
    assert window.canvas.viewport.tool_layer.grab().toImage() != before
    qtbot.waitUntil(section.contents.isVisible)
    field = section.contents.lineEdit()
    field.selectAll()
    qtbot.keyClicks(field, "0.45l")
    qtbot.keyClick(field, Qt.Key.Key_Return)
    assert measured(window)[0].contents.volume == pytest.approx(450.0)
    assert readings(window)[0].now.values[0] > level
    assert "Freeboard" in section.list.rows[0].details.text()
    window.session.gestures.undo()
    assert measured(window) == (filled,)


def test_measure_tool_closes_the_opening_that_is_clicked(qtbot, measuring):
    window, view = measuring, measuring.canvas.viewport
    before, mesh = document(window).mesh, Mesh(*meshes.box_with_openings())
    window.files.show_mesh(mesh)
    qtbot.waitUntil(lambda: document(window).mesh is not before, timeout=30_000)
    mesh = document(window).mesh
    window.tools.choose_tool(Tool.MEASURE)
    window.measurements.choose_kind(MeasurementKind.FILL_LEVEL)
    camera = view.camera_controller
    camera.camera = camera.camera.seen_from(np.array([1.0, 0.3, 0.2]))
    visible = int(np.flatnonzero((mesh.V == [4, 2, 6]).all(axis=1))[0])
    hidden = int(np.flatnonzero((mesh.V == [0, 2, 3]).all(axis=1))[0])
    Mouse(view).move(on_screen(window, hidden))
    shown = view.tool_layer.grab().toImage()
    click(window, visible)
    assert document(window).closed_openings
    assert measured(window) == ()
    assert view.tool_layer.grab().toImage() != shown
    click(window, visible)
    assert not document(window).closed_openings
    click(window, hidden)  # what lies before it is meant
    assert not document(window).closed_openings
    assert [each.kind for each in measured(window)] == [MeasurementKind.FILL_LEVEL]
    window.measurements.choose_kind(MeasurementKind.SECTION)
    click(window, visible)
    assert not document(window).closed_openings


def check_copy(window, section, row):
    section.copy.click()
    lines = [line.split("\t") for line in QGuiApplication.clipboard().text().splitlines()]
    assert [line[0] for line in lines] == [
        "Measurement",
        "Distance 1",
        "Section 1, length",
        "Section 1, enclosed area",
        "Section 1, volume below",
    ]
    assert lines[1][1] == row.reading.text()
    assert lines[3][1].endswith("mm²")
    assert lines[4][1].endswith("mm³")


def check_drawing(window, section):
    view = window.canvas.viewport
    window.tools.choose_tool(Tool.ORBIT)  # they stay when another tool is taken
    assert not window.kind_bar.isVisible()

    def drawn():
        return view.tool_layer.grab().toImage()

    shown = drawn()
    section.shown.setChecked(False)
    assert drawn() != shown
    section.shown.setChecked(True)
    assert drawn() == shown
    clicks = len(measured(window))
    click(window, front(window, 0.5))
    assert len(measured(window)) == clicks
