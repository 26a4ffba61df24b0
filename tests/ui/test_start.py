"""A window that can be seen before it can work."""

import os
import re
import subprocess
import sys

import numpy as np
import pytest
from driving import Mouse, centre, document, idle, settle, show, work_off
from PySide6.QtCore import QPoint, QSettings
from PySide6.QtGui import QGuiApplication

from apd_viewer.files.samples import open_sample
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.ui.application import build_workbench
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.tools.tool_modes import Tool
from apd_viewer.ui.workbench import Workbench


def test_workbench_says_that_settings_cannot_be_kept(qtbot, tmp_path):
    (tmp_path / "file").touch()
    place = tmp_path / "file" / "settings.ini"  # below a file, where not even root can write
    shell = Shell(QSettings(str(place), QSettings.Format.IniFormat))
    show(qtbot, shell, shell.canvas.viewport)
    corners, faces = np.vstack([np.zeros(3), np.eye(3)]), [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    shell.requests.show_mesh(Mesh(corners, np.array(faces)))
    window = build_workbench(shell, None, opens_sample=False)
    idle(qtbot, window)
    assert window.notice.text == (
        f"Settings and recent files are not kept, since {place} cannot be written; check its permissions."
    )
    shell.close()
    shell.deleteLater()
    work_off()


@pytest.fixture
def early(qtbot, settings):
    """A window without a workbench."""
    window = Shell(settings)
    show(qtbot, window, window.canvas.viewport)
    yield window
    window.close()
    window.deleteLater()
    work_off()


def test_file_requests_open_the_last_wish_at_the_start(qtbot, early):
    early.requests.open_path("gone.obj")
    early.requests.open_sample("bottle")
    early.requests.show_mesh(Mesh(np.eye(3), np.array([[0, 1, 2]])))
    early.requests.open_sample("duck")
    window = Workbench(early)
    idle(qtbot, window)
    assert document(window).mesh.path.name == "duck.obj"
    assert not window.notice.text


def test_file_requests_say_what_is_wrong_with_a_file_that_was_clicked(qtbot, early, tmp_path):
    early.requests.open_path(tmp_path / "gone.obj")
    window = Workbench(early)
    idle(qtbot, window)
    assert re.match("There is no file .*gone.obj", window.notice.text)
    assert window.session.store.state is None


def test_shell_lets_nothing_break_before_the_start(qtbot, early):
    for action in early.menus.bar.actions()[1:]:  # the first opens a dialog
        action.trigger()
    mouse = Mouse(early.canvas.viewport)
    mouse.drag(centre(early.canvas.viewport), QPoint(30, 30))
    assert not early.panel.isEnabled()
    window = Workbench(early)
    assert early.panel.isEnabled() is False
    assert window.empty_state.isVisible(), "there is nothing to show, and that is said"


def menus(window):
    return [action.menu() for action in window.menuBar().actions()]


def looks(window, bar):
    """What is seen of the menus and of a tool bar."""
    buttons = [
        (each.isSeparator(), each.isEnabled(), each.isChecked(), each.icon().pixmap(24).toImage())
        for each in bar.actions()
    ]
    return [top.text() for top in window.menuBar().actions()], buttons, bar.geometry()


def test_window_menus_and_tool_bar_look_the_same_once_all_is_loaded(qtbot, early):
    before = looks(early, early.menus.bar)
    window = Workbench(early)
    work_off()
    assert looks(early, window.actions_.bar) == before


def test_window_menus_take_a_tool_before_the_start_that_is_still_in_use_after_it(qtbot, early):
    tools = next(menu for menu in menus(early) if menu.title() == "&Tools")
    next(action for action in tools.actions() if action.text() == Tool.BASE.traits.title).trigger()
    assert early.canvas.tool is Tool.BASE
    before = looks(early, early.menus.bar)
    window = Workbench(early)
    work_off()
    assert early.canvas.tool is Tool.BASE
    assert window.actions_.tools[Tool.BASE].isChecked()
    assert looks(early, window.actions_.bar) == before


def test_window_menus_have_no_entry_without_effect(early):
    for menu in menus(early):
        assert menu.actions()
        for action in menu.actions():
            assert action.isEnabled() == (action.text() != "Loading…")


def test_window_menus_keep_a_menu_open_that_is_open_at_the_start(qtbot, early):
    bar = early.menuBar()
    bar.setActiveAction(bar.actions()[6])
    assert menus(early)[6].isVisible()
    window = Workbench(early)
    qtbot.waitUntil(lambda: bar.actions()[6].menu().isVisible())
    assert window.actions_.view.findings in bar.actions()[6].menu().actions()
    bar.actions()[6].menu().close()


def test_build_workbench_starts_nothing_in_a_window_closed_before_the_start(early):
    early.requests.open_sample("bottle")
    assert early.close()
    assert build_workbench(early, None, opens_sample=False) is None


def test_preview_surface_shows_the_bottle_before_the_start_and_it_is_not_touched(qtbot, early):
    view = early.canvas.viewport
    mesh, labels = open_sample("bottle")
    empty = view.screenshot().copy() if QGuiApplication.platformName() != "offscreen" else None
    early.canvas.show_loading_mesh(mesh, labels)
    early.requests.open_sample("bottle")
    settle(qtbot, view)
    early.canvas.choose_tool(Tool.BASE)
    mouse, framed = Mouse(view), view.camera_controller.camera.key
    mouse.drag(centre(view), centre(view) + QPoint(20, 0))  # which is no stroke, but turns the camera
    moved = view.camera_controller.camera.key
    window = Workbench(early)
    idle(qtbot, window)
    assert moved != framed
    assert view.camera_controller.camera.key == moved, "the camera stays where it was turned to"
    assert np.array_equal(document(window).labels, labels)
    if empty is not None:
        view.antialiasing.idle_timer.stop()
        assert (view.screenshot() != empty).any()


def test_preview_surface_looks_like_the_opened_mesh(qtbot, early):
    if QGuiApplication.platformName() == "offscreen":
        pytest.skip("the offscreen platform has no OpenGL, so there is no picture to compare")
    view = early.canvas.viewport
    early.canvas.show_loading_mesh(*open_sample("bottle"))
    early.requests.open_sample("bottle")
    sketch = view.screenshot().astype(int)
    idle(qtbot, Workbench(early))
    differs = np.abs(view.screenshot().astype(int) - sketch).max(axis=2) > 3
    assert differs.mean() <= 0.02, "only sharp edges are shaded later"


def test_preview_surface_leaves_room_for_the_gizmo(qtbot, early):
    early.canvas.show_loading_mesh(*open_sample("bottle"))
    early.requests.open_sample("bottle")
    sketched = early.canvas.viewport.camera_controller.camera
    idle(qtbot, Workbench(early))
    early.canvas.frame_mesh()
    np.testing.assert_allclose(
        early.canvas.viewport.camera_controller.camera.position, sketched.position, rtol=1e-9
    )


def test_canvas_frames_another_mesh_than_the_sketched_one(qtbot, early):
    early.canvas.show_loading_mesh(*open_sample("bottle"))
    early.requests.open_sample("duck")
    before = early.canvas.viewport.camera_controller.camera.key
    idle(qtbot, Workbench(early))
    assert early.canvas.viewport.camera_controller.camera.key != before


MISSING = """
import sys
sys.modules[{!r}] = None
from apd_viewer.__main__ import main
sys.exit(main([]))
"""


@pytest.mark.parametrize(
    "library", ["numba", *(pytest.param(name, marks=pytest.mark.night) for name in ("cholespy", "pyvistaqt"))]
)
def test_main_tells_in_a_sentence_of_a_library_missing_behind_the_first_picture(library):
    done = subprocess.run(
        [sys.executable, "-c", MISSING.format(library)],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert done.returncode == 2
    assert re.fullmatch(rf"error: A library that the window needs is missing .*{library}.+\n", done.stderr)


READ_ALOUD = """
import sys
from PySide6.QtCore import QTimer
from apd_viewer.__main__ import main
from apd_viewer.ui import application

def built(*given, build=application.build_workbench):
    workbench = build(*given)
    def look():
        if workbench.notice.text:
            print(workbench.notice.text)
            workbench.shell.close()
    QTimer(workbench, interval=20, timeout=look).start()
    return workbench

application.build_workbench = built
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.night
@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("gone.obj", "There is no file .*gone.obj"),
        ("empty.stl", "empty.stl is empty"),
        ("session", "session is not a supported file type"),
        ("cut.apd", "cut.apd is not a valid session"),
    ],
)
def test_workbench_says_what_is_wrong_with_a_file_that_was_clicked(name, said, tmp_path):
    (tmp_path / "empty.stl").touch()
    for other in ("session", "cut.apd"):
        (tmp_path / other).write_bytes(b"PK\3\4")
    done = subprocess.run(
        [sys.executable, "-c", READ_ALOUD, "--clicked", str(tmp_path / name)],
        env=os.environ | {"HOME": str(tmp_path), "XDG_CONFIG_HOME": str(tmp_path / "config")},
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert re.match(said, done.stdout)


def test_main_gives_an_error_on_the_command_line_and_opens_no_window(tmp_path):
    command = [sys.executable, "-m", "apd_viewer", str(tmp_path / "gone.obj")]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 2
    assert re.fullmatch(r"error: There is no file .*gone\.obj.*\n", done.stderr)


ENDED = """
import os, signal, sys
from pathlib import Path
from PySide6.QtCore import QTimer
from apd_viewer.__main__ import main
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.ui import application

signal.signal(signal.SIGHUP, signal.SIG_DFL)  # which nohup may have the tests ignore

def built(*given, build=application.build_workbench):
    workbench = build(*given)
    session, own, stage = workbench.session, Path(os.environ["TMPDIR"]), []
    def look():
        if not stage and session.store.state is not None and session.jobs.current is None:
            session.handles.move_by(MOTIONS["TWIST"], "20deg", 0)
            workbench.actions_.simulate.press.trigger()
            workbench.runs.dialogs["press"].run.start.click()
            stage.append("presses")
        kept = list(given[1].glob("*.apd")) and list(own.glob("apd-viewer-*/results"))
        if kept and stage == ["presses"]:
            stage.append("ended")
            os.kill(os.getpid(), getattr(signal, sys.argv.pop()))
    QTimer(workbench, interval=20, timeout=look).start()
    return workbench

application.build_workbench = built
sys.exit(main([]))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals of Unix")
@pytest.mark.night
@pytest.mark.parametrize(("name", "status"), [("SIGTERM", 143), ("SIGHUP", 129)])
def test_workbench_ended_by_a_signal_leaves_unsaved_work_and_no_scratch(name, status, tmp_path):
    own = tmp_path / "tmp"
    own.mkdir()
    done = subprocess.run(
        [sys.executable, "-c", ENDED, name],
        env=os.environ | {"HOME": str(tmp_path), "XDG_DATA_HOME": str(tmp_path / "data"), "TMPDIR": str(own)},
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert (done.returncode, done.stderr) == (status, "")
    assert list(own.glob("apd-viewer-*")) == []
    assert list(tmp_path.rglob("recovery/*.apd"))
