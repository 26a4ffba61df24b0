"""Processes of this machine: killed, stuck, replaced; and the same bits as without them."""

import os
import signal
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
import study_work

from apd_viewer.cases.case_file import case_from_bytes, read_case
from apd_viewer.cases.case_worker import CaseTask
from apd_viewer.cases.local_pool import LocalPool
from apd_viewer.cases.run_case import CaseDocuments, run_case
from apd_viewer.cases.study import Study


@pytest.fixture
def pool():
    """Start pools that are ended with the test."""
    started = []

    def start(*arguments, **options):
        started.append(LocalPool(*arguments, **options))
        return started[-1]

    yield start
    for each in started:
        each.close(at_once=True)


@pytest.fixture
def run(written, bar):
    """Run a study of rows; return its table."""

    def study(rows, pool, **options):
        study = Study(written(*rows), bar / "out")
        try:
            return study.run(pool, **options)
        finally:
            study.close()

    return study


def test_local_pool_tries_what_died_once_again(pool, run, bar, monkeypatch):
    monkeypatch.setenv("DEADLY_ONCE", str(bar / "once"))
    table = run([{"steps": "7"}], pool(1, study_work.deadly))
    assert [row.status for row in table.rows] == ["done"]
    assert (bar / "once").exists()


@pytest.mark.night
def test_local_pool_tries_what_dies_again_and_the_rest_goes_on(pool, run, bar, monkeypatch):
    monkeypatch.setenv("DEADLY_ONCE", str(bar / "once"))
    rows = [{"steps": str(steps)} for steps in (3, 13, 7, 5)]
    table = run(rows, pool(2, study_work.deadly))
    assert [row.status for row in table.rows] == ["done", "failed", "done", "done"]
    assert "died at every attempt" in table.rows[1].sentence
    assert (bar / "once").exists()


def test_local_pool_ends_a_case_that_native_code_holds(pool, run, bar, monkeypatch):
    """By a clock that stands still but for a minute once the case is held: others may take their time."""
    held = bar / "held"
    monkeypatch.setenv("STUCK", str(held))
    clock = SimpleNamespace(monotonic=lambda: 60.0 if held.exists() else 0.0)
    monkeypatch.setattr("apd_viewer.cases.local_pool.time", clock)
    table = run([{"steps": "13"}, {"steps": "3"}], pool(1, study_work.stuck), limit=0.5)
    assert [row.status for row in table.rows] == ["failed", "done"]
    assert "longer than 0.5 s" in table.rows[0].sentence


@pytest.mark.night
def test_local_pool_replaces_processes_and_killed_idle_ones_too(pool, planned):
    case = next(iter(planned({}).cases.values()))
    engine = pool(1, study_work.quick, recycle=2)

    def process():
        return int(case_from_bytes(engine.start(CaseTask(case)).result().content).readings["process"])

    first, second, third = process(), process(), process()
    assert first == second != third
    os.kill(third, signal.SIGKILL)
    end = time.monotonic() + 20.0
    while Path(f"/proc/{third}/stat").exists() and time.monotonic() < end:
        time.sleep(0.02)
    assert process() not in (first, third)


def test_local_pool_gives_the_bits_of_this_process(pool, run, planned, bar):
    rows = [{"motion": f"twist {angle}deg; push 10%", "iterations": "20"} for angle in (50, 200)]
    table = run(rows, pool(1))
    meshes = CaseDocuments(lambda source: source.path.read_bytes())
    for row, case in zip(table.rows, planned(*rows).cases.values(), strict=True):
        here, there = run_case(case, meshes), read_case(bar / "out", row.key, with_shape=True)
        assert there.status == "done"
        assert here.curves == there.curves
        assert here.U.tobytes() == there.U.tobytes()
        assert {**here.readings, "seconds": 0} == {**there.readings, "seconds": 0}
