"""Studies in the window: designed, run, stopped, continued and looked at, with a real mouse and process."""

import csv
import os
import shutil
import sqlite3
from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest
from driving import NONE, Mouse, centre, idle, work_off
from listening import listening
from process_tree import tree_of
from PySide6.QtCore import QPointF, Qt
from PySide6.QtWidgets import QMessageBox
from study_driving import click, finished, press_row, tick

from apd_viewer.cases.case_file import read_case
from apd_viewer.cases.database import DATABASE_NAME
from apd_viewer.cases.study import StudyStore
from apd_viewer.session.model.handle_paths import handle_paths
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.ui.filing import file_controller
from apd_viewer.ui.filing.file_controller import UnsavedAnswer
from apd_viewer.ui.studies.study_run import PLAN_FILE, RUN_FILE, StudyRun

CASES, MANY = 5, 12  # quick ones, and more than are done before a click
CONTROL = Qt.KeyboardModifier.ControlModifier


@pytest.fixture
def studied(qtbot, bar, home):
    """Folder of a finished study, which the first test of results runs."""
    folder = home / "mesh-study"
    if not folder.exists():
        bar.actions_.simulate.study.trigger()
        qtbot.waitExposed(bar.case_studies.dialog)
        begin(bar.case_studies.dialog, folder)
        qtbot.waitUntil(lambda: finished(bar, CASES), timeout=180_000)
    return folder


def test_range_end_preview_shows_an_end_and_leaves_no_trace(qtbot, bar, dialog):
    session = bar.session
    before, undo = session.store.state, session.gestures.history.next_undo_name
    row = dialog.varied.rows["to"]
    assert row.is_checked  # the motion as it stands is offered first
    for field, angle in ((row.low, 8.0), (row.high, 80.0)):
        Mouse(field).press(centre(field))
        field.setFocus()
        qtbot.waitUntil(field.hasFocus)
        pose = session.store.state.document.handles[0].pose
        turned = np.degrees(np.arccos((np.trace(pose[:3, :3]) - 1.0) / 2.0))
        assert turned == pytest.approx(angle, abs=1e-6)
        idle(qtbot, bar)
    assert len(bar.motion_preview.ghost.patches.vertices)
    dialog.start.setFocus()
    qtbot.waitUntil(lambda: not row.high.hasFocus())
    assert session.store.state is before
    assert session.gestures.history.next_undo_name == undo
    assert not len(bar.motion_preview.ghost.patches.vertices)


def test_varied_fields_put_a_typed_motion_in_place_of_the_current_one(dialog):
    rows = dialog.varied.rows
    tick(rows["twist"].check)
    assert rows["twist"].is_checked
    assert not rows["to"].is_checked
    tick(rows["to"].check)
    assert not rows["twist"].is_checked
    assert not rows["twist"].low.isEnabled()


def test_plan_dialog_says_how_many_cases_a_grid_makes(dialog):
    tick(dialog.varied.rows["stiffness"].check)
    dialog.design.setCurrentIndex(dialog.design.findData("grid"))
    dialog.samples.setValue(4)
    assert dialog.count.text() == "= 16 cases,"
    stiffness = dialog.varied.rows["stiffness"]
    for end in ("", stiffness.low.text()):  # one value
        stiffness.high.setText(end)
        assert dialog.count.text() == "= 4 cases,"


@pytest.mark.parametrize(
    ("name", "low", "high", "words"),
    [
        ("to", "50", "20", "swap its ends"),
        ("to", "-5%", "100%", "out of range"),
        ("to", "10%", "1e9%", "out of range"),
        ("area", "95%", "1e6%", "out of range"),
        ("stiffness", "0", "1", "above 0"),
        ("twist", "much", "90deg", "Twist: "),
        ("push", "10%", "1", "both ends"),
    ],
)
def test_plan_dialog_refuses_an_impossible_range_in_a_sentence(dialog, home, name, low, high, words):
    before = sorted(home.iterdir())
    row = dialog.varied.rows[name]
    row.check.setChecked(True)
    row.low.setText(low)
    row.high.setText(high)
    click(dialog.start)
    assert words in dialog.message.text()
    assert dialog.isVisible()
    assert sorted(home.iterdir()) == before


def test_plan_dialog_leaves_a_folder_in_use_alone(dialog, home):
    taken = home / "taken"
    taken.mkdir()
    (taken / "session.apd").write_bytes(b"of somebody")
    dialog.folder.setText(str(taken))
    click(dialog.start)
    assert "in use" in dialog.message.text()
    assert dialog.isVisible()
    assert [path.read_bytes() for path in taken.iterdir()] == [b"of somebody"]


def begin(dialog, folder, count=CASES):
    """Have a study of so many cases run, by one process."""
    dialog.design.setCurrentIndex(dialog.design.findData("grid"))
    dialog.samples.setValue(count)
    dialog.steps.setValue(2)
    dialog.engine.processes.setValue(1)
    dialog.folder.setText(str(folder))
    click(dialog.start)


@pytest.mark.night
def test_case_study_controller_runs_a_study(qtbot, bar, dialog, home):
    cases, studied = bar.case_studies, home / "mesh-study"
    shutil.rmtree(studied, ignore_errors=True)  # of a test before
    begin(dialog, studied)
    panel = cases.panel
    assert cases.dialog is None
    assert bar.docks["study"].isVisible()
    qtbot.waitUntil(lambda: (panel.status.finished_fraction or 0.0) > 0.0, timeout=180_000)
    assert panel.bar.isVisible()
    assert listening([os.getpid(), *tree_of(cases.run.command.process_id)]) == []
    qtbot.waitUntil(lambda: finished(bar, CASES), timeout=180_000)
    assert f"{CASES} of {CASES} done" in panel.message.text()
    assert not panel.bar.isVisible()
    with (studied / PLAN_FILE).open(encoding="utf-8") as stream:
        assert [line["to"] for line in csv.DictReader(stream)][:: CASES - 1] == ["10%", "100%"]


def test_case_study_controller_stops_at_the_next_case_and_goes_on(qtbot, bar, dialog, home, monkeypatch):
    """The command is in its process by night; that it ends and goes on so is tested with the command."""
    panel, command = bar.case_studies.panel, bar.case_studies.run.command
    started, ended, interrupted = [], [], []
    monkeypatch.setattr(type(command), "is_running", property(lambda _: len(started) > len(ended)))
    monkeypatch.setattr(command, "start", started.append)
    monkeypatch.setattr(command, "interrupt", lambda: interrupted.append(1) or True)
    begin(dialog, home / "stopped")
    said = {"finished": 3, "running": 1, "failed": 0, "rate": 1.0, "seconds_left": 9.0}
    command.reported.emit({"cases": CASES} | said | {"finished": 0, "rate": None, "seconds_left": None})
    assert panel.message.text().endswith("1 running, 0 s so far"), "nothing can be foretold yet"
    command.reported.emit({"cases": CASES} | said)
    assert panel.message.text().endswith("9 s left")
    click(panel.stop)
    assert panel.stop.text() == "Stop now"
    assert interrupted == [1]
    ended.append(1)
    command.failed.emit("Interrupted.")
    assert "the finished cases are kept" in panel.message.text()
    qtbot.waitUntil(panel.go_on.isVisible)
    assert not panel.stop.isVisible()
    click(panel.go_on)
    assert started == [started[0]] * 2, "the same command goes on"
    ended.append(1)
    command.ended.emit("")


@pytest.mark.night
def test_case_study_controller_runs_stops_and_continues_a_study(qtbot, bar, dialog, home):
    folder = home / "continued"
    begin(dialog, folder, MANY)
    cases = bar.case_studies
    panel = cases.panel
    qtbot.waitUntil(lambda: (panel.status.finished_fraction or 0.0) > 0.0, timeout=180_000)
    click(panel.stop)
    assert panel.stop.text() == "Stop now"
    qtbot.waitUntil(lambda: not cases.run.is_running, timeout=180_000)
    assert "the finished cases are kept" in panel.message.text()
    qtbot.waitUntil(panel.go_on.isVisible)
    assert not panel.stop.isVisible()
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*.case")}
    assert 1 <= len(before) < MANY
    click(panel.go_on)
    qtbot.waitUntil(lambda: finished(bar, MANY), timeout=180_000)
    assert {path: path.stat().st_mtime_ns for path in before} == before
    assert f"{MANY} of {MANY} done" in panel.message.text()
    assert not panel.bar.isVisible()


def test_case_study_controller_asks_about_a_scheduler_that_a_folder_names(bar, studied, monkeypatch):
    """It could be anybody's, and runs what it likes here."""
    cases, asked = bar.case_studies, []
    options = (studied / RUN_FILE).read_text(encoding="utf-8")
    (studied / RUN_FILE).write_text('{"options": ["--scheduler", "tcp://elsewhere:8786"]}', encoding="utf-8")
    monkeypatch.setattr(
        QMessageBox, "question", lambda *words: asked.append(words[2]) or QMessageBox.StandardButton.Cancel
    )
    cases.open_study(studied)
    cases.panel.continue_requested.emit()
    (studied / RUN_FILE).write_text(options, encoding="utf-8")
    assert not cases.run.is_running
    assert len(asked) == 1
    assert "tcp://elsewhere:8786" in asked[0]


@pytest.fixture
def results(qtbot, bar, studied):
    """The panel on the finished study."""
    cases = bar.case_studies
    cases.open_study(studied)
    qtbot.waitUntil(lambda: finished(bar, CASES))
    qtbot.waitUntil(lambda: cases.panel.table.width() > 200)
    return cases.panel


def test_case_study_controller_opens_the_shape_of_a_clicked_case_bit_for_bit(qtbot, bar, results, studied):
    whole = bar.session.store.state.document
    camera = bar.canvas.view.saved_view("").camera
    press_row(results, 2)
    idle(qtbot, bar)
    qtbot.waitUntil(lambda: bar.session.store.state.document.mesh is not whole.mesh)
    state, found = bar.session.store.state, results.model.rows[2]
    np.testing.assert_array_equal(state.frame.U, read_case(studied, found.key, with_shape=True).U)
    part = float(found.cells[results_column(studied, "to")].removesuffix("%")) / 100.0
    np.testing.assert_allclose(
        state.document.handles[0].pose, handle_paths(whole)[0].pose_at(part), atol=1e-12
    )
    assert not bar.session.saved_work.is_unsaved
    title = bar.shell.windowTitle()
    assert title.startswith(f"{100.0 * part:g}"), "named by what the plan varies"
    assert f" of {studied.name}[*] – " in title
    assert results.model.row_name(2).endswith(title.split(f" of {studied.name}")[0])
    assert bar.canvas.view.saved_view("").camera == camera


def results_column(folder, name):
    with (folder / PLAN_FILE).open(encoding="utf-8") as stream:
        return next(csv.reader(stream)).index(name)


def test_results_view_opens_the_current_case_by_enter_of_either_kind(qtbot, bar, results):
    opened = []
    results.table.case_opened.connect(opened.append)
    results.table.setCurrentIndex(results.model.index(3, 0))
    for key, kind in ((Qt.Key.Key_Return, NONE), (Qt.Key.Key_Enter, Qt.KeyboardModifier.KeypadModifier)):
        qtbot.keyClick(results.table, key, kind)
        idle(qtbot, bar)
    results.table.case_opened.disconnect(opened.append)
    assert opened == [3, 3]


@pytest.mark.night
def test_case_study_controller_asks_about_work_that_is_not_in_the_study_before_opening_a_case(
    qtbot, bar, dialog, home, monkeypatch
):
    begin(dialog, home / "asked", 2)
    results = bar.case_studies.panel
    qtbot.waitUntil(lambda: finished(bar, 2), timeout=180_000)
    asked, own = [], bar.session.store.state.document
    assert bar.session.saved_work.is_unsaved
    monkeypatch.setattr(
        file_controller, "ask_before_leaving", lambda *_: asked.append(1) or UnsavedAnswer.CANCEL
    )
    press_row(results, 1)
    idle(qtbot, bar)
    assert asked == [], "it is saved with the study"
    bar.session.gestures.undo()
    assert bar.session.store.state.document is own
    bar.session.handles.move_by(MOTIONS["TWIST"], "5deg", 0)
    before = bar.session.store.state.document
    press_row(results, 1)
    work_off()
    assert asked == [1]
    assert bar.session.store.state.document is before


def test_results_panel_opens_the_case_of_a_clicked_dot_and_adds_curves_by_control(qtbot, bar, results):
    results.table.clearSelection()
    view = results.scatter.view
    view.repaint()
    places = view.dot_positions()
    assert len(places) == CASES
    opened = bar.session.store.state.document.mesh
    mouse = Mouse(view)
    mouse.move(QPointF(*places[2]))
    mouse.press(QPointF(*places[2]))
    mouse.release(QPointF(*places[2]))
    assert results.table.chosen_rows == [2]
    idle(qtbot, bar)
    qtbot.waitUntil(lambda: bar.session.store.state.document.mesh is not opened)
    last = CASES - 1
    press_row(results, last, CONTROL)
    assert results.table.chosen_rows == [2, last]
    chart = results.curves.view.chart()
    assert [len(curve.x) for curve in chart.curves] == [3, 3]
    assert chart.curves[1].x[-1] == pytest.approx(100.0)
    rings = dict(view.rings)
    assert [rings[2], rings[last]] == [curve.color for curve in chart.curves]
    results.table.choose_rows([last])
    assert results.curves.view.chart().curves[0].color == rings[last], "a case keeps its colour"


def test_results_view_sorts_rows_by_a_click_and_keeps_them_chosen(results):
    results.table.choose_rows([3])
    head = results.table.horizontalHeader()
    column = next(k for k, each in enumerate(results.model.columns) if each.name == "energy")
    at = QPointF(head.sectionViewportPosition(column) + head.sectionSize(column) / 2, head.height() / 2)
    results.table.horizontalScrollBar().setValue(0)
    mouse = Mouse(head.viewport())
    energies = results.model.columns[column].values
    for way in (1, -1):
        mouse.move(at)
        mouse.press(at)
        mouse.release(at)
        assert (np.diff(way * energies[results.model.order]) >= 0).all()
        assert results.table.chosen_rows == [3]
    results.table.sortByColumn(0, Qt.SortOrder.AscendingOrder)


def test_folder_watch_follows_a_study_that_runs_elsewhere_and_never_locks_it(qtbot, results, studied):
    store = StudyStore(studied)  # raises where another holds it
    try:
        with closing(sqlite3.connect(studied / DATABASE_NAME, timeout=0.0)) as base:
            row = base.execute("select * from cases limit 1").fetchone()
            base.execute("delete from cases where key = ?", row[:1])
            base.commit()
            qtbot.waitUntil(lambda: f"{CASES - 1} of {CASES} done" in results.message.text())
            failed = (*row[:2], "failed", "It diverged in step 2.", None, "{}")
            base.execute(f"insert into cases values ({','.join('?' * len(row))})", failed)
            base.commit()
            qtbot.waitUntil(lambda: "1 failed" in results.message.text())
            [place] = [k for k, each in enumerate(results.model.rows) if each.status == "failed"]
            assert results.model.columns[-1].texts[place] == "It diverged in step 2."
            assert len(results.scatter.view.chart().dots.crosses) == 1
            base.execute("insert or replace into cases values (?, ?, ?, ?, ?, ?)", row)
            base.commit()
    finally:
        store.close()
    qtbot.waitUntil(lambda: "failed" not in results.message.text())


def test_case_study_controller_says_why_a_case_failed_in_place_of_a_shape(qtbot, bar, results):
    rows = results.model.rows
    bad = replace(rows[0], status="failed", sentence="It diverged in step 2.")
    results.model.rows = (bad, *rows[1:])
    before = bar.session.store.state
    press_row(results, 0)
    assert "It diverged in step 2." in bar.notice.text
    assert bar.session.store.state is before
    results.model.rows = rows


def test_case_study_controller_refuses_a_folder_without_a_study(bar, tmp_path):
    bar.case_studies.open_study(tmp_path)
    assert "contains no study" in bar.notice.text


@pytest.fixture
def failed(qtbot, bar, results, studied):
    """The key of a case of which the folder and the panel say that it failed."""
    assert not results.retry.isVisible()
    told = "update cases set status = ?, sentence = ? where key = ?"
    with closing(sqlite3.connect(studied / DATABASE_NAME)) as base:
        [key] = base.execute("select key from cases order by rowid limit 1 offset 2").fetchone()
        base.execute(told, ("failed", "It diverged.", key))
        base.commit()
    bar.case_studies.open_study(studied)  # or it would seem to be run elsewhere just now
    qtbot.waitUntil(results.retry.isVisible)
    yield key
    with closing(sqlite3.connect(studied / DATABASE_NAME)) as base:
        base.execute(told, ("done", "", key))
        base.commit()


def test_case_study_controller_asks_for_failed_cases_again(bar, results, failed, studied, monkeypatch):
    asked, command = [], bar.case_studies.run.command
    monkeypatch.setattr(command, "start", asked.append)
    assert not results.go_on.isVisible()
    click(results.retry)
    command.ended.emit("")
    [words] = asked
    assert words[:2] == ["study", str(studied / PLAN_FILE)]
    assert "--retry-failed" in words


@pytest.mark.night
def test_case_study_controller_runs_failed_cases_again_by_a_click(qtbot, results, failed, studied):
    before = {path: path.stat().st_mtime_ns for path in studied.rglob("*.case")}
    click(results.retry)
    qtbot.waitUntil(lambda: "failed" not in results.message.text(), timeout=180_000)
    qtbot.waitUntil(lambda: [row.status for row in results.model.rows] == ["done"] * CASES, timeout=180_000)
    changed = [path.stem for path, when in before.items() if path.stat().st_mtime_ns != when]
    assert changed == [failed]
    assert not results.retry.isVisible()


def test_results_panel_leaves_most_of_the_window_to_the_mesh(bar, results):
    assert bar.shell.height() > 600
    assert results.height() < 0.34 * bar.shell.height()


def test_ask_before_closing_keeps_the_window_open_over_a_running_study(bar, monkeypatch):
    asked = []
    monkeypatch.setattr(StudyRun, "is_running", True)
    monkeypatch.setattr(
        QMessageBox, "question", lambda *said: asked.append(said[2]) or QMessageBox.StandardButton.Cancel
    )
    bar.shell.close()
    assert not bar.shell.is_closed
    assert "Finished cases are kept" in asked[0]
