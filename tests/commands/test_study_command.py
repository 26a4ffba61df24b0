"""The command that runs studies: what it says, what it writes, and how it is interrupted."""

import csv
import json
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import Future

import pytest
from immediate import Here
from lacking import lack
from listening import listening
from painted_meshes import write_bar
from process_tree import tree_of
from study_work import quick

from apd_viewer.__main__ import main
from apd_viewer.cases.results import ResultRow, ResultTable
from apd_viewer.commands.study_command import study_summary


@pytest.fixture
def bar(tmp_path):
    write_bar(tmp_path)
    return tmp_path


def plan_of(folder, motions, steps=2):
    lines = ["mesh,selection,motion,steps,iterations", *(f"bar.off,bar.sel,{m},{steps},20" for m in motions)]
    (folder / "plan.csv").write_text("\n".join(lines) + "\n")
    return str(folder / "plan.csv")


def rows_of(folder):
    with (folder / "results.csv").open(encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def test_study_command_is_planned_run_and_gone_on_with(bar, capsys):
    words = ["study", plan_of(bar, ["twist 30", "twist", "push 10%", "twist 30"]), "-o", str(bar / "out")]
    assert main([*words, "--dry-run"]) == 0
    said = capsys.readouterr()
    assert said.out.splitlines() == [
        "2 cases, 0 of them done, 2 to do",
        "1 row is wrong and is left out",
        "No case was timed yet, so the remaining time is unknown.",
    ]
    assert said.err.splitlines() == [
        "line 3: Column “motion”: Nothing was entered; enter an angle such as 30 or 30deg.",
        "line 5: It repeats line 2.",
    ]
    assert not (bar / "out").exists()
    assert main([*words, "--processes", "1", "--progress-lines"]) == 0
    *lines, last = capsys.readouterr().out.splitlines()
    assert last.endswith("results.csv: 2 done, 1 wrong, 1 duplicate")
    progress = [json.loads(line) for line in lines]
    assert set(progress[0]) == {
        *("done", "doing", "cases", "finished", "running", "failed", "rate", "seconds_left"),
    }
    assert (progress[-1]["done"], progress[-1]["finished"]) == (1.0, 2)
    assert [each["done"] for each in progress] == sorted(each["done"] for each in progress)
    assert [row["status"] for row in rows_of(bar / "out")] == ["done", "wrong", "done", "duplicate"]
    with (bar / "out" / "curves.csv").open(encoding="utf-8") as stream:
        curves = list(csv.DictReader(stream))
    assert [(row["line"], row["step"], row["part"]) for row in curves] == [
        (line, str(step), part) for line in ("2", "4") for step, part in enumerate(("0", "0.5", "1"))
    ]
    plan_of(bar, ["twist 30", "twist 60"])
    before = {path: path.stat().st_mtime_ns for path in bar.rglob("*")}
    assert main([*words, "--dry-run"]) == 0
    assert "2 cases, 1 of them done, 1 to do" in capsys.readouterr().out
    assert {path: path.stat().st_mtime_ns for path in bar.rglob("*")} == before


@pytest.mark.usefixtures("cases_run_here")
def test_study_command_counts_a_failed_case_which_may_be_tried_again(bar, capsys):
    words = ["study", plan_of(bar, ["twist 30"]), "-o", str(bar / "out")]
    assert main([*words, "--processes", "1", "--limit", "1e-9"]) == 0
    assert [row["status"] for row in rows_of(bar / "out")] == ["failed"]
    capsys.readouterr()
    for more, said in (
        ([], ["1 case, 1 done, 0 to do", "failed so far: 1; --retry-failed tries again"]),
        (["--retry-failed"], ["1 case, 0 done, 1 to do"]),
    ):
        assert main([*words, *more, "--dry-run"]) == 0
        assert capsys.readouterr().out.splitlines()[: len(said)] == said


@pytest.mark.usefixtures("cases_run_here")
def test_study_command_computes_a_damaged_result_again_and_keeps_the_others(bar, capsys):
    """As after a fault of a disk, which leaves the size as it is."""
    words = ["study", plan_of(bar, ["twist 30", "push 10%"]), "-o", str(bar / "out"), "--processes", "1"]
    assert main(words) == 0
    tables = rows_of(bar / "out"), (bar / "out" / "curves.csv").read_bytes()
    damaged, other = sorted(bar.glob("out/cases/*/*.case"))
    before, content = other.stat().st_mtime_ns, bytearray(damaged.read_bytes())
    content[len(content) // 2] ^= 0xFF
    damaged.write_bytes(content)
    database = (bar / "out" / "study.sqlite").read_bytes()
    capsys.readouterr()
    for said in ("1 damaged result is computed again\n", ""):
        assert main(words) == 0
        assert capsys.readouterr().err == said
        rows, curves = rows_of(bar / "out"), (bar / "out" / "curves.csv").read_bytes()
        assert [{**row, "seconds": ""} for row in rows] == [{**row, "seconds": ""} for row in tables[0]]
        assert curves == tables[1]
    assert other.stat().st_mtime_ns == before
    (bar / "out" / "study.sqlite").write_bytes(database[:4096] + bytes(len(database) - 4096))
    assert main(words) == 0
    assert rows_of(bar / "out") == rows


def test_study_command_says_what_cannot_be_run(bar, capsys, monkeypatch):
    lack(monkeypatch, "distributed")
    plan = plan_of(bar, ["twist 30"])
    for words, said in (
        (["--limit", "0"], "greater than 0"),
        (["--processes", "0"], "--processes must be 1 to 1000"),
        (["--workers", "1001"], "--processes must be 1 to 1000"),
        (["--scheduler-file", str(bar / "gone.json")], "There is no file"),
        (["--scheduler", "tcp://127.0.0.1:9"], "Dask is not installed; install apd-viewer[cluster]"),
        (["-o", plan], f"The folder {plan}"),
        (["-o", plan, "--dry-run"], f"The folder {plan} cannot be written (Not a directory)"),
    ):
        assert main(["study", plan, "-o", str(bar / "out"), *words]) == 2
        assert said in capsys.readouterr().err
    (bar / "plan.csv").write_text("mesh,colour\na,b\n")
    assert main(["study", plan, "-o", str(bar / "out")]) == 2
    assert "unknown column “colour”" in capsys.readouterr().err


class OneByOne(Here):
    """Runs a case while the runner asks how many are running."""

    def __init__(self, work):
        super().__init__(work)
        self.held = None

    def free_slot_count(self):
        return int(self.held is None)

    def start(self, task):
        self.held = Future(), task
        return self.held[0]

    def running_count(self):
        if self.held is not None:
            future, task = self.held
            future.set_result(self.work(task))
            self.held = None
        return 0


@pytest.mark.parametrize(("times", "done"), [(1, 2), (2, 1)])
def test_study_command_finishes_the_running_case_at_an_interrupt_and_ends_at_once_at_a_second(
    times, done, bar, monkeypatch, capsys
):
    """Signals come while the second of three cases runs."""
    cases = iter(range(3))

    def interrupted(task):
        for _ in range(times if next(cases) == 1 else 0):
            signal.raise_signal(signal.SIGINT)
        return quick(task)

    monkeypatch.setattr("apd_viewer.commands.study_command.LocalPool", lambda _: OneByOne(interrupted))
    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(SystemExit, match="130"):
        main(["study", plan_of(bar, ["twist 1", "twist 2", "twist 3"]), "-o", str(bar / "out")])
    said = capsys.readouterr()
    assert f"{done} done, {3 - done} not done yet" in said.out
    assert "repeat the command to continue" in said.err
    assert [row["status"] for row in rows_of(bar / "out")].count("done") == done
    assert signal.getsignal(signal.SIGINT) == before


@pytest.mark.night
@pytest.mark.skipif(sys.platform == "win32", reason="os.killpg, by which a terminal is imitated, is of POSIX")
def test_study_command_finishes_what_runs_after_an_interrupt_and_ends_at_once_after_a_second(bar):
    plan = plan_of(bar, [f"twist {angle}" for angle in range(1, 400)], steps=9)

    def interrupted(times):
        process = subprocess.Popen(
            [sys.executable, "-m", "apd_viewer", "study", plan, "-o", str(bar / "out"), "--processes", "1"],
            start_new_session=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        before, end = len(list(bar.glob("out/cases/*/*"))), time.monotonic() + 60.0
        while len(list(bar.glob("out/cases/*/*"))) <= before and time.monotonic() < end:
            time.sleep(0.02)
        for _ in range(times):
            os.killpg(process.pid, signal.SIGINT)  # as a terminal does
            time.sleep(0.01)
        out, err = process.communicate(timeout=60.0)
        assert process.returncode == 130, err
        assert "repeat the command to continue" in err
        assert "Traceback" not in err
        return sum(row["status"] == "done" for row in rows_of(bar / "out")), out

    once, out = interrupted(1)
    assert 0 < once < 399
    assert f"{once} done, {399 - once} not done yet" in out
    twice, _ = interrupted(2)
    assert once < twice < 399


@pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="reads the sockets that Linux lists in /proc/net"
)
@pytest.mark.parametrize("option", ["--processes", "--workers"])
@pytest.mark.night
def test_study_command_has_processes_to_which_nobody_else_can_speak(bar, option):
    """Whoever reaches a worker by a socket can have it run anything as the user."""
    plan = plan_of(bar, [f"twist {angle}" for angle in range(1, 400)], steps=5)
    process = subprocess.Popen(
        [sys.executable, "-m", "apd_viewer", "study", plan, "-o", str(bar / "out"), option, "2"],
        start_new_session=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        end, found = time.monotonic() + 60.0, []
        while len(list(bar.glob("out/cases/*/*.case"))) < 3 and time.monotonic() < end:
            found += listening(tree_of(process.pid))
            time.sleep(0.05)
        tree = tree_of(process.pid)
        assert process.poll() is None
        assert len(tree) >= 3, "two workers"
        assert [*found, *listening(tree)] == []
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def test_study_summary_names_the_cases_whose_folds_compete(tmp_path):
    """Those that differ in the seed alone, by more than 1 % of the energy."""
    cells = [("a.off", "0"), ("a.off", "1"), ("a.off", "2"), ("b.off", "0"), ("b.off", "1"), ("c.off", "1")]
    energies = [2.0, 2.1, 2.0, 1.0, 1.009, 7.0]
    rows = [
        ResultRow(k + 2, f"key{k}", each, "done", "", {"energy": energy})
        for k, (each, energy) in enumerate(zip(cells, energies, strict=True))
    ]
    said = study_summary(ResultTable(("mesh", "seed"), tuple(rows)), tmp_path).splitlines()
    assert said[1:] == ["lines 2, 3, 4: folds compete, with energies up to 5 % apart by seed"]
    without = ResultTable(("mesh", "stiffness"), tuple(rows))
    assert len(study_summary(without, tmp_path).splitlines()) == 1


def test_study_command_varies_imperfection_and_seed(bar, capsys):
    lines = ["mesh,selection,motion,steps,imperfection,seed", "bar.off,bar.sel,push 1%,1,1e-3,2"]
    (bar / "plan.csv").write_text("\n".join([*lines, "bar.off,bar.sel,push 10%,1,1,0.5"]) + "\n")
    assert main(["study", str(bar / "plan.csv"), "-o", str(bar / "out"), "--processes", "1"]) == 0
    first, wrong = rows_of(bar / "out")
    assert (first["status"], wrong["status"]) == ("done", "wrong")
    assert float(first["saddle_escapes"]) >= 0.0
    assert "1 is out of range; enter 0 to 0.1." in wrong["sentence"]
