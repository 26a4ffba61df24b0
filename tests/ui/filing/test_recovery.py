"""Work that was kept aside, in windows: what becomes of it after it was restored, refused or found twice."""

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from driving import Mouse, centre, document, drag, idle, ring_grip, work_off

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.samples import open_sample
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.view import View
from apd_viewer.session.storage.recovery_file import find_recovery_files
from apd_viewer.session.storage.session_file import open_session, save_session
from apd_viewer.ui.application import recovery_folder
from apd_viewer.ui.filing import file_controller, file_dialogs
from apd_viewer.ui.filing.file_controller import UnsavedAnswer

SLOW = 20_000  # ms; nothing here should come near it
PROGRAM = """
import sys
from pathlib import Path
from PySide6.QtCore import QSettings
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.ui.application import make_application
application = make_application([])
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.workbench import Workbench
folder = Path(sys.argv[1])
shell = Shell(QSettings(str(folder / "other.ini"), QSettings.Format.IniFormat))
shell.requests.open_sample("bottle")
shell.show()
window = Workbench(shell, folder / "recovery")
assert window.session.wait_idle(20.0)
window.session.handles.move_by(MOTIONS["TWIST"], "20", 0)
assert window.session.wait_idle(20.0)
application.exec()
"""


@pytest.fixture
def duck(tmp_path):
    """A duck of one's own, stretched a little: a state that is in no file."""
    mesh, labels = open_sample("duck")
    save_mesh(mesh, mesh.V, tmp_path / "my duck.obj")
    state = initial_state(open_mesh(tmp_path / "my duck.obj"), labels)
    return state.updated(frame=replace(state.frame, U=frozen(state.frame.U * [1.0, 1.1, 1.0])))


def leave(folder, state, name="1-1", age=185.0):
    """Leave what a program has left that is dead."""
    folder.mkdir(exist_ok=True)
    path = folder / f"{name}.apd"
    save_session(path, state, View())
    os.utime(path, (time.time() - age,) * 2)
    return path


def click(button):
    Mouse(button).drag(centre(button))


def restore(qtbot, window):
    click(window.recovery.restore)
    idle(qtbot, window)


def files(folder):
    return sorted(path.name for path in folder.glob("[!.]*.apd"))


def test_autosave_keeps_a_drag_with_the_mouse_and_nothing_without_a_folder(qtbot, started, bottle, folder):
    drag(qtbot, bottle, ring_grip(bottle, 1), (25, 0), steps=4)
    idle(qtbot, bottle)
    assert not folder.exists()
    assert not bottle.recovery.text
    window = started()
    drag(qtbot, window, ring_grip(window, 1), (25, 0), steps=4)
    idle(qtbot, window)
    U = window.session.store.state.frame.U

    def is_kept():
        state, view = open_session(folder / files(folder)[0])
        assert np.array_equal(state.frame.U, U)
        saved = window.canvas.view.saved_view(window.session.store.unit.value)
        assert view == window.volume.with_wall_and_overlay(saved)

    qtbot.waitUntil(lambda: files(folder) != [], timeout=SLOW)
    qtbot.waitUntil(is_kept, timeout=SLOW)


def test_restore_gives_unsaved_work_that_is_saved_only_where_one_says(
    qtbot, started, folder, duck, tmp_path, monkeypatch
):
    path = leave(folder, duck)
    save_session(tmp_path / "earlier.apd", duck, View())
    earlier = (tmp_path / "earlier.apd").read_bytes()
    asked, answers = [], []
    monkeypatch.setattr(
        file_dialogs, "ask_where_to_save_session", lambda *_: asked.append(1) or answers.pop()
    )
    window = started()
    assert window.recovery.text == "Unsaved work: my duck.obj, 3 minutes ago"
    window.files.open_path(tmp_path / "earlier.apd")
    idle(qtbot, window)
    assert not window.session.saved_work.is_unsaved
    restore(qtbot, window)
    assert document(window).mesh.name == "my duck.obj"
    assert window.session.saved_work.is_unsaved
    answers[:] = [None]
    window.actions_.file.save.trigger()
    idle(qtbot, window)
    assert asked == [1]
    qtbot.waitUntil(lambda: not path.exists(), timeout=SLOW)
    assert len(files(folder)) == 1, "the one of this program"
    answers[:] = [(tmp_path / "mine.apd", False)]
    window.actions_.file.save.trigger()
    idle(qtbot, window)
    assert (tmp_path / "mine.apd").exists()
    assert (tmp_path / "earlier.apd").read_bytes() == earlier
    assert not window.session.saved_work.is_unsaved


def test_restore_brings_what_was_baked_back_with_its_own_file_and_folder(
    qtbot, started, folder, duck, tmp_path
):
    leave(folder, initial_state(duck.document.mesh.baked(duck.frame.U), duck.document.labels))
    window = started()
    restore(qtbot, window)
    assert document(window).mesh.path == tmp_path / "my duck.obj"
    assert np.array_equal(document(window).mesh.V, duck.frame.U)
    assert window.shell.preferences.recent_files == [tmp_path / "my duck.obj"]
    assert window.shell.preferences.last_folder == tmp_path


def test_restore_does_not_remember_a_mesh_whose_file_is_gone(qtbot, started, folder, duck, tmp_path):
    leave(folder, initial_state(duck.document.mesh.baked(duck.frame.U), duck.document.labels))
    (tmp_path / "my duck.obj").unlink()
    window = started()
    before = window.shell.preferences.last_folder
    restore(qtbot, window)
    assert document(window).mesh.name == "my duck.obj"
    assert window.shell.preferences.recent_files == []
    assert window.shell.preferences.last_folder == before


@pytest.mark.night
def test_autosave_keeps_what_was_restored_for_another_crash(qtbot, started, folder, duck):
    leave(folder, duck)
    window = started()
    restore(qtbot, window)
    qtbot.waitUntil(lambda: "1-1.apd" not in files(folder) and files(folder) != [], timeout=SLOW)
    state = open_session(folder / files(folder)[0])[0]
    assert np.array_equal(state.frame.U, duck.frame.U)


def test_recovery_bar_offers_the_newest_first_and_the_others_stay(qtbot, started, folder, duck):
    leave(folder, duck, "1-1", age=7300.0)
    leave(folder, initial_state(*open_sample("cloth")), "2-1", age=61.0)
    leave(folder, duck, "3-1", age=3 * 86400.0)
    leave(folder, duck, "4-1", age=31 * 86400.0)
    window = started()
    assert files(folder) == ["1-1.apd", "2-1.apd", "3-1.apd", "4-1.apd"]
    assert window.recovery.text == "Unsaved work 1 of 4: cloth.obj, 1 minute ago"
    click(window.recovery.discard)
    assert window.recovery.text == "Unsaved work 1 of 3: my duck.obj, 2 hours ago"
    restore(qtbot, window)
    assert not window.recovery.text
    qtbot.waitUntil(lambda: "1-1.apd" not in files(folder), timeout=SLOW)
    window.shell.close()
    assert files(folder) == ["3-1.apd", "4-1.apd"]
    assert started().recovery.text == "Unsaved work 1 of 2: my duck.obj, 3 days ago"


@pytest.mark.night
def test_recovery_bar_finds_none_too_old_and_each_can_be_reached_restored_and_put_off(
    qtbot, started, folder, duck
):
    ages = {"1-1": time.time(), "2-1": -9e8, "3-1": 400 * 86400.0, "4-1": 61.0}
    for name, age in ages.items():
        leave(folder, duck, name, age)
    window = started()
    said = []
    for _ in range(5):
        said.append(window.recovery.text)
        click(window.recovery.next)
    words = ["at an unknown time", "1 minute ago", "400 days ago", "at an unknown time"]
    assert said[:4] == [f"Unsaved work {k + 1} of 4: my duck.obj, {words[k]}" for k in range(4)]
    assert said[4] == said[0]
    assert window.canvas.viewport.rect().contains(window.recovery.geometry())
    click(window.recovery.next)
    click(window.recovery.next)
    restore(qtbot, window)
    qtbot.waitUntil(lambda: "1-1.apd" not in files(folder), timeout=SLOW)
    assert len(files(folder)) == 4, "the other three, and that of this window"
    window.shell.close()
    assert files(folder) == ["2-1.apd", "3-1.apd", "4-1.apd"]
    window = started()
    click(window.recovery.later)
    assert not window.recovery.text
    window.shell.close()
    assert files(folder) == ["2-1.apd", "3-1.apd", "4-1.apd"]


def test_recovery_bar_has_no_next_for_a_single_one(qtbot, started, folder, duck):
    leave(folder, duck, "1-1")
    leave(folder, duck, "2-1")
    window = started()
    assert window.recovery.next.isVisible()
    click(window.recovery.next)
    click(window.recovery.discard)
    assert window.recovery.text.startswith("Unsaved work: my duck.obj")
    assert not window.recovery.next.isVisible()


def test_restore_refuses_what_is_damaged_which_goes_only_when_it_is_discarded(qtbot, started, folder, duck):
    path = leave(folder, duck)
    path.write_bytes(path.read_bytes()[:1000])
    window = started()
    before = window.session.store.state
    assert "a damaged session" in window.recovery.text
    restore(qtbot, window)
    assert window.notice.text.startswith("The unsaved work on a damaged session cannot be restored: ")
    assert window.session.store.state is before
    assert window.recovery.restore.isVisible()
    assert path.exists()
    window.shell.close()
    assert path.exists()
    window = started()
    click(window.recovery.discard)
    assert not window.recovery.text
    assert not path.exists()


def test_recovery_bar_does_not_take_the_keys(qtbot, started, folder, duck):
    leave(folder, duck)
    window = started()
    focus = window.shell.focusWidget()
    click(window.recovery.discard)
    assert window.shell.focusWidget() is focus


def test_recovery_bar_fits_into_a_small_window_whatever_the_mesh_is_called(
    qtbot, started, folder, duck, tmp_path
):
    path = tmp_path / f"{'long ' * 40}.obj"
    save_mesh(duck.document.mesh, duck.document.mesh.V, path)
    leave(folder, initial_state(open_mesh(path)))
    window = started()
    window.shell.resize(window.shell.minimumSize())
    work_off()
    assert window.canvas.viewport.rect().contains(window.recovery.geometry())
    assert not window.recovery.geometry().intersects(window.invitation.geometry())


def test_autosave_goes_on_in_a_window_that_is_not_closed_because_of_the_question(
    qtbot, started, folder, duck, monkeypatch
):
    leave(folder, duck)
    window = started()
    restore(qtbot, window)
    qtbot.waitUntil(lambda: "1-1.apd" not in files(folder), timeout=SLOW)
    with monkeypatch.context() as patch:
        patch.setattr(file_controller, "ask_before_leaving", lambda *_: UnsavedAnswer.CANCEL)
        assert not window.shell.close()
    assert len(files(folder)) == 1
    assert window.shell.close()
    assert list(folder.iterdir()) == []


# By night: what a killed program leaves is looked at in test_autosave, and what is offered above.
@pytest.mark.night
@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGKILL")
def test_recovery_bar_offers_the_work_of_a_killed_program_in_the_next_and_not_before(
    qtbot, started, folder, tmp_path
):
    with subprocess.Popen([sys.executable, "-c", PROGRAM, str(tmp_path)]) as program:
        try:
            qtbot.waitUntil(lambda: files(folder) != [] or program.poll() is not None, timeout=60_000)
            assert find_recovery_files(folder) == [], "it lives"
            first = started()
            assert not first.recovery.text
        finally:
            program.send_signal(signal.SIGKILL)
    first.shell.close()
    window = started()
    assert window.recovery.text.endswith("bottle.obj, just now")
    restore(qtbot, window)
    assert not window.recovery.text
    assert not window.session.store.state.is_at_rest


def test_recovery_folder_is_the_users_and_the_programs_own():
    assert recovery_folder().name == "recovery"
    assert Path.home() in recovery_folder().parents
