"""What is unusual about a mesh is counted, listed, and shown where it is."""

import meshes
import numpy as np
import pytest
from driving import Mouse, document, idle, settle, work_off
from mesh_contents import binary_stl
from PySide6.QtCore import QPointF, Qt
from seams import halves

from apd_viewer.geometry.analysis.shape_check import SEAMS
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.presentation.palette import MARK_COLOR, label_colors
from apd_viewer.ui.tools.tool_modes import Tool

LEFT = Qt.MouseButton.LeftButton
MARK = np.array([*MARK_COLOR, 255])


def damaged():
    """A sphere with a hole at its back, a face that is there twice at its front, and a stray vertex."""
    V, F = meshes.sphere(3)
    middles = V[F].mean(axis=1)
    F = F[middles[:, 2] > -0.95]
    front = np.argmax(V[F].mean(axis=1)[:, 2])
    return Mesh(np.vstack([V, [[1.5, 0.0, 0.0]]]), np.vstack([F, F[front]]))


@pytest.fixture
def ill(qtbot, kept_window):
    """A window on the damaged sphere."""
    kept_window.files.show_mesh(damaged())
    idle(qtbot, kept_window)
    work_off()
    return kept_window


def findings(window):
    return window.session.store.state.inspection.findings


def number(window, kind):
    return [finding.kind for finding in findings(window)].index(kind)


def open_list(qtbot, window):
    qtbot.mouseClick(window.findings.badge, LEFT)
    assert window.findings.list.isVisible()


def choose(qtbot, window, kind):
    """Click the row of a finding; its vertices."""
    k = number(window, kind)
    qtbot.mouseClick(window.findings.list.rows[k], LEFT)
    return findings(window)[k].vertices


def marked(window):
    """The vertices that have the colour of the marks."""
    rgba = np.asarray(window.canvas.surface.arrays.rgba)
    return np.flatnonzero((rgba == MARK).all(axis=1))


def plain(window):
    """Whether the surface has the colours of its paint, and nothing is marked."""
    rgba = np.asarray(window.canvas.surface.arrays.rgba)
    painted = label_colors(document(window).labels, document(window).member)
    return window.canvas.marks.ids is None and np.array_equal(rgba, painted)


def towards(window, points):
    """Cosine between where the camera stands and where points lie, seen from the middle of the mesh."""
    middle = points.mean(axis=0)
    return -window.canvas.viewport.camera_controller.camera.axes[2] @ middle / np.linalg.norm(middle)


def test_badge_is_quiet_where_there_is_nothing_to_say(qtbot, window):
    badge = window.findings.badge
    assert not badge.isVisible(), "no mesh is open"
    window.files.open_sample("bottle")
    idle(qtbot, window)
    assert badge.isVisible()
    assert not badge.isEnabled()
    assert badge.text() == badge.accessibleName() == "No issues"
    qtbot.mouseClick(badge, LEFT)
    assert not window.notice.isVisible()
    window.actions_.view.findings.trigger()
    assert not window.findings.list.isVisible()
    assert window.notice.text.startswith("No issues. Checked: file, size")


def test_badge_counts_what_the_list_says(qtbot, ill):
    count = len(findings(ill))
    assert count >= 3
    assert ill.findings.badge.text() == f"{count} issues"
    assert ill.notice.text.startswith("The mesh check has found issues;")
    assert ill.notice.text.count(".") == 1, "one sentence"
    open_list(qtbot, ill)
    said = [row.accessibleName() for row in ill.findings.list.rows]
    assert said == [finding.sentence for finding in findings(ill)]
    assert plain(ill), "nothing is marked before it is asked for"
    qtbot.mouseClick(ill.findings.badge, LEFT)
    assert not ill.findings.list.isVisible()


def test_findings_controller_tells_a_single_finding_as_it_is(qtbot, kept_window):
    V, F = meshes.sphere(2)
    kept_window.files.show_mesh(Mesh(V, F[3:]))
    idle(qtbot, kept_window)
    assert kept_window.notice.text == findings(kept_window)[0].sentence
    assert kept_window.findings.badge.text() == "1 issue"


def test_findings_controller_tells_what_is_strange_about_the_file_first(qtbot, kept_window, tmp_path):
    path = tmp_path / "a.stl"
    path.write_bytes(binary_stl(*meshes.box(1, 1, 1)) + b"more")
    kept_window.files.open_path(path)
    idle(qtbot, kept_window)
    said = "4 bytes after the last face that the file declares were not read."
    assert kept_window.notice.text.startswith(f"{said} The mesh check has found issues;")
    assert kept_window.findings.badge.text() == "2 issues"
    open_list(qtbot, kept_window)
    assert kept_window.findings.list.rows[0].accessibleName() == said


def test_open_path_tells_a_file_without_a_mesh_for_what_it_is(qtbot, kept_window, tmp_path):
    path = tmp_path / "a.obj"
    path.write_text("<!DOCTYPE html><html><body>Not found</body></html>")
    kept_window.files.open_path(path)
    qtbot.waitUntil(lambda: kept_window.notice.isVisible())
    assert kept_window.notice.text == "a.obj holds a web page and no mesh; download the mesh itself."


def test_findings_controller_marks_a_finding_and_brings_the_camera_round_to_it(qtbot, ill):
    V = document(ill).mesh.V
    ill.canvas.viewport.camera_controller.show_standard_view("front")
    open_list(qtbot, ill)
    before = ill.canvas.viewport.camera_controller.camera.key
    front = choose(qtbot, ill, "doubled faces")
    assert np.array_equal(marked(ill), front)
    assert ill.canvas.viewport.camera_controller.camera.key == before, "what is in view needs no other camera"
    back = choose(qtbot, ill, "open borders")
    assert np.array_equal(marked(ill), back), "and the other one is marked no more"
    assert towards(ill, V[back]) > 0.5
    k = number(ill, "open borders")
    assert [row.property("marked") for row in ill.findings.list.rows].index(True) == k


def test_findings_controller_brings_into_the_picture_what_is_far_out_of_it(qtbot, ill):
    view = ill.canvas.viewport
    view.camera_controller.show_standard_view("front")
    view.camera_controller.zoom_at(QPointF(5, view.height() / 2), 8.0)
    open_list(qtbot, ill)
    stray = choose(qtbot, ill, "unreferenced vertices")
    (x, y), area = (
        view.camera_controller.camera.project(document(ill).mesh.V[stray])[0],
        ill.findings.list.geometry(),
    )
    assert view.rect().contains(int(x), int(y))
    assert not area.contains(int(x), int(y))
    settle(qtbot, view)
    picture = view.grab().toImage()
    ratio = picture.width() / view.width()
    dot = picture.pixelColor(int(x * ratio), int(y * ratio)).getRgb()
    assert np.allclose(dot, MARK, atol=8), "a vertex without a face is seen too"


@pytest.mark.parametrize("way", ["esc", "esc on the canvas", "click", "cross", "stroke", "mesh", "field"])
def test_vertex_marks_go_with_the_list(qtbot, ill, way):
    view, mouse = ill.canvas.viewport, Mouse(ill.canvas.viewport)
    open_list(qtbot, ill)
    choose(qtbot, ill, "open borders")
    assert not plain(ill)
    if way == "esc":
        qtbot.keyClick(ill.findings.list.rows[0], Qt.Key.Key_Escape)
        assert ill.canvas.tool is Tool.BASE, "the tool stays in the hand"
    elif way == "esc on the canvas":
        view.setFocus()
        assert ill.findings.list.isVisible()
        qtbot.keyClick(view, Qt.Key.Key_Escape)
        assert ill.canvas.tool is Tool.BASE
    elif way == "click":
        mouse.drag((5, 5), (5, 5))
    elif way == "cross":
        ill.findings.list.close_button.click()
    elif way == "stroke":
        ill.tools.choose_tool(Tool.BASE)
        view.camera_controller.show_standard_view("side")
        view.camera_controller.frame(document(ill).mesh.V)
        mouse.drag(
            view.camera_controller.camera.project(np.zeros((1, 3)))[0],
            view.camera_controller.camera.project(np.array([[0.0, 0.2, 0.0]]))[0],
        )
        assert (document(ill).labels == BASE).any()
    elif way == "mesh":
        ill.files.open_sample("duck")
        idle(qtbot, ill)
        assert ill.findings.badge.text() == "No issues"
    else:
        ill.shell.activateWindow()
        qtbot.waitUntil(ill.shell.isActiveWindow)
        ill.panel.area.target.field.setFocus()
    assert not ill.findings.list.isVisible()
    assert not ill.findings.badge.isChecked()
    assert plain(ill)


def test_finding_list_leaves_the_camera_free_while_it_is_open(qtbot, ill):
    view, mouse = ill.canvas.viewport, Mouse(ill.canvas.viewport)
    open_list(qtbot, ill)
    shown = choose(qtbot, ill, "open borders")
    before = view.camera_controller.camera.key
    mouse.drag((5, 5), (60, 20), (90, 40))
    mouse.wheel((30, 30), 2)
    assert view.camera_controller.camera.key != before
    assert ill.findings.list.isVisible()
    assert np.array_equal(marked(ill), shown)


def test_finding_list_is_used_by_keys_alone(qtbot, ill):
    badge, rows = ill.findings.badge, ill.findings.list
    badge.setFocus()
    qtbot.keyClick(badge, Qt.Key.Key_Space)
    assert rows.isVisible()
    qtbot.keyClick(rows.rows[0], Qt.Key.Key_Return)
    assert set(findings(ill)[0].vertices) == set(marked(ill))
    qtbot.keyClick(rows.rows[0], Qt.Key.Key_Down)
    assert set(findings(ill)[1].vertices) == set(marked(ill))
    qtbot.keyClick(rows.rows[1], Qt.Key.Key_Escape)
    assert not rows.isVisible()
    qtbot.keyClick(badge, Qt.Key.Key_Return)
    assert rows.isVisible()
    ill.actions_.view.findings.trigger()
    assert not rows.isVisible()


def test_vertex_marks_move_with_the_mesh_and_outlast_a_change_of_paint(qtbot, ill):
    session, V = ill.session, document(ill).mesh.V
    session.gestures.begin()
    session.painting.paint(np.flatnonzero(V[:, 1] < -0.8), BASE)
    session.painting.paint(np.flatnonzero(V[:, 1] > 0.8), HANDLE)
    session.painting.end_stroke("Paint")
    open_list(qtbot, ill)
    shown = choose(qtbot, ill, "open borders")
    session.gestures.begin()
    pose = np.eye(4)
    pose[1, 3] = 0.4
    session.handles.drag(pose)
    session.gestures.end("Move handle")
    idle(qtbot, ill)
    assert not np.allclose(ill.canvas.surface.U[shown], V[shown])
    assert np.array_equal(marked(ill), shown)
    choose(qtbot, ill, "unreferenced vertices")
    choose(qtbot, ill, "open borders")
    assert np.array_equal(marked(ill), shown)
    session.gestures.undo()
    session.gestures.undo()
    assert (document(ill).labels == FREE).all()
    assert np.array_equal(marked(ill), shown)
    ill.findings.close()
    assert plain(ill)


def test_vertex_marks_show_both_sides_of_a_seam_and_all_of_a_mesh_meant_as_a_whole(qtbot, kept_window):
    V, F = meshes.soup(*meshes.sphere(2))
    kept_window.files.show_mesh(Mesh(V * 1e-5, F[2:]))
    idle(qtbot, kept_window)
    open_list(qtbot, kept_window)
    border = choose(qtbot, kept_window, "open borders")
    weld = document(kept_window).mesh.weld
    assert set(marked(kept_window)) == set(np.flatnonzero(np.isin(weld.inverse, weld.inverse[border])))
    assert len(marked(kept_window)) > len(border)
    assert not len(choose(qtbot, kept_window, "tiny"))
    assert len(marked(kept_window)) == len(V)


@pytest.mark.parametrize("size", [(800, 640), (1280, 800)])
def test_finding_list_leaves_room_for_what_it_shows(qtbot, ill, size):
    ill.shell.resize(*size)
    work_off()
    open_list(qtbot, ill)
    choose(qtbot, ill, "open borders")
    view, area = ill.canvas.viewport, ill.findings.list.geometry()
    assert view.rect().contains(area)
    assert area.height() <= 0.6 * view.height()
    badge, bar = ill.findings.badge, ill.status
    assert bar.rect().contains(badge.geometry())
    places = view.camera_controller.camera.project(document(ill).mesh.V[marked(ill)])
    free = [not area.contains(int(x), int(y)) and view.rect().contains(int(x), int(y)) for x, y in places]
    assert np.mean(free) >= 0.8


# Loose parts


@pytest.fixture
def buttoned(qtbot, kept_window):
    """A painted sphere with two loose balls beside it, a larger and a smaller one, its handle in hand."""
    (V, F), (W, G), (X, H) = meshes.sphere(3), meshes.sphere(1), meshes.sphere(0)
    V = np.vstack([V, 0.1 * W + [1.2, 0.0, 0.0], 0.1 * X + [0.0, 0.0, 1.2]])
    F = np.vstack([F, G + F.max() + 1, H + F.max() + 1 + len(W)])
    labels = np.full(len(V), FREE)
    labels[V[:, 1] < -0.8], labels[V[:, 1] > 0.8] = BASE, HANDLE
    kept_window.files.show_mesh(Mesh(V, F))
    idle(qtbot, kept_window)
    session = kept_window.session
    session.gestures.begin()
    for label in (BASE, HANDLE):
        session.painting.paint(np.flatnonzero(labels == label), label)
    session.painting.end_stroke("Paint")
    idle(qtbot, kept_window)
    sizes = len(W), len(X)
    kept_window.balls = slice(len(V) - sum(sizes), len(V) - sizes[1]), slice(len(V) - sizes[1], len(V))
    return kept_window


def lift(qtbot, window):
    """Move the handle, and wait for the shape."""
    pose = np.eye(4)
    pose[:3, 3] = 0.3, 0.5, 0.0
    window.session.gestures.begin()
    window.session.handles.drag(pose, 0)
    window.session.gestures.end("Move handle")
    idle(qtbot, window)
    return window.session.store.state.frame.U


def stay_boxes(window):
    return [row.stay for row in window.findings.list.rows if row.stay.isVisible()]


def test_finding_list_has_loose_parts_below_their_finding_and_not_as_issues(qtbot, buttoned):
    issues = len(findings(buttoned))
    assert buttoned.findings.badge.text() == f"{issues} issue"
    open_list(qtbot, buttoned)
    rows = [row.accessibleName() for row in buttoned.findings.list.rows]
    assert rows[1:] == [
        "All 2 loose parts",
        "Loose part, 80 triangles",
        "Loose part, 20 triangles",
    ]
    qtbot.mouseClick(buttoned.findings.list.rows[3], LEFT)
    small = buttoned.balls[1]
    assert np.array_equal(marked(buttoned), np.arange(small.start, small.stop))
    assert not any(box.isChecked() for box in stay_boxes(buttoned))


def test_finding_row_lets_a_part_stay_where_it_is_until_undo_takes_it_along(qtbot, buttoned):
    large, small = buttoned.balls
    V = document(buttoned).mesh.V
    U = lift(qtbot, buttoned)
    assert np.abs(U[large] - V[large]).max() > 0.05
    assert np.abs(U[small] - V[small]).max() > 0.05
    open_list(qtbot, buttoned)
    everything, _, last = stay_boxes(buttoned)
    qtbot.mouseClick(last, LEFT)
    idle(qtbot, buttoned)
    assert document(buttoned).immobile_components == (small.start,)
    assert last.isChecked()
    assert not everything.isChecked()
    stayed = buttoned.session.store.state.frame.U
    assert np.array_equal(stayed[small], V[small])
    assert np.abs(stayed[large] - U[large]).max() < 1e-3
    buttoned.session.gestures.undo()
    assert not last.isChecked()
    assert np.array_equal(buttoned.session.store.state.frame.U, U)
    qtbot.mouseClick(everything, LEFT)
    idle(qtbot, buttoned)
    assert all(box.isChecked() for box in stay_boxes(buttoned))
    stayed = buttoned.session.store.state.frame.U
    assert np.array_equal(stayed[large.start :], V[large.start :])


def test_finding_list_calls_a_part_that_is_painted_loose_no_more(qtbot, buttoned):
    session, small = buttoned.session, buttoned.balls[1]
    session.gestures.begin()
    session.painting.paint(np.arange(small.start, small.stop), HANDLE)
    session.painting.end_stroke("Paint")
    open_list(qtbot, buttoned)
    assert len(stay_boxes(buttoned)) == 1


def test_finding_list_does_not_call_the_largest_part_loose_before_any_paint(qtbot, kept_window):
    (V, F), (W, G) = meshes.sphere(2), meshes.sphere(1)
    kept_window.files.show_mesh(Mesh(np.vstack([V, W + 3.0]), np.vstack([F, G + len(V)])))
    idle(qtbot, kept_window)
    open_list(qtbot, kept_window)
    assert len(stay_boxes(kept_window)) == 1


def test_finding_row_welds_seams_at_a_click(qtbot, kept_window):
    kept_window.files.show_mesh(Mesh(*halves(1e-5)))
    idle(qtbot, kept_window)
    before = document(kept_window).mesh
    open_list(qtbot, kept_window)
    weld = kept_window.findings.list.rows[number(kept_window, SEAMS)].weld
    assert [row.weld.isVisible() for row in kept_window.findings.list.rows].count(True) == 1
    qtbot.mouseClick(weld, LEFT)
    qtbot.waitUntil(lambda: document(kept_window).mesh.has_welded_seams)
    idle(qtbot, kept_window)
    assert SEAMS not in [finding.kind for finding in findings(kept_window)]
    assert kept_window.findings.badge.text() == f"{len(findings(kept_window))} issues"
    assert document(kept_window).mesh.V is before.V
    kept_window.actions_.undo.trigger()
    assert document(kept_window).mesh is before
    assert SEAMS in [finding.kind for finding in findings(kept_window)]
