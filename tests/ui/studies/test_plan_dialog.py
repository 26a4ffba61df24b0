"""Methods, limits and schedulers in the dialog of a study."""

import csv
import re
import socket
import time
from contextlib import closing
from importlib.util import find_spec

import pytest
from dask_cluster import address_in, dask_cluster
from driving import idle, work_off
from study_driving import click, finished, press_row, tick

from apd_viewer.cases.case_file import read_case
from apd_viewer.cases.local_pool import core_count
from apd_viewer.errors import InputError
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.ui.studies.engine_fields import SchedulerCheck, host_and_port
from apd_viewer.ui.studies.study_run import PLAN_FILE, RUN_FILE, scheduler_option, stored_options


@pytest.fixture
def begun(dialog):
    """What is begun, instead of being run."""
    found = []
    dialog.study_designed.disconnect()
    dialog.study_designed.connect(lambda folder, options: found.append((folder, options)))
    return found


@pytest.fixture
def listener():
    """A place on this machine where somebody answers."""
    with closing(socket.create_server(("127.0.0.1", 0))) as server:
        yield f"tcp://127.0.0.1:{server.getsockname()[1]}"


@pytest.fixture
def deserted():
    """A place on this machine where nobody answers."""
    with closing(socket.create_server(("127.0.0.1", 0))) as server:
        place = server.getsockname()
    return f"tcp://127.0.0.1:{place[1]}"


def rows_of(folder):
    with (folder / PLAN_FILE).open(encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def ask_scheduler(dialog, address):
    dialog.engine.where.setCurrentIndex(1)
    dialog.engine.address.setText(address)
    click(dialog.start)


def test_plan_dialog_estimates_the_time_of_the_cases_from_the_shape_that_was_solved(qtbot, bar):
    def said():
        bar.actions_.simulate.study.trigger()
        dialog = bar.case_studies.dialog
        dialog.samples.setValue(1000)
        dialog.engine.processes.setValue(1)
        return dialog, dialog.message.text()

    state = bar.session.store.state
    bar.session.files.open_result("mesh", lambda: state)
    idle(qtbot, bar)
    dialog, opened = said()
    assert opened == "", "the pace of a shape that was only opened is not known"
    dialog.close()
    bar.session.handles.move_by(MOTIONS["TWIST"], "10deg", 0)
    idle(qtbot, bar)
    dialog, solved = said()
    pattern = r"Roughly (\d)0* (s|min|h)( 0 min)?, if each step takes as long as the shape on screen did\."
    digit, unit, _ = re.fullmatch(pattern, solved).groups()
    seconds = bar.session.store.state.frame.iteration * bar.session.store.seconds_per_iteration
    exact = 1000 * 10 * seconds / {"s": 1, "min": 60, "h": 3600}[unit]
    assert f"{exact:.1g}"[0] == digit
    dialog.steps.setValue(1)
    assert dialog.message.text() != solved
    dialog.engine.where.setCurrentIndex(1)
    assert dialog.message.text() == ""


def test_plan_dialog_varies_ticked_methods(dialog, begun, tmp_path):
    checks = dialog.methods.checks
    assert [name for name, check in checks.items() if check.isChecked()] == ["exact"]
    tick(checks["arap"])
    dialog.design.setCurrentIndex(dialog.design.findData("grid"))
    dialog.samples.setValue(3)
    assert dialog.count.text() == "= 6 cases,"
    dialog.folder.setText(str(tmp_path / "methods"))
    click(dialog.start)
    rows = rows_of(tmp_path / "methods")
    assert {(row["to"], row["method"]) for row in rows} == {
        (part, name) for part in ("10%", "55%", "100%") for name in ("exact", "arap")
    }


def test_plan_dialog_tries_methods_alone_once_each(dialog, begun, tmp_path):
    for name in ("local", "paper"):
        tick(dialog.methods.checks[name])
    dialog.varied.rows["to"].high.clear()  # the whole of it
    dialog.folder.setText(str(tmp_path / "once"))
    click(dialog.start)
    assert sorted(row["method"] for row in rows_of(tmp_path / "once")) == ["exact", "local", "paper"]


def test_plan_dialog_takes_another_method_for_all(dialog, begun, tmp_path):
    for name in ("exact", "arap"):
        tick(dialog.methods.checks[name])
    dialog.samples.setValue(2)
    dialog.folder.setText(str(tmp_path / "one"))
    click(dialog.start)
    assert [row["method"] for row in rows_of(tmp_path / "one")] == ["arap", "arap"]


def test_plan_dialog_needs_some_method(dialog):
    tick(dialog.methods.checks["exact"])
    click(dialog.start)
    assert "No method is ticked" in dialog.message.text()
    assert dialog.isVisible()


def test_engine_fields_hand_a_limit_to_the_command(dialog, begun, tmp_path):
    dialog.folder.setText(str(tmp_path / "limited"))
    dialog.engine.processes.setValue(2)
    for text, words in (("soon", "soon"), ("0", "greater than 0"), ("-3", "greater than 0")):
        dialog.engine.limit.setText(text)
        click(dialog.start)
        assert words in dialog.message.text()
        assert not begun
    dialog.engine.limit.setText("2.5")
    click(dialog.start)
    assert begun == [(tmp_path / "limited", ["--processes", "2", "--limit", "2.5"])]


def test_engine_fields_hand_the_options_of_a_scheduler_to_the_command(
    qtbot, dialog, begun, listener, tmp_path
):
    dialog.folder.setText(str(tmp_path / "cluster"))
    ask_scheduler(dialog, "")
    assert "tcp://host:8786" in dialog.message.text()
    ask_scheduler(dialog, listener)
    qtbot.waitUntil(lambda: bool(begun))
    assert begun == [(tmp_path / "cluster", ["--scheduler", listener])]
    assert (tmp_path / "cluster" / PLAN_FILE).exists()


def test_plan_dialog_begins_what_was_asked_for_whatever_is_typed_meanwhile(
    qtbot, dialog, begun, listener, tmp_path
):
    """Not what is typed while the scheduler is waited for: nobody has looked whether that is there."""
    dialog.folder.setText(str(tmp_path / "asked"))
    dialog.samples.setValue(4)
    ask_scheduler(dialog, listener)
    dialog.engine.address.setText("elsewhere")
    dialog.folder.setText("")
    dialog.samples.setValue(5)
    qtbot.waitUntil(lambda: bool(begun))
    assert begun == [(tmp_path / "asked", ["--scheduler", listener])]
    assert len(rows_of(tmp_path / "asked")) == 4


def test_plan_dialog_takes_a_tilde_for_the_folder_of_the_user(
    qtbot, dialog, begun, listener, tmp_path, monkeypatch
):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("USERPROFILE", str(tmp_path))
    (tmp_path / "lab.json").write_text(f'{{"address": "{listener}"}}', encoding="utf-8")
    dialog.folder.setText("~/tilde")
    ask_scheduler(dialog, "~/lab.json")
    qtbot.waitUntil(lambda: bool(begun))
    assert begun == [(tmp_path / "tilde", ["--scheduler-file", str(tmp_path / "lab.json")])]


def test_plan_dialog_knows_no_folder_of_a_user_who_is_not_there(dialog, begun, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    dialog.folder.setText("~nobody of this name/study")
    ask_scheduler(dialog, "~nobody of this name/lab.json")
    assert "There is no file" in dialog.message.text()
    dialog.engine.where.setCurrentIndex(0)
    click(dialog.start)
    assert begun[0][0] == tmp_path / "~nobody of this name" / "study"


def test_plan_dialog_says_within_seconds_that_nobody_is_at_an_address(
    qtbot, dialog, begun, deserted, tmp_path
):
    dialog.folder.setText(str(tmp_path / "deserted"))
    started = time.monotonic()
    ask_scheduler(dialog, deserted)
    qtbot.waitUntil(lambda: "No scheduler answers" in dialog.message.text())
    assert time.monotonic() - started < 6.0
    assert deserted in dialog.message.text()
    assert not (tmp_path / "deserted").exists()
    dialog.engine.where.setCurrentIndex(0)
    click(dialog.start)
    assert begun[0][0] == tmp_path / "deserted"


def test_scheduler_check_gives_up_a_silent_address(qtbot, listener):
    check, said = SchedulerCheck(), []
    check.answered.connect(lambda: said.append("answered"))
    check.failed.connect(said.append)
    check.begin(listener)
    check.timer.timeout.emit()  # before it was heard
    work_off()
    assert len(said) == 1
    assert "no answer within 5 seconds" in said[0]
    assert not check.is_waiting


def test_plan_dialog_may_be_closed_while_it_connects(qtbot, bar, dialog, begun, listener, tmp_path):
    dialog.folder.setText(str(tmp_path / "given up"))
    ask_scheduler(dialog, listener)
    click(dialog.cancel)
    work_off()
    assert not begun
    assert bar.case_studies.dialog is None


@pytest.mark.parametrize(
    ("address", "place"),
    [
        ("tcp://lab:8786", ("lab", 8786)),
        ("lab:1", ("lab", 1)),
        ("tls://[::1]:8786", ("::1", 8786)),
        ("tcp://lab", None),
        ("lab", None),
        ("tcp://:8786", None),
        ("tcp://lab:x", None),
        ("tcp://lab:99999", None),
        ("http://lab:80", None),
    ],
)
def test_host_and_port_reads_addresses_as_dask_does(address, place):
    if place is None:
        with pytest.raises(InputError, match="not a scheduler address"):
            host_and_port(address)
    else:
        assert host_and_port(address) == place


def test_host_and_port_reads_the_address_in_the_file_of_a_scheduler(tmp_path):
    file = tmp_path / "scheduler.json"
    with pytest.raises(InputError, match="There is no file"):
        host_and_port(str(file))
    for odd in ("", "[]", "{}", '{"address": 3}'):
        file.write_text(odd, encoding="utf-8")
        with pytest.raises(InputError, match="not a scheduler address"):
            host_and_port(str(file))
    file.write_text('{"address": "tcp://10.0.0.7:8786"}', encoding="utf-8")
    assert host_and_port(str(file)) == ("10.0.0.7", 8786)


def test_stored_options_let_a_folder_give_the_command_no_others(tmp_path):
    """It may come from anybody."""
    for odd in ('["-o", "/elsewhere"]', '["--processes"]', '["--scheduler=tcp://x:1", "2"]', '"--limit"'):
        (tmp_path / RUN_FILE).write_text(f'{{"options": {odd}}}', encoding="utf-8")
        assert stored_options(tmp_path) == []
    (tmp_path / RUN_FILE).write_text('{"options": ["--limit", "9", "--processes", "900"]}', encoding="utf-8")
    assert stored_options(tmp_path) == ["--limit", "9", "--processes", str(core_count())], (
        "it is of a larger machine"
    )
    (tmp_path / RUN_FILE).write_text(
        '{"options": ["--limit", "9", "--scheduler", "tcp://x:1"]}', encoding="utf-8"
    )
    assert scheduler_option(stored_options(tmp_path)) == "tcp://x:1"


@pytest.mark.skipif(find_spec("distributed") is not None, reason="Dask is installed, whose lack is tested")
def test_study_run_refuses_a_study_by_dask_where_that_is_missing(qtbot, bar, dialog, home, listener):
    dialog.folder.setText(str(home / "without-dask"))
    ask_scheduler(dialog, listener)
    with qtbot.waitSignal(bar.case_studies.run.ended, timeout=60_000):
        qtbot.waitUntil(lambda: bar.case_studies.run.is_running)
    assert "install apd-viewer[cluster]" in bar.case_studies.panel.message.text()


@pytest.mark.extra
def test_study_run_runs_a_study_by_a_scheduler_of_dask(qtbot, bar, dialog, home, tmp_path):
    """A real one, with one worker, by its address; then a click opens a case."""
    folder = home / "by-dask"
    with dask_cluster(tmp_path, 1) as file:
        dialog.design.setCurrentIndex(dialog.design.findData("grid"))
        dialog.samples.setValue(3)
        dialog.steps.setValue(2)
        dialog.folder.setText(str(folder))
        ask_scheduler(dialog, address_in(file))
        qtbot.waitUntil(lambda: bar.case_studies.run.is_running)
        qtbot.waitUntil(lambda: finished(bar, 3), timeout=150_000)
    panel = bar.case_studies.panel
    assert "3 of 3 done" in panel.message.text()
    before = bar.session.store.state.document.mesh
    press_row(panel, 1)
    idle(qtbot, bar)
    qtbot.waitUntil(lambda: bar.session.store.state.document.mesh is not before)
    found = read_case(folder, panel.model.rows[1].key, with_shape=True)
    assert bar.session.store.state.frame.U.tobytes() == found.U.tobytes()
