"""Two windows on one session: the second to save is asked, and neither loses its work without a word."""

import os
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from answering import Person
from driving import idle, work_off
from kept_window import lasting_window, settings_in
from meshes import box, ends
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFileDialog

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.session.model import state
from apd_viewer.session.model.view import View
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.storage.session_file import open_session, save_session
from apd_viewer.ui.filing import file_controller
from apd_viewer.ui.filing.file_controller import UnsavedAnswer

ASK = file_controller.ask_before_leaving
SLOW = 20_000  # ms; nothing here should come near it
# Whoever saves in another process, and leaves no window behind.
OTHER = """
import sys
from apd_viewer.session.storage.session_file import open_session, save_session
state, view = open_session(sys.argv[1])
save_session(sys.argv[1], state, view, embed=True)
"""


@pytest.fixture(scope="module")
def bar(tmp_path_factory):
    """State of a bar with painted ends, from a file: quick to twist."""
    V, F = box(2, 2, 5)
    path = tmp_path_factory.mktemp("bar") / "bar.obj"
    save_mesh(Mesh(V, F), V, path)
    labels = np.full(len(V), FREE, np.uint8)
    for ids, label in zip(ends(V), (BASE, HANDLE), strict=True):
        labels[ids] = label
    return state.initial_state(open_mesh(path), labels)


@pytest.fixture
def path(tmp_path, bar):
    """A session in a folder of its own."""
    (tmp_path / "work").mkdir()
    save_session(tmp_path / "work" / "two.apd", bar, View())
    return tmp_path / "work" / "two.apd"


@pytest.fixture(scope="module")
def pair(qapp, tmp_path_factory):
    """Two windows with settings of their own, for all tests of this file."""
    stored = [settings_in(tmp_path_factory.mktemp("settings")) for _ in range(2)]
    with lasting_window(stored[0]) as first, lasting_window(stored[1]) as second:
        yield first, second


@pytest.fixture
def open_window(qtbot, path, pair, monkeypatch):
    """Opens the session in a window, and then in another one."""
    used = []

    def open_window():
        used.append(pair[len(used)])
        return opened(qtbot, used[-1].opened(qtbot), path)

    yield open_window
    monkeypatch.setattr(file_controller, "ask_before_leaving", lambda *_: UnsavedAnswer.DISCARD)
    for kept in used:
        kept.reset(qtbot)


def opened(qtbot, window, path):
    window.files.open_path(path)
    idle(qtbot, window)
    return window


@pytest.fixture
def person(monkeypatch):
    """Someone at the windows, who has given all answers at the end."""
    person = Person()
    monkeypatch.setattr(QFileDialog, "getSaveFileName", person.choose)
    yield person
    left, person.answers = person.answers, []  # to be given by nobody in the tests that follow
    assert left == [], "a question was not asked"


def twist(qtbot, window, degrees=20):
    window.session.handles.move_by(MOTIONS["TWIST"], str(degrees), 0)
    idle(qtbot, window)


def save(qtbot, window):
    window.actions_.file.save.trigger()
    idle(qtbot, window)


def come_to(qtbot, window):
    """Look elsewhere and come back."""
    window.shell.activated.emit()
    qtbot.waitUntil(lambda: "saved file" not in [thread.name for thread in threading.enumerate()])
    work_off()


def shape(path):
    return open_session(path)[0].frame.U


def clash(qtbot, open_window, path):
    """Two windows with different work, of which the first has been saved."""
    first, second = open_window(), open_window()
    twist(qtbot, first, 20)
    twist(qtbot, second, -15)
    save(qtbot, first)
    assert np.array_equal(shape(path), first.session.store.state.frame.U)
    assert not first.session.saved_work.is_unsaved
    return first, second


def saved(qtbot, person, window):
    """Save, until the question is answered and what follows is done."""
    save(qtbot, window)
    qtbot.waitUntil(lambda: person.answers == [], timeout=SLOW)
    work_off()
    idle(qtbot, window)


QUESTION = "“two.apd” has been changed by another window or program. Overwrite it?"


@pytest.mark.parametrize(
    "answer",
    [
        pytest.param("Cancel", marks=pytest.mark.night),
        pytest.param(Qt.Key.Key_Escape, marks=pytest.mark.night),
        Qt.Key.Key_Return,
        pytest.param("Save as…", marks=pytest.mark.night),
    ],
)
def test_save_asks_the_second_window_which_loses_nothing_by_a_key(qtbot, open_window, path, person, answer):
    first, second = clash(qtbot, open_window, path)
    before, U = path.read_bytes(), second.session.store.state.frame.U
    person.target = path.with_name("mine.apd")
    person.will(answer)
    saved(qtbot, person, second)
    assert person.asked == [QUESTION]
    assert path.read_bytes() == before
    renamed = answer in (Qt.Key.Key_Return, "Save as…")
    assert person.target.exists() == renamed
    assert second.session.saved_work.is_unsaved != renamed
    assert np.array_equal(second.session.store.state.frame.U, U)
    if renamed:
        assert np.array_equal(shape(person.target), U)
    assert not first.session.saved_work.is_unsaved


def test_saved_work_that_is_overwritten_is_unsaved_where_it_came_from(qtbot, open_window, path, person):
    first, second = clash(qtbot, open_window, path)
    person.will("Overwrite")
    saved(qtbot, person, second)
    assert np.array_equal(shape(path), second.session.store.state.frame.U)
    assert not second.session.saved_work.is_unsaved
    come_to(qtbot, first)
    assert first.shell.isWindowModified()
    assert "two.apd has been changed by another window or program" in first.notice.text
    person.will(UnsavedAnswer.CANCEL)
    first.shell.close()
    assert person.asked[1:] == ["Save changes to “two.apd” before closing?"]
    assert first.shell.isVisible()


def test_changed_file_answer_to_reload_shows_the_file_and_undo_brings_the_work_back(
    qtbot, open_window, path, person
):
    first, second = clash(qtbot, open_window, path)
    U = second.session.store.state.frame.U
    person.will("Reload")
    saved(qtbot, person, second)
    assert np.array_equal(second.session.store.state.frame.U, first.session.store.state.frame.U)
    assert not second.session.saved_work.is_unsaved
    save(qtbot, second)
    second.session.gestures.undo()
    assert np.array_equal(second.session.store.state.frame.U, U)
    assert second.session.saved_work.is_unsaved
    person.will("Cancel")
    saved(qtbot, person, second)
    assert person.asked == [QUESTION] * 2, "what the other window saved is not lost by this way either"


def test_changed_file_answer_is_for_what_was_there_and_not_for_what_came_later(
    qtbot, open_window, path, person, monkeypatch
):
    _, second = clash(qtbot, open_window, path)
    person.will("Overwrite", "Cancel")
    third = path.read_bytes() + b"\0"
    replaced = second.session.files.save

    def slow(*args):
        if args[-1] is not None:  # what was agreed to
            path.write_bytes(third)
        replaced(*args)

    monkeypatch.setattr(second.session.files, "save", slow)
    saved(qtbot, person, second)
    assert person.asked == [QUESTION] * 2
    assert path.read_bytes() == third


def test_may_discard_work_asks_both_questions_and_closes_once_it_is_safe(qtbot, open_window, path, person):
    _, second = clash(qtbot, open_window, path)
    U = second.session.store.state.frame.U
    person.will(UnsavedAnswer.SAVE, "Cancel")
    second.shell.close()
    qtbot.waitUntil(lambda: person.answers == [], timeout=SLOW)
    work_off()
    assert second.shell.isVisible()
    person.will(UnsavedAnswer.SAVE, "Overwrite")
    second.shell.close()
    qtbot.waitUntil(lambda: second.shell.is_closed, timeout=SLOW)
    assert np.array_equal(shape(path), U)


@pytest.mark.night
def test_save_asks_about_another_process_as_about_another_window(qtbot, open_window, path, person):
    window = open_window()
    twist(qtbot, window)
    subprocess.run([sys.executable, "-c", OTHER, str(path)], check=True)
    other = path.read_bytes()
    person.will(Qt.Key.Key_Escape)
    saved(qtbot, person, window)
    assert person.asked == [QUESTION]
    assert path.read_bytes() == other


def test_save_asks_nobody_about_a_touch_or_the_same_again(qtbot, open_window, path, person):
    window = open_window()
    content = path.read_bytes()
    path.with_name("synced").write_bytes(content)
    path.with_name("synced").replace(path)
    os.utime(path, (time.time() + 1e8,) * 2)
    come_to(qtbot, window)
    assert not window.shell.isWindowModified()
    for k in range(3):
        twist(qtbot, window, 5 + k)
        save(qtbot, window)
        os.utime(path, (0, 0))
    assert not window.session.saved_work.is_unsaved
    assert np.array_equal(shape(path), window.session.store.state.frame.U)


# A file that goes


@pytest.mark.parametrize(
    "folder_too", [False, pytest.param(True, marks=pytest.mark.night)], ids=["file", "folder"]
)
def test_saved_work_that_has_gone_is_unsaved_in_title_recovery_and_question(
    qtbot, started, path, person, tmp_path, monkeypatch, folder_too
):
    window = opened(qtbot, started(), path)
    twist(qtbot, window)
    save(qtbot, window)
    qtbot.waitUntil(lambda: list((tmp_path / "recovery").glob("*.apd")) == [], timeout=SLOW)
    path.unlink()
    if folder_too:
        path.parent.rmdir()
    come_to(qtbot, window)
    assert window.shell.isWindowModified()
    assert "two.apd has been moved or deleted" in window.notice.text
    qtbot.waitUntil(lambda: list((tmp_path / "recovery").glob("*.apd")) != [], timeout=SLOW)
    (kept,) = (tmp_path / "recovery").glob("*.apd")
    U = window.session.store.state.frame.U
    assert np.array_equal(shape(kept), U)
    person.target = tmp_path / "elsewhere.apd"
    person.will(UnsavedAnswer.SAVE)
    with monkeypatch.context() as patch:
        patch.setattr(file_controller, "ask_before_leaving", ASK)
        window.shell.close()
        qtbot.waitUntil(lambda: window.shell.is_closed, timeout=SLOW)
    assert np.array_equal(shape(person.target if folder_too else path), U)


def test_may_discard_work_finds_by_closing_alone_that_the_file_has_gone(qtbot, open_window, path, person):
    window = open_window()
    path.unlink()
    person.will(UnsavedAnswer.CANCEL)
    window.shell.close()
    assert person.asked == ["Save changes to “two.apd” before closing?"]
    assert window.shell.isVisible()


def test_saved_work_that_comes_back_is_saved_again(qtbot, open_window, path, person):
    window = open_window()
    path.rename(path.with_name("moved.apd"))
    come_to(qtbot, window)
    assert window.shell.isWindowModified()
    path.with_name("moved.apd").rename(path)
    come_to(qtbot, window)
    assert not window.shell.isWindowModified()


def test_saved_work_is_looked_for_on_coming_to_the_window(qtbot, open_window, path):
    window, other = open_window(), open_window()
    path.unlink()
    window.shell.activateWindow()
    qtbot.waitUntil(window.shell.isWindowModified, timeout=SLOW)
    other.shell.activateWindow()
    qtbot.waitUntil(other.shell.isWindowModified, timeout=SLOW)
