"""Nothing that was said is lost without a file_controller, and each of its answers does what it says."""

import threading

import numpy as np
import pytest
from answering import LEFT, Person
from driving import idle, work_off
from PySide6.QtCore import QMimeData, QPointF, Qt, QUrl
from PySide6.QtGui import QDropEvent
from PySide6.QtWidgets import QFileDialog

from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE
from apd_viewer.session import file_jobs
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.storage.session_file import open_session
from apd_viewer.ui.filing import file_controller, file_dialogs
from apd_viewer.ui.filing.file_controller import UnsavedAnswer
from apd_viewer.ui.studies.study_run import StudyRun

ASK = file_controller.ask_before_leaving
CHANGES = {
    "paint": lambda session: paint(session),
    "setting": lambda session: session.settings.change(stiffness=0.01),
    "shape": lambda session: session.handles.move_by(MOTIONS["TWIST"], "20", 0),
}


def paint(session):
    free = np.flatnonzero(session.store.state.document.labels == FREE)
    session.gestures.begin()
    session.painting.paint(free[:20], BASE)
    session.painting.end_stroke("Paint base")


@pytest.fixture
def person(bottle, monkeypatch):
    """Someone at the window, asked by the real dialogs."""
    person = Person(bottle)
    monkeypatch.setattr(QFileDialog, "getSaveFileName", person.choose)
    monkeypatch.setattr(file_controller, "ask_before_leaving", ASK)
    yield person
    monkeypatch.setattr(file_controller, "ask_before_leaving", lambda *_: UnsavedAnswer.DISCARD)
    left, person.answers = person.answers, []  # to be given by nobody in the tests that follow
    assert left == [], "a question was not asked"


def close(window):
    window.shell.close()


def open_duck(window):
    window.shell.requests.open_sample("duck")


LEAVING = {"closing": close, "opening": open_duck}
END = {"closing": "closing", "opening": "opening another file"}


def has_left(qtbot, window, leaving, before):
    """Whether it was done, once all is written and read."""
    jobs = window.session.jobs
    work_off()
    qtbot.waitUntil(lambda: jobs.current is None, timeout=60_000)
    work_off()
    if leaving == "closing":
        return window.shell.is_closed
    assert window.shell.isVisible()
    return window.session.store.state.document.mesh is not before.document.mesh


CHANGED = {
    UnsavedAnswer.SAVE: "setting",
    UnsavedAnswer.EXPORT: "shape",
    UnsavedAnswer.DISCARD: "paint",
    UnsavedAnswer.CANCEL: "paint",
}


@pytest.mark.parametrize("leaving", LEAVING)
@pytest.mark.parametrize("answer", UnsavedAnswer)
def test_unsaved_answer_does_what_it_says(qtbot, bottle, person, tmp_path, leaving, answer):
    CHANGES[CHANGED[answer]](bottle.session)
    before = bottle.session.store.state
    person.target = tmp_path / ("mine.apd" if answer is UnsavedAnswer.SAVE else "mine.obj")
    person.will(answer)
    LEAVING[leaving](bottle)
    assert has_left(qtbot, bottle, leaving, before) == (answer is not UnsavedAnswer.CANCEL)
    assert person.asked == [f"Save changes to “bottle.obj” before {END[leaving]}?"]
    assert person.target.exists() == (answer in (UnsavedAnswer.SAVE, UnsavedAnswer.EXPORT))
    if answer is UnsavedAnswer.SAVE:
        assert open_session(person.target)[0].document.settings == before.document.settings
    if answer is UnsavedAnswer.EXPORT:
        assert len(open_mesh(person.target).V) == len(before.frame.U)
    if answer is UnsavedAnswer.CANCEL:
        assert bottle.session.store.state.document is before.document
        assert bottle.shell.isVisible()


@pytest.mark.parametrize("leaving", LEAVING)
def test_may_discard_work_asks_about_every_change_until_it_is_undone(qtbot, bottle, person, leaving):
    before = bottle.session.store.state
    for change in CHANGES.values():
        change(bottle.session)
        person.will(UnsavedAnswer.CANCEL)
        LEAVING[leaving](bottle)
        assert bottle.shell.isVisible()
        bottle.session.gestures.undo()
    assert len(person.asked) == len(CHANGES)
    LEAVING[leaving](bottle)
    assert has_left(qtbot, bottle, leaving, before)


@pytest.mark.parametrize("leaving", LEAVING)
@pytest.mark.parametrize("answer", [UnsavedAnswer.SAVE, UnsavedAnswer.EXPORT])
def test_may_discard_work_takes_no_leave_where_no_file_is_chosen(qtbot, bottle, person, leaving, answer):
    paint(bottle.session)
    before = bottle.session.store.state
    person.will(answer)
    LEAVING[leaving](bottle)
    assert not has_left(qtbot, bottle, leaving, before)
    assert bottle.session.store.state is before


@pytest.mark.parametrize("leaving", LEAVING)
def test_may_discard_work_does_not_leave_what_cannot_be_saved(qtbot, bottle, person, tmp_path, leaving):
    paint(bottle.session)
    before = bottle.session.store.state
    person.target = tmp_path / "gone" / "mine.apd"
    person.will(UnsavedAnswer.SAVE)
    LEAVING[leaving](bottle)
    assert not has_left(qtbot, bottle, leaving, before)
    assert "mine.apd" in bottle.notice.text
    assert bottle.session.saved_work.is_unsaved


@pytest.mark.parametrize(("key", "closes"), [(Qt.Key.Key_Return, True), (Qt.Key.Key_Escape, False)])
def test_ask_before_leaving_saves_by_enter_and_stays_by_esc(qtbot, bottle, person, tmp_path, key, closes):
    paint(bottle.session)
    person.target = tmp_path / "mine.apd"
    person.will(key)
    close(bottle)
    assert has_left(qtbot, bottle, "closing", None) == closes
    assert person.target.exists() == closes


@pytest.mark.parametrize("leaving", LEAVING)
def test_may_discard_work_asks_no_question_where_nothing_was_said(qtbot, bottle, person, leaving):
    before = bottle.session.store.state
    LEAVING[leaving](bottle)
    assert has_left(qtbot, bottle, leaving, before)
    assert person.asked == []


def test_may_discard_work_saves_a_session_that_was_saved_before_without_asking_for_a_path(
    qtbot, bottle, person, tmp_path
):
    paint(bottle.session)
    person.target = tmp_path / "mine.apd"
    bottle.actions_.file.save.trigger()
    idle(qtbot, bottle)
    person.target = ""
    bottle.session.settings.change(stiffness=0.01)
    person.will(UnsavedAnswer.SAVE)
    close(bottle)
    assert has_left(qtbot, bottle, "closing", None)
    assert person.asked == ["Save changes to “mine.apd” before closing?"]
    assert open_session(tmp_path / "mine.apd")[0].document.settings.stiffness == 0.01


def test_may_discard_work_asks_again_where_a_running_study_kept_the_window_open(
    qtbot, bottle, person, tmp_path, monkeypatch
):
    monkeypatch.setattr(StudyRun, "is_running", property(lambda _: True))
    paint(bottle.session)
    person.target = tmp_path / "mine.apd"
    person.will(UnsavedAnswer.SAVE, "Cancel")
    close(bottle)
    qtbot.waitUntil(lambda: len(person.asked) == 2)
    assert not has_left(qtbot, bottle, "closing", None)
    monkeypatch.setattr(StudyRun, "is_running", property(lambda _: False))
    bottle.session.settings.change(stiffness=0.01)
    person.will(UnsavedAnswer.CANCEL)
    close(bottle)
    assert not has_left(qtbot, bottle, "closing", None)
    assert len(person.asked) == 3


@pytest.mark.parametrize("leaving", LEAVING)
def test_may_discard_work_asks_again_about_what_was_done_during_the_export(
    qtbot, bottle, person, tmp_path, monkeypatch, leaving
):
    write, may_end = file_jobs.save_mesh, threading.Event()

    def slow(*given, **more):
        may_end.wait(60)
        return write(*given, **more)

    monkeypatch.setattr(file_jobs, "save_mesh", slow)
    paint(bottle.session)
    before = bottle.session.store.state
    person.target = tmp_path / "mine.obj"
    person.will(UnsavedAnswer.EXPORT)
    LEAVING[leaving](bottle)
    bottle.session.settings.change(stiffness=0.01)
    person.will(UnsavedAnswer.CANCEL)
    may_end.set()
    qtbot.waitUntil(lambda: len(person.asked) == 2)
    assert not has_left(qtbot, bottle, leaving, before)
    assert person.target.exists()


ASKING = {
    "session": (lambda files: files.save_as(), "ask_where_to_save_session", ("mine.apd", True)),
    "mesh": (lambda files: files.export_mesh(), "ask_where_to_save_mesh", "mine.obj"),
    "scalars": (lambda files: files.export_scalars(), "ask_where_to_save_scalars", ("mine.csv", 0)),
    "deck": (lambda files: files.export_deck(), "ask_where_to_save_deck", "mine.inp"),
}


@pytest.mark.parametrize("what", ASKING)
def test_file_controller_writes_nothing_of_a_mesh_that_comes_while_it_asks(
    qtbot, bottle, tmp_path, monkeypatch, what
):
    ask, dialog, answer = ASKING[what]
    before = bottle.session.store.state

    def choose(*_):
        bottle.session.files.open_sample("duck")
        idle(qtbot, bottle)
        name, *more = answer if isinstance(answer, tuple) else (answer,)
        return (tmp_path / name, *more) if more else tmp_path / name

    monkeypatch.setattr(file_dialogs, dialog, choose)
    ask(bottle.files)
    idle(qtbot, bottle)
    assert bottle.session.store.state.document.mesh is not before.document.mesh
    assert bottle.notice.text == "Another mesh was opened meanwhile; nothing was written."
    assert list(tmp_path.iterdir()) == []


def test_may_discard_work_asks_about_a_dropped_file_too(qtbot, bottle, person, tmp_path):
    paint(bottle.session)
    before = bottle.session.store.state
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(tmp_path / "a.obj"))])
    drop = QDropEvent(QPointF(9, 9), Qt.DropAction.CopyAction, data, LEFT, Qt.KeyboardModifier.NoModifier)
    person.will(UnsavedAnswer.CANCEL)
    bottle.shell.dropEvent(drop)
    qtbot.waitUntil(lambda: person.asked != [])
    assert not has_left(qtbot, bottle, "opening", before)


def test_begin_tour_does_not_begin_a_declined_tour_later(qtbot, bottle, person):
    bottle.shell.requests.open_sample("duck")
    idle(qtbot, bottle)
    paint(bottle.session)
    person.will(UnsavedAnswer.CANCEL)
    bottle.help.begin_tour()
    qtbot.waitUntil(lambda: person.asked != [])
    bottle.session.settings.change(stiffness=0.01)
    idle(qtbot, bottle)
    bottle.session.files.open_sample("bottle")
    idle(qtbot, bottle)
    work_off()
    assert not bottle.help.tour.is_active


# The title


def test_show_title_says_what_is_saved(qtbot, bottle, person, tmp_path):
    shell = bottle.shell
    assert (shell.windowTitle(), shell.isWindowModified()) == ("bottle.obj[*] – APD Viewer", False)
    paint(bottle.session)
    assert shell.isWindowModified()
    bottle.session.gestures.undo()
    assert not shell.isWindowModified()
    bottle.session.gestures.redo()
    person.target = tmp_path / "mine.apd"
    bottle.actions_.file.save.trigger()
    idle(qtbot, bottle)
    assert shell.windowTitle() == "mine.apd[*] – bottle.obj – APD Viewer"
    assert not shell.isWindowModified()
    assert shell.windowFilePath() == str(tmp_path / "mine.apd")
    bottle.session.settings.change(area=101.0)
    assert shell.isWindowModified()


def test_show_title_takes_a_name_like_the_mark_for_no_mark(qtbot, bottle, person, tmp_path):
    person.target = tmp_path / "a[*]b.apd"
    bottle.actions_.file.save.trigger()
    idle(qtbot, bottle)
    assert bottle.shell.windowTitle() == "a[*][*]b.apd[*] – bottle.obj – APD Viewer"
