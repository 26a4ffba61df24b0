"""What a file, a session, a name or a path says is shown as it is, by every widget that shows it."""

import json
import re
import sqlite3
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from answering import once_asked
from driving import idle, show, work_off
from finished_study import write_study
from meshes import ends, sphere
from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtGui import QHelpEvent
from PySide6.QtWidgets import QAbstractButton, QApplication, QDockWidget, QLabel, QTabBar, QTextEdit, QToolTip
from shiboken6 import isValid
from watched_pipe import WatchedPipe

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.handles_and_regions import NamedRegion
from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.view import View
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.storage.recovery_file import claim_path
from apd_viewer.session.storage.session_file import save_session
from apd_viewer.ui.filing import file_controller, file_dialogs
from apd_viewer.ui.filing.file_controller import UnsavedAnswer
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.tools.tool_modes import Tool
from apd_viewer.ui.widgets.display_names import distinct_names
from apd_viewer.ui.workbench import Workbench

ASK = file_controller.ask_before_leaving  # before the fixture of the window answers by itself
PIPE = "picture"
# Qt reads this as HTML, with a picture from the working folder; it has both signs of Qt's own for texts, too.
NAME = f"<b>x<img src={PIPE}>&y[*]"
SIGN = f"<img src={PIPE}>"
DIALOGS = "SweepDialog", "AnimationDialog", "PressDialog", "PlanDialog", "ComparisonWindow"


@pytest.fixture
def window(kept_window):
    """The window of all tests of this file."""
    return kept_window


class Looker:
    """Looks at all widgets that there are, and notes where they show the name."""

    def __init__(self):
        self.seen = set()

    def look(self):
        widgets = QApplication.allWidgets()
        for widget in filter(isValid, widgets):  # to hover deletes tips
            self._look_at(widget)
        for action in {action for widget in filter(isValid, widgets) for action in widget.actions()}:
            self._whole(action.text(), "an action")
            self._whole(action.toolTip(), "the tip of an action", menu=False)

    def _look_at(self, widget):
        widget.ensurePolished()  # as whatever is shown has been
        kind = type(widget).__name__
        if isinstance(widget, QLabel):
            self._look_at_label(widget, kind)
        elif isinstance(widget, QAbstractButton):
            own = type(widget).__module__.startswith("apd_viewer") and "paintEvent" in type(widget).__dict__
            self._whole(widget.text(), kind, menu=not own)
        elif isinstance(widget, QDockWidget):
            self._whole(widget.windowTitle(), kind)
        elif isinstance(widget, QTabBar):
            for k in range(widget.count()):
                self._whole(widget.tabText(k), kind)
        elif isinstance(widget, QTextEdit):
            assert SIGN not in widget.toPlainText() or widget.toPlainText() == widget.toHtml(), kind
        if widget.isWindow() and widget.windowHandle() is not None and SIGN in widget.windowTitle():
            assert NAME in widget.windowHandle().title(), widget.windowTitle()
            self.seen.add(f"the title of a {kind}")
        if SIGN in widget.toolTip():
            self.seen.add("a tip")
            self.hover(widget)

    def _look_at_label(self, label, kind):
        assert label.textFormat() is not Qt.TextFormat.AutoText, f"{kind} {label.text()!r} is guessed"
        if SIGN in label.text():
            assert label.textFormat() is Qt.TextFormat.PlainText, f"{kind} {label.text()!r}"
            self.seen.add(f"{kind} {label.parentWidget().objectName() if label.parentWidget() else ''}")
            if label.buddy() is not None:
                self._whole(label.text(), kind)

    def _whole(self, text, kind, menu=True):
        if SIGN not in text:
            return
        shown = re.sub("&(.)", r"\1", text) if menu else text
        assert NAME.partition("[")[0] in shown, f"{kind} shows {shown!r}"
        self.seen.add(kind)

    def hover(self, widget):
        at = QPoint(1, 1)
        QApplication.sendEvent(widget, QHelpEvent(QEvent.Type.ToolTip, at, widget.mapToGlobal(at)))
        for tip in tips():
            assert tip.textFormat() is Qt.TextFormat.PlainText
        QToolTip.hideText()


def tips():
    return [w for w in QApplication.allWidgets() if w.metaObject().className() == "QTipLabel"]


@pytest.fixture
def pipe(tmp_path, monkeypatch):
    """What the name would have Qt open, and wait for."""
    monkeypatch.chdir(tmp_path)
    pipe = WatchedPipe(tmp_path / PIPE)
    yield pipe
    pipe.close()
    assert not pipe.opened


@pytest.fixture
def looker(pipe):
    return Looker()


@pytest.fixture
def named(tmp_path):
    """A state whose mesh, parts, obstacles and poses have the name."""
    V, F = sphere(2)
    path = tmp_path / f"{NAME}.off"
    save_mesh(Mesh(V, F), V, path)
    labels = np.ones(len(V), dtype=np.uint8)
    labels[ends(V)[0]], labels[ends(V)[1]] = 0, 2
    state = initial_state(open_mesh(path), labels)
    document = state.document
    handle = replace(document.handles[0], name=NAME)
    ball = NamedObstacle(NAME, ObstacleKind.SPHERE, np.array([0.0, 0.0, 3.0]), radius=0.5)
    document = replace(
        document,
        handles=(handle, replace(handle, name=f"{NAME}2")),
        regions=(NamedRegion(NAME),),
        obstacles=(ball,),
    )
    return state.updated(document)


@pytest.fixture
def session(tmp_path, named):
    """Its session, with the mesh in it."""
    path = tmp_path / f"{NAME}.apd"
    save_session(path, named, View(), embed=True)
    return path


@pytest.fixture
def here(qtbot, window, session):
    """A window on it."""
    window.session.files.open(session)
    idle(qtbot, window)
    return window


def edited(session, **members):
    """Change what the session says."""
    with zipfile.ZipFile(session) as archive:
        kept = {name: archive.read(name) for name in archive.namelist()}
    said = json.loads(kept["session.json"])
    for name, value in members.items():
        said[name] = {**said[name], **value} if said.get(name) else value
    kept["session.json"] = json.dumps(said).encode()
    with zipfile.ZipFile(session, "w") as archive:
        for name, content in kept.items():
            archive.writestr(name, content)


def asked(looker, ask):
    """Look at a question while it is asked, and take it back."""

    def answer():
        try:
            looker.look()
        finally:
            QApplication.activeModalWidget().reject()

    once_asked(answer)
    return ask()


def test_workbench_shows_what_a_session_says_as_it_is(qtbot, here, looker):
    for dock in ("history", "plots", "study"):
        here.docks[dock].show()
    for tool in Tool:
        here.tools.choose_tool(tool)
        looker.look()
    here.poses.keep_pose()
    here.session.poses.rename(0, NAME)
    here.session.poses.go_to_pose(0)
    here.session.handles.move_by(MOTIONS["TWIST"], "3", 0)
    idle(qtbot, here)
    looker.look()
    here.help.toggle_search()
    here.help.search.search.setText(NAME)
    looker.look()
    assert {"a tip", "an action", "the title of a Shell"} <= looker.seen


@pytest.mark.night
def test_workbench_dialogs_show_what_a_session_says_as_it_is(qtbot, here, looker):
    here.session.handles.move_by(MOTIONS["TWIST"], "3", 0)
    idle(qtbot, here)
    for open_dialog in (
        here.runs.open_sweep,
        here.runs.open_animation,
        here.runs.open_press,
        here.runs.open_paper,
        here.runs.open_verification,
        here.case_studies.design_study,
        here.comparison.open,
        here.settings_page.open,
        here.help.toggle_sheet,
        here.edits.open_vertex_entry,
    ):
        open_dialog()
        looker.look()
    here.edits.text_entries.vertices.text.setText(NAME)
    dialog = here.case_studies.dialog
    dialog.folder.setText(NAME)
    dialog.engine.where.setCurrentIndex(1)
    dialog.engine.address.setText(NAME)
    dialog.begin()
    work_off()
    looker.look()
    here.panel.handles.motion.amount.setText(NAME)
    here.edits.move_by(MOTIONS["TWIST"], NAME, False)
    work_off()
    looker.look()
    here.comparison.window.close()
    assert looker.seen >= {f"the title of a {kind}" for kind in DIALOGS}


def test_notice_shows_the_path_of_a_missing_mesh_as_it_is(qtbot, window, session, looker, pipe):
    place = f'/no/<img src="{pipe.path}">/&y{SIGN}.off'
    edited(
        session,
        mesh={"name": f"{NAME}2.off", "embedded": None, "path": place, "relative": "x.off", "sample": None},
    )
    window.session.files.open(session)
    idle(qtbot, window)
    assert f'<img src="{pipe.path}">' in window.notice.text
    looker.look()
    assert "QLabel notice" in looker.seen


def test_target_section_and_notice_show_a_missing_target_shape_as_it_is(qtbot, window, session, looker, pipe):
    place = f'/no/<img src="{pipe.path}">/{SIGN}.off'
    told = {"name": f"{NAME}2.off", "vertices": 3, "faces": 1, "digest": "0" * 64, "path": place}
    edited(session, target=told)
    window.session.files.open(session)
    idle(qtbot, window)
    looker.look()
    assert f'<img src="{pipe.path}">' in window.notice.text
    assert {"QLabel notice", "QLabel "} & looker.seen
    assert SIGN in window.panel.target.name.text()


def test_notice_waits_for_nothing_in_a_window_that_is_not_on_the_screen_yet(
    qtbot, settings, looker, pipe, monkeypatch
):
    """A failure may be said before the window is shown, when no style has been asked for yet."""
    monkeypatch.setattr(file_controller, "ask_before_leaving", lambda *_: UnsavedAnswer.DISCARD)
    window = Workbench(Shell(settings))
    for say in (
        window.notice.show_failure,
        window.invitation.show_text,
        window.edits.text_entries.vertices.show_message,
    ):
        say(f'{SIGN}<img src="{pipe.path}">')
    window.edits.text_entries.vertices.open_card()
    show(qtbot, window.shell, window.canvas.viewport)
    looker.look()
    assert {"QLabel notice", "CanvasHint canvas"} & looker.seen
    window.shell.close()
    window.shell.deleteLater()
    work_off()


def test_recovery_bar_shows_what_a_killed_program_left_as_it_is(qtbot, folder, named, started, looker):
    path, lock = claim_path(folder)
    save_session(path, named, View(), embed=True)
    lock.release()
    window = started()
    assert "<b>x<img" in window.recovery.text
    looker.look()


def test_question_shows_names_as_they_are(qtbot, here, session, looker, tmp_path, monkeypatch):
    assert asked(looker, lambda: ASK(here.shell, session.name, True)) is UnsavedAnswer.CANCEL
    assert "QLabel" in " ".join(looker.seen)
    looker.seen.clear()
    chosen = str(tmp_path / NAME), ""
    monkeypatch.setattr(file_dialogs.QFileDialog, "getSaveFileName", lambda *_: chosen)
    mesh = here.session.store.state.document.mesh
    assert asked(looker, lambda: file_dialogs.ask_where_to_save_session(here.shell, tmp_path, mesh)) is None
    assert any(where.startswith("QLabel") for where in looker.seen)
    looker.seen.clear()
    here.case_studies.panel.folder = tmp_path
    (tmp_path / "run.json").write_text(json.dumps({"options": ["--scheduler", NAME]}))
    asked(looker, here.case_studies.panel.continue_requested.emit)
    assert any(where.startswith("QLabel") for where in looker.seen)


def test_show_about_box_shows_the_only_mark_up_that_there_is(qtbot, window):
    found = []

    def look():
        box = QApplication.activeModalWidget()
        found.extend((label.textFormat(), label.text()) for label in box.findChildren(QLabel) if label.text())
        box.reject()

    once_asked(look)
    file_dialogs.show_about_box(window.shell)
    ((form, text),) = found
    assert form is Qt.TextFormat.RichText
    assert "<h3>" in text


def test_results_panel_shows_results_of_a_study_as_they_are(qtbot, window, looker, tmp_path):
    folder = tmp_path / NAME
    write_study(folder, 5)
    base = sqlite3.connect(folder / "study.sqlite")
    base.execute("update facts set value = ?", (json.dumps([NAME, "steps", "motion", "stiffness"]),))
    base.execute("update plan set cells = ?", (json.dumps([NAME, "10", NAME, "1"]),))
    base.commit()
    base.close()
    window.docks["study"].show()
    window.case_studies.open_study(folder)
    qtbot.waitUntil(lambda: bool(window.case_studies.panel.model.rows))
    looker.look()
    window.case_studies.open_study(tmp_path / f"{NAME}2")
    looker.look()
    assert {"Hint heading", "QLabel notice"} & looker.seen
    header = window.case_studies.panel.table.horizontalHeader()
    work_off()
    Looker.hover(looker, header.viewport())


def test_theme_has_a_tip_shown_as_it_is(qtbot, window, pipe):
    text = f'<b>x</b><img src="{pipe.path}">'
    QToolTip.showText(window.shell.mapToGlobal(QPoint(5, 5)), text, window.shell)
    (tip,) = tips()
    assert tip.text() == text
    assert tip.textFormat() is Qt.TextFormat.PlainText
    QToolTip.hideText()


def test_fill_recent_shows_names_of_files_as_they_are_and_tells_them_apart(qtbot, window, looker, tmp_path):
    paths = [tmp_path / folder / f"{NAME}.off" for folder in ("a&b", "c", "c/d", "e/d")]
    window.actions_.file.fill_recent([*paths, tmp_path / "A&B.obj"])
    shown = [re.sub("&(.)", r"\1", action.text()) for action in window.actions_.file.recent.actions()]
    assert shown == [*(f"{NAME}.off – {folder}" for folder in ("a&b", "c", "c/d", "e/d")), "A&B.obj"]
    looker.look()


@pytest.mark.parametrize(
    ("paths", "names"),
    [
        (["/a/x.obj"], ["x.obj"]),
        (["/a/x.obj", "/a/y.obj"], ["x.obj", "y.obj"]),
        (["/a/x.obj", "/b/x.obj", "/b/y.obj"], ["x.obj – a", "x.obj – b", "y.obj"]),
        (["/a/c/x.obj", "/b/c/x.obj"], ["x.obj – a/c", "x.obj – b/c"]),
        (["/a/x.obj", "/b/a/x.obj"], ["x.obj – /a", "x.obj – b/a"]),
        (["/x.obj", "/a/x.obj"], ["x.obj – /", "x.obj – a"]),
    ],
)
def test_distinct_names_tells_files_of_one_name_apart_by_as_little_as_needed(paths, names):
    assert distinct_names([Path(path) for path in paths]) == names
