import gc
import sys
import weakref

import numpy as np
import pytest
from driving import grey, show, work_off
from meshes import box
from PySide6.QtCore import QObject, QPointF, Qt, Signal
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMainWindow

from apd_viewer.geometry.picking.surface_index import SurfaceIndex
from apd_viewer.ui.scene.camera import MARGIN
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.surface_shading import IDLE_DELAY, Shading
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.brush_tool import BrushTool
from apd_viewer.ui.tools.gizmo import Gizmo


def paint(view):
    """Let one paint happen, and return how often VTK drew."""
    view.antialiasing.idle_timer.stop()
    before = view.draw_count
    QApplication.processEvents()
    view.antialiasing.idle_timer.stop()
    return view.draw_count - before


def test_emit_does_not_steal_references():
    # PySide6 6.12.0 drops one reference to True at each emit, and the process dies of it.
    class Bell(QObject):
        rung = Signal(object)

    bell, before = Bell(), sys.getrefcount(True)
    for _ in range(100):
        bell.rung.emit(1)
    assert abs(sys.getrefcount(True) - before) < 50


def test_viewport_draws_once_a_paint(view, surface):
    ends = []
    tag = view.ren_win.AddObserver("EndEvent", lambda *_: ends.append(1))
    paint(view)
    ends.clear()
    for _ in range(3):
        view.update()
        view.render()
    assert paint(view) == 1
    assert len(ends) == 1
    view.ren_win.RemoveObserver(tag)


def test_navigation_draws_once_a_paint_in_a_camera_drag(view, surface, mouse):
    m = mouse(view)
    paint(view)
    m.press((5, 5))
    for x in (20, 40, 60):
        m.move((x, 5))
        m.move((x + 5, 5))
        assert paint(view) == 1
    m.release((60, 5))


def test_tool_layer_costs_no_draw_when_it_changes_alone(view, surface):
    paint(view)
    view.tool_layer.update()
    assert paint(view) == 0


def test_viewport_runs_pre_draw_before_each_draw(view, surface):
    calls = []
    view.pre_draw.append(lambda: calls.append(view.draw_count))
    before = view.draw_count
    view.update()
    paint(view)
    assert calls == [before]


def test_project_agrees_with_the_projection_of_vtk(view, surface):
    view.camera_controller.camera = view.camera_controller.camera.orbited(37, 21).panned(11, -8)
    view.renderer.ResetCameraClippingRange()
    camera = view.renderer.GetActiveCamera()
    matrix = camera.GetCompositeProjectionTransformMatrix(view.width() / view.height(), -1, 1)
    M = np.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])
    clip = np.column_stack([surface.U, np.ones(len(surface.U))]) @ M.T
    x, y = (clip[:, :2] / clip[:, 3:]).T
    expected = np.column_stack([(x + 1) / 2 * view.width(), (1 - y) / 2 * view.height()])
    np.testing.assert_allclose(view.camera_controller.camera.project(surface.U), expected, atol=1e-6)


def test_hit_picks_what_is_seen(view, surface):
    """Colour one face, and find it on the screen where the ray finds it."""
    rgba = grey(len(surface.U))
    at = QPointF(260, 200)
    rgba[surface.surface_index.F[surface.hit(at).face], :3] = 255, 0, 0
    surface.set_colors(rgba)
    picture = view.screenshot()
    ratio = view.devicePixelRatioF()
    r, g, b = picture[int(at.y() * ratio), int(at.x() * ratio)][:3].astype(int)
    assert r > 2 * g
    assert r > 2 * b


def test_screenshot_shows_the_scene_as_it_is_now(view, surface):
    before = view.screenshot().copy()
    surface.set_points(0.5 * surface.U)
    after = view.screenshot()
    assert before.std() > 5
    assert (before != after).any()


def test_surface_edges_and_shading_can_be_seen(view, surface):
    smooth = view.screenshot().copy()
    surface.shading = Shading.FLAT
    flat = view.screenshot().copy()
    surface.shows_edges = True
    edged = view.screenshot().copy()
    assert surface.shading is Shading.FLAT
    assert surface.shows_edges
    assert (smooth != flat).any()
    assert (flat != edged).any()


def test_surface_keeps_painted_colors_true_where_it_faces_the_viewer(view, surface):
    for colour in ((0, 114, 178), (213, 94, 0), (0, 158, 115), (240, 228, 66)):
        rgba = grey(len(surface.U))
        rgba[:, :3] = colour
        surface.set_colors(rgba)
        picture = view.screenshot()
        seen = picture[picture.shape[0] // 2, picture.shape[1] // 2][:3].astype(int)
        assert np.abs(seen - colour).max() <= 24


def test_surface_normals_follow_the_points(view, surface):
    surface.set_points(surface.U * [1, 1, -1] + [0, 0, 3])
    mesh = surface.arrays.data
    np.testing.assert_allclose(mesh.points, surface.U, atol=1e-6)
    inward = np.einsum("ij,ij->i", mesh.point_data["Normals"], surface.U - [0, 0, 3])
    assert (inward < -0.99).all()  # mirrored: the faces turn inside out, and the normals with them


def test_set_points_keeps_positions_as_they_are_given_and_written_by_nobody(view, surface):
    U = 2.0 * surface.U
    surface.set_points(U)
    assert np.shares_memory(surface.U, U)
    assert not surface.U.flags.writeable
    surface.set_points(U.astype(np.float32))
    assert surface.U.dtype == np.float64


def test_shading_is_smooth_across_seams(view, surface):
    F, U = surface.surface_index.F.copy(), surface.U.copy()
    expected = np.array(surface.arrays.normals)[F.ravel()]
    loose = np.arange(F.size).reshape(F.shape)  # as an STL file has it
    first = np.unique(F, return_index=True)[1][F]
    surface.set_mesh(SurfaceIndex.from_triangles(loose, F.size, first), U[F.ravel()], grey(F.size))
    np.testing.assert_allclose(surface.arrays.normals, expected, atol=1e-6)


def test_surface_shades_and_colors_sharp_edges_like_the_sides_that_meet_there(view, surface):
    V, F = box(2, 2, 2)
    surface.set_mesh(SurfaceIndex.from_triangles(F, len(V), V=V), V, grey(len(V)))
    view.camera_controller.look_from_home()
    view.camera_controller.frame(V)
    sharp = view.screenshot().copy()
    data = surface.arrays.data
    assert len(data.points) > len(V) == len(surface.arrays.normals) == len(surface.shades)
    surface.set_colors(np.tile(np.array([250, 0, 0, 255], dtype=np.uint8), (3, 1)), np.arange(3))
    surface.shades[3] = 7
    surface.update_shades()
    (actor,) = (actor for actor in view.renderer.GetActors() if actor.GetMapper().GetInput() is data)
    where = np.linalg.norm(data.points[:, None] + actor.GetPosition() - V, axis=2).argmin(axis=1)
    rgba = np.asarray(data.point_data["rgba"])
    np.testing.assert_array_equal(rgba[:, 0] == 250, where < 3)
    np.testing.assert_array_equal(rgba[:, 3] == 7, where == 3)
    colored = rgba[: len(V)].copy()
    surface.shading = Shading.SMOOTH
    np.testing.assert_array_equal(surface.arrays.rgba, colored)
    assert len(surface.arrays.data.points) == len(V)
    assert (view.screenshot() != sharp).any()
    for shading, bent in ((Shading.SMOOTH, True), (Shading.SHARP, False)):
        surface.shading = shading
        hit = surface.hit(QPointF(*view.camera_controller.camera.project(V[F].mean(axis=1)[[0]])[0]))
        assert (np.abs(hit.normal).max() < 1.0 - 1e-6) == bent


def test_set_mesh_replaces_the_first_mesh_by_another(view, surface):
    F, U = np.array([[0, 1, 2]]), np.eye(3)
    surface.set_mesh(SurfaceIndex.from_triangles(F, 3), U, grey(3))
    assert len(surface.U) == 3
    assert view.renderer.GetActors().GetNumberOfItems() == 1
    view.screenshot()


def test_camera_controller_frames_the_points_in_an_axis_view(view, surface):
    view.camera_controller.show_standard_view("top")
    view.camera_controller.frame(surface.U)
    np.testing.assert_allclose(view.camera_controller.camera.axes[2], [0, -1, 0], atol=1e-12)
    xy = view.camera_controller.camera.project(surface.U)
    assert (xy > 0).all()
    assert (xy < [view.width(), view.height()]).all()


def test_camera_controller_keeps_in_a_resized_view_what_was_in_frame_until_the_camera_moves(
    qtbot, view, surface
):
    def reach():
        half = np.array([view.width(), view.height()]) / 2
        return np.abs(view.camera_controller.camera.project(surface.U) / half - 1).max()

    view.camera_controller.frame(surface.U)
    view.window().resize(300, 480)
    qtbot.waitUntil(lambda: view.width() == 300)
    assert reach() == pytest.approx(1 / MARGIN, rel=0.02)
    view.camera_controller.camera = view.camera_controller.camera.orbited(20, 0)
    kept = view.camera_controller.camera.position
    view.window().resize(640, 480)
    qtbot.waitUntil(lambda: view.width() == 640)
    np.testing.assert_array_equal(view.camera_controller.camera.position, kept)


@pytest.mark.parametrize(
    ("button", "modifiers", "kind"),
    [
        (Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, "orbit"),
        (Qt.MouseButton.RightButton, Qt.KeyboardModifier.NoModifier, "orbit"),
        (Qt.MouseButton.MiddleButton, Qt.KeyboardModifier.NoModifier, "pan"),
        (Qt.MouseButton.LeftButton, Qt.KeyboardModifier.ShiftModifier, "pan"),
        (Qt.MouseButton.RightButton, Qt.KeyboardModifier.ControlModifier, "zoom"),
    ],
)
def test_navigation_orbits_pans_or_zooms_by_button_and_modifier(
    view, surface, mouse, button, modifiers, kind
):
    before = view.camera_controller.camera
    mouse(view).drag((300, 200), (330, 240), button=button, modifiers=modifiers)
    after = view.camera_controller.camera
    assert (kind == "orbit") == (np.abs(after.axes - before.axes).max() > 1e-6)
    assert (kind == "orbit") == np.allclose(after.focal, before.focal)
    assert (kind == "zoom") == (abs(after.distance - before.distance) > 1e-6)


def test_navigation_wheel_zooms_to_the_surface_under_the_cursor(view, surface, mouse):
    at = QPointF(250, 180)
    point, distance = surface.point_under(at), view.camera_controller.camera.distance
    for _ in range(60):
        mouse(view).wheel(at, 1)
        np.testing.assert_allclose(
            view.camera_controller.camera.project(point[None]), [[250, 180]], atol=1e-6
        )
        assert view.camera_controller.camera.depth(point) > 0  # never through the surface
    assert view.camera_controller.camera.distance < 0.1 * distance
    for _ in range(200):
        mouse(view).wheel(at, -1)
    assert view.camera_controller.camera.distance < 100 * distance


def test_navigation_wheel_zooms_beside_the_surface_too(view, surface, mouse):
    before = view.camera_controller.camera.distance
    mouse(view).wheel((3, 3), 1)
    assert view.camera_controller.camera.distance < before


class Recorder:
    def __init__(self, takes=()):
        self.takes, self.calls = takes, []

    def __getattr__(self, name):
        if name in ("finish", "paint"):
            return lambda *_: False
        if name not in ("press", "move", "release", "wheel", "leave", "cancel"):
            raise AttributeError(name)

        def call(*_):
            self.calls.append(name)
            return name in self.takes

        return call


def test_mouse_dispatcher_asks_tools_in_order_and_the_taker_keeps_the_mouse(view, surface, mouse):
    first, second, third = Recorder(), Recorder(("press",)), Recorder()
    view.tools[:] = [first, second, third]
    before = view.camera_controller.camera.key
    m = mouse(view)
    m.press((5, 5))
    m.move((90, 90))
    m.press((90, 90), Qt.MouseButton.RightButton)
    m.release((90, 90), Qt.MouseButton.RightButton)
    m.release((90, 90))
    assert first.calls == ["press", "move"]  # the last one hovers
    assert second.calls == ["press", "move", "release", "move"]
    assert third.calls == ["move"]
    assert view.camera_controller.camera.key == before


def test_mouse_dispatcher_leaves_the_tools_behind_one_that_takes_a_hover(view, mouse):
    front, back = Recorder(("move",)), Recorder()
    view.tools[:] = [front, back]
    mouse(view).move((50, 50))
    assert front.calls == ["move"]
    assert back.calls == ["leave"]


def test_mouse_dispatcher_ends_the_drag_after_a_lost_release(view, mouse):
    tool = Recorder(("press",))
    view.tools[:] = [tool]
    m = mouse(view)
    m.press((5, 5))
    m.buttons = Qt.MouseButton.NoButton  # a menu, or another window, got the release
    m.move((9, 9))
    assert tool.calls == ["press", "release"]


def test_mouse_dispatcher_cancels_on_escape_and_gives_the_rest_of_the_drag_to_nobody(view, surface, mouse):
    tool = Recorder(("press", "cancel"))
    view.tools[:] = [tool]
    before = view.camera_controller.camera.key
    m = mouse(view)
    m.press((5, 5))
    QTest.keyClick(view, Qt.Key.Key_Escape)
    m.move((50, 50))
    assert tool.calls == ["press", "cancel"]
    assert view.camera_controller.camera.key == before


def test_viewport_gives_vtk_no_keys(view, surface):
    before, draws = view.camera_controller.camera.key, paint(view) or view.draw_count
    for key in "wsqrpfi3ejtv":
        QTest.keyClick(view, key)
    paint(view)
    assert view.camera_controller.camera.key == before
    assert view.draw_count == draws
    assert view.isVisible()


def test_set_theme_sets_the_background(view):
    view.set_theme("#202428", "#101214")
    assert view.is_dark
    assert view.screenshot()[2, 2].max() < 60
    view.set_theme("#ffffff")
    assert not view.is_dark
    assert view.screenshot()[2, 2].min() == 255


def test_antialiasing_draws_a_resting_view_once_more_with_smooth_edges(qtbot, view, surface):
    if not view.antialiasing.is_software:
        pytest.skip("only a software renderer draws once more at rest; a GPU smooths every frame")
    view.antialiasing.idle_timer.setInterval(IDLE_DELAY)
    before = view.draw_count
    view.update()
    qtbot.waitUntil(lambda: view.draw_count == before + 2)
    work_off()
    assert not view.antialiasing.idle_timer.isActive()
    assert view.draw_count == before + 2


def test_viewport_close_leaves_nothing_alive(qtbot, ball):
    F, U = ball
    remains = []
    for _ in range(5):
        window = QMainWindow()
        view = Viewport(window)
        window.setCentralWidget(view)
        surface = Surface(view)
        surface.set_mesh(SurfaceIndex.from_triangles(F, len(U)), U, grey(len(U)))
        gizmo, painter = Gizmo(view), BrushTool(view, surface)
        view.tools[:] = [gizmo, painter]
        gizmo.visible = painter.enabled = True
        show(qtbot, window, view)
        remains += [weakref.ref(o) for o in (window, view, surface, surface.arrays.data, gizmo, painter)]
        view.close()
        window.close()
        window.deleteLater()
        del window, view, surface, gizmo, painter
        work_off()
    gc.collect()
    assert [r() for r in remains if r() is not None] == []


def test_viewport_takes_late_calls_after_closing(qtbot, ball):
    F, U = ball
    window = QMainWindow()
    view = Viewport(window)
    window.setCentralWidget(view)
    surface = Surface(view)
    surface.set_mesh(SurfaceIndex.from_triangles(F, len(U)), U, grey(len(U)))
    show(qtbot, window, view)
    view.camera_controller.frame(U)
    view.close()
    view.close()
    view.update()
    view.render()
    surface.set_points(0.5 * U)  # a frame that was on its way
    surface.set_colors(grey(len(U)))
    window.resize(400, 300)
    work_off()
    window.close()
    window.deleteLater()
    work_off()


def test_ray_of_the_middle_of_the_view_runs_through_the_focal_point(view, surface):
    origin, direction = view.camera_controller.camera.ray(view.width() / 2, view.height() / 2)
    np.testing.assert_allclose(
        np.cross(view.camera_controller.camera.focal - origin, direction), 0, atol=1e-9
    )
