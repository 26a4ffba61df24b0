"""Up axis, projection and axis views: chosen in the menu, kept with file and session."""

import meshes
import numpy as np
import pytest
from driving import document, idle, on_screen, settle, work_off
from PySide6.QtCore import QPointF, Qt

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import HANDLE
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.ui.preferences.preferences import Preferences, UpAxes
from apd_viewer.ui.tools.tool_modes import Tool


def camera(window):
    return window.canvas.viewport.camera_controller.camera


def actions(window):
    return window.actions_.view.camera


@pytest.fixture
def opened(qtbot, kept_window, tmp_path):
    """Opens a tall box, in a file of a format, from disk."""

    def open_as(name):
        path = tmp_path / name
        V, F = meshes.box()
        mesh = Mesh(V * [1.0, 2.0, 3.0], F)
        if not path.exists():
            save_mesh(mesh, mesh.V, path)
        kept_window.files.open_path(path)
        idle(qtbot, kept_window)
        return path

    return open_as


@pytest.mark.parametrize("up_axis", UpAxis)
def test_camera_actions_have_the_chosen_axis_up_in_every_level_view(qtbot, bottle, up_axis):
    actions(bottle).up_axes[up_axis].trigger()
    U = bottle.canvas.surface.U
    above = np.vstack([camera(bottle).focal, camera(bottle).focal + 0.1 * up_axis.direction])
    for axis in ("front", "side", "-front", "-side"):
        actions(bottle).directions[axis].trigger()
        at = camera(bottle).project(above)
        assert at[0, 0] == pytest.approx(at[1, 0], abs=1e-6)
        assert at[1, 1] < at[0, 1]
        assert (camera(bottle).project(U) > 0).all()
    ground = bottle.display_options.ground
    bottle.actions_.display.switches["ground"].setChecked(True)
    settle(qtbot, bottle.canvas.viewport)
    levels = ground.grid_corners[:, up_axis.index]
    assert levels[0] == levels[1] == pytest.approx((U @ up_axis.direction).min() * up_axis.sign)


def test_camera_actions_show_the_whole_mesh_in_axis_views(bottle):
    view = bottle.canvas.viewport
    for axis, action in actions(bottle).directions.items():
        view.camera_controller.camera = view.camera_controller.camera.panned(400, 300).zoomed(
            view.camera_controller.camera.focal, 9.0
        )
        action.trigger()
        x, y = camera(bottle).project(bottle.canvas.surface.U).T
        assert 0 < x.min() < x.max() < view.width(), axis
        assert 0 < y.min() < y.max() < view.height(), axis
        assert max(np.ptp(x) / view.width(), np.ptp(y) / view.height()) > 0.5, axis


@pytest.mark.parametrize("size", [(800, 640), (1024, 700), (1366, 768)])
def test_camera_actions_put_the_mesh_into_the_middle_beside_the_bar_of_a_tool(qtbot, bottle, size):
    bottle.shell.resize(*size)
    work_off()
    view = bottle.canvas.viewport
    for tool in (Tool.MOVE, Tool.HANDLE, Tool.MEASURE):
        bottle.tools.choose_tool(tool)
        bars = [bar.geometry().right() + 1 for bar in (bottle.mode_bar, bottle.kind_bar) if bar.isVisible()]
        left = max(bars, default=0)
        assert (left > 0) == (tool is not Tool.MOVE)
        for axis in ("front", "side", "top"):
            actions(bottle).directions[axis].trigger()
            at = camera(bottle).project(bottle.canvas.surface.U)
            ends, free = np.array([at.min(axis=0), at.max(axis=0)]), [view.width() - left, view.height()]
            middle = [left + free[0] / 2, free[1] / 2]
            assert (np.abs(ends.mean(axis=0) - middle) < 0.02 * np.array(free)).all()
            assert left <= ends[0, 0] < ends[1, 0] <= view.width()


def test_mode_bar_moves_no_view_that_was_moved_by_hand(qtbot, bottle):
    view = bottle.canvas.viewport
    view.camera_controller.camera = view.camera_controller.camera.panned(40, 30)
    before = camera(bottle).key
    bottle.tools.choose_tool(Tool.HANDLE)
    assert camera(bottle).key == before


def test_viewport_draws_the_mesh_where_it_is_picked_beside_a_bar(qtbot, bottle):
    bottle.tools.choose_tool(Tool.HANDLE)
    actions(bottle).directions["front"].trigger()
    view = bottle.canvas.viewport
    settle(qtbot, view)
    assert camera(bottle).left > 0
    drawn = np.asarray(view.screenshot(return_img=True)).astype(int)
    orange = (drawn[:, :, 0] > drawn[:, :, 2] + 60) & (drawn[:, :, 0] > drawn[:, :, 1] + 30)
    columns = np.flatnonzero(orange.any(axis=0))
    cap = bottle.canvas.surface.U[document(bottle).labels == HANDLE]
    x = camera(bottle).project(cap)[:, 0]
    assert [columns[0], columns[-1]] == pytest.approx([x.min(), x.max()], abs=4)


def test_up_axes_remember_an_axis_with_its_file(kept_window, opened, settings):
    path = opened("tall.stl")
    assert camera(kept_window).up_axis is UpAxis.PLUS_Y
    actions(kept_window).up_axes[UpAxis.PLUS_Z].trigger()
    assert Preferences(settings).up_axes == {path.resolve(): UpAxis.PLUS_Z}
    opened("other.stl")
    assert camera(kept_window).up_axis is UpAxis.PLUS_Y
    assert actions(kept_window).up_axes[UpAxis.PLUS_Y].isChecked()
    opened("tall.stl")
    assert camera(kept_window).up_axis is UpAxis.PLUS_Z
    assert actions(kept_window).up_axes[UpAxis.PLUS_Z].isChecked()


@pytest.mark.parametrize(
    ("name", "up_axis"),
    [("a.GLB", "+Y"), ("a.gltf", "+Y"), ("a.3mf", "+Z"), ("a.stl", "+Y"), ("a.obj", "+Y")],
)
def test_up_axes_assume_the_axis_of_a_format(settings, tmp_path, name, up_axis):
    V, F = meshes.box()
    axes = UpAxes(Preferences(settings))
    mesh = Mesh(V, F, tmp_path / name)
    assert axes.up_axis_of(mesh) is UpAxis(up_axis)
    axes.set_up_axis(mesh, UpAxis.MINUS_X)
    assert UpAxes(Preferences(settings)).up_axis_of(Mesh(V, F, tmp_path / name)) is UpAxis.MINUS_X


def test_camera_actions_let_the_mesh_stand_as_it_was_turned(bottle):
    actions(bottle).directions["top"].trigger()
    actions(bottle).stand_upright.trigger()
    assert camera(bottle).up_axis is UpAxis.MINUS_Z
    assert actions(bottle).up_axes[UpAxis.MINUS_Z].isChecked()
    assert camera(bottle).axes[1] @ [0, 0, -1] > 0.9


def test_mesh_view_keeps_axis_and_projection_in_a_session(qtbot, bottle, tmp_path):
    actions(bottle).up_axes[UpAxis.PLUS_X].trigger()
    actions(bottle).orthographic.trigger()
    kept = camera(bottle)
    bottle.session.files.save(tmp_path / "a.apd", bottle.view(), True)
    idle(qtbot, bottle)
    actions(bottle).orthographic.trigger()
    actions(bottle).up_axes[UpAxis.PLUS_Y].trigger()
    bottle.files.open_path(tmp_path / "a.apd")
    idle(qtbot, bottle)
    assert camera(bottle).key == pytest.approx(kept.key)
    assert camera(bottle).up_axis is UpAxis.PLUS_X
    assert actions(bottle).orthographic.isChecked()


def test_camera_actions_take_the_perspective_away_by_a_key(qtbot, bottle, mouse):
    view = bottle.canvas.viewport
    bottle.shell.activateWindow()
    qtbot.waitUntil(bottle.shell.isActiveWindow)
    actions(bottle).directions["front"].trigger()
    before = camera(bottle)
    qtbot.keyClick(view, Qt.Key.Key_5)
    assert camera(bottle).is_orthographic
    assert actions(bottle).orthographic.isChecked()
    settle(qtbot, view)
    # What is picked is what is drawn, at whatever depth.
    U = bottle.canvas.surface.U
    for vertex in (int(U[:, 2].argmax()), int((U[:, 1] + U[:, 2]).argmax())):
        hit = bottle.canvas.surface.hit(QPointF(*on_screen(bottle, vertex)))
        assert hit is not None
        assert np.abs(hit.point - U[vertex])[:2].max() < camera(bottle).world_per_pixel(U[vertex])
    near, far = U[U[:, 2].argmax()] * [1, 1, 1], U[U[:, 2].argmax()] * [1, 1, -1]
    assert np.abs(np.subtract(*camera(bottle).project(np.array([near, far])))).max() < 0.1
    qtbot.keyClick(view, Qt.Key.Key_5)
    assert camera(bottle).angle == before.angle
    np.testing.assert_allclose(camera(bottle).position, before.position, rtol=1e-9)


def test_camera_actions_let_the_mesh_be_drawn_and_painted_without_perspective(qtbot, bottle, mouse):
    view = bottle.canvas.viewport
    actions(bottle).directions["front"].trigger()
    settle(qtbot, view)
    perspective = np.asarray(view.screenshot(return_img=True)).astype(int)
    actions(bottle).orthographic.trigger()
    settle(qtbot, view)
    parallel = np.asarray(view.screenshot(return_img=True)).astype(int)
    shape = [np.abs(image - image[0, 0]).sum(axis=2) > 60 for image in (perspective, parallel)]
    assert 0.8 < shape[1].sum() / shape[0].sum() < 1.25
    assert (shape[0] != shape[1]).any()
    labels = document(bottle).labels
    bottle.tools.choose_tool(bottle.canvas.tool.BASE)
    middle = QPointF(view.width() / 2, view.height() / 2)
    mouse(view).drag(middle, middle + QPointF(10, 0))
    assert (document(bottle).labels != labels).any()


def test_camera_controller_leaves_less_room_for_the_gizmo_in_a_small_view(qtbot, view):
    points, look = np.array([[-1.0, -1.0, 0.0], [1.0, 1.0, 0.0]]), view.camera_controller
    look.frame(points, overlays=100.0)
    for height, room in ((480, 100.0), (225, 50.0)):  # framed anew when the view is resized
        view.window().resize(640, height)
        qtbot.waitUntil(lambda height=height: view.height() == height)
        expected = look.camera.framed(points, room)
        np.testing.assert_allclose(look.camera.position, expected.position)


def test_camera_actions_write_axes_with_a_true_minus(bottle):
    titles = [action.text() for action in bottle.actions_.view.camera.up_axes.values()]
    assert "−Z" in titles
    assert not any("-" in title for title in titles)
