"""The folder of a study: what is there is done, whatever became of the program, and others may read."""

import csv
import json
import sqlite3
from contextlib import closing

import pytest
from immediate import Here
from lacking import lack
from study_work import quick

from apd_viewer.cases.case_file import case_path, case_to_bytes
from apd_viewer.cases.case_worker import CaseAnswer
from apd_viewer.cases.results import READINGS, read_results
from apd_viewer.cases.run_case import failed_result
from apd_viewer.cases.study import Study, StudyStore
from apd_viewer.cases.study_progress import study_forecast
from apd_viewer.errors import InputError

ROWS = [{"motion": f"twist {angle}deg"} for angle in (10, 20, 30, 40)]


@pytest.fixture
def run(written, bar):
    """Run a study of rows in the folder ``out``; return the motions that were computed, and the table."""

    def study(*rows, work=quick, **options):
        engine = Here(work)
        study = Study(written(*rows), bar / "out", **options)
        try:
            table = study.run(engine)
        finally:
            study.close()
        return [motion.split()[-1] for motion in engine.ran], table

    return study


def test_study_computes_only_what_is_new_in_a_changed_plan(run):
    assert run(*ROWS)[0] == ["10deg", "20deg", "30deg", "40deg"]
    assert run(*ROWS)[0] == []
    ran, table = run(ROWS[3], {"motion": "twist 50deg"}, ROWS[0], ROWS[0])
    assert ran == ["50deg"]
    assert [row.status for row in table.rows] == ["done", "done", "done", "duplicate"]
    assert table.rows[3].readings == table.rows[2].readings
    assert run(*ROWS)[0] == []


def test_study_computes_what_is_lost_or_damaged_again(run, bar):
    _, table = run(*ROWS)
    keys = [row.key for row in table.rows]
    case_path(bar / "out", keys[1]).unlink()
    path = case_path(bar / "out", keys[2])
    path.write_bytes(path.read_bytes()[:-1])
    assert run(*ROWS)[0] == ["20deg", "30deg"]


def test_study_counts_files_that_the_database_does_not_know(run, bar):
    """So it is where the program was killed before it wrote the database."""
    _, table = run(*ROWS)
    for wreck in (None, b"", b"this is no database" * 100):
        if wreck is None:
            (bar / "out" / "study.sqlite").unlink()
        else:
            (bar / "out" / "study.sqlite").write_bytes(wreck)
        ran, again = run(*ROWS)
        assert ran == []
        assert again == table
    assert (bar / "out" / "study.sqlite.damaged").exists()


def test_study_keeps_failed_cases_or_tries_them_again(run, written, bar):
    def fails(task):
        return CaseAnswer(case_to_bytes(failed_result(task.case, "No.")))

    _, table = run(*ROWS[:2], work=fails)
    assert [(row.status, row.sentence, row.readings) for row in table.rows] == [("failed", "No.", {})] * 2
    assert run(*ROWS[:2])[0] == []
    Study(written(*ROWS[:2]), bar / "out", retry_failed=True).close()
    assert read_results(bar / "out") == table  # as a look at what there is to do leaves them
    ran, table = run(*ROWS[:2], retry_failed=True)
    assert ran == ["10deg", "20deg"]
    assert [row.status for row in table.rows] == ["done"] * 2


def test_study_does_not_take_a_database_in_use_for_a_damaged_one(run, written, bar, monkeypatch):
    _, table = run(*ROWS[:2])
    connect = sqlite3.connect
    monkeypatch.setattr(sqlite3, "connect", lambda *how, **more: connect(*how, **{**more, "timeout": 0.1}))
    with closing(sqlite3.connect(bar / "out" / "study.sqlite")) as other:
        other.execute("begin exclusive")
        with pytest.raises(InputError, match="cannot be opened now"):
            Study(written(*ROWS[:2]), bar / "out")
    assert not (bar / "out" / "study.sqlite.damaged").exists()
    assert run(*ROWS[:2]) == ([], table)


def test_study_passes_over_a_stray_file_among_the_cases(run, bar):
    run(*ROWS[:1])
    (bar / "out" / "cases" / ".DS_Store").write_bytes(b"")
    assert run(*ROWS[:1])[0] == []


def done_one(study):
    """Run one case of a study, and stop."""

    class Once(Here):
        def free_slot_count(self):
            return 1 - len(self.ran)

    study.run(Once(), on_progress=lambda _: study.stop())


def test_study_is_written_by_one_program_and_read_by_others(written, bar):
    study = Study(written(*ROWS), bar / "out")
    with pytest.raises(InputError, match="Another program"):
        Study(written(*ROWS), bar / "out")
    assert [row.status for row in read_results(bar / "out").rows] == ["waiting"] * 4
    key = next(iter(study.unfinished_cases))
    done_one(study)
    assert [row.status for row in read_results(bar / "out").rows] == ["done", *["waiting"] * 3]
    assert read_results(bar / "out").rows[0].key == key
    study.close()
    Study(written(*ROWS), bar / "out").close()
    with pytest.raises(InputError, match="contains no study"):
        read_results(bar)


PROMISED = [{"motion": "twist 10deg", "volume": "90", "# who": "me, myself"}, {"motion": "none"}]


def test_write_results_gives_the_table_what_it_promises(run, bar, monkeypatch):
    lack(monkeypatch, "pyarrow")
    run(*PROMISED)
    with (bar / "out" / "results.csv").open(encoding="utf-8") as stream:
        columns = next(csv.reader(stream))
    plan = ["mesh", "selection", "motion", "steps", "volume", "# who"]
    promised = ["status", "sentence", "area_error", "volume", "volume_capped", "energy", "crossings"]
    promised += ["seconds"]
    assert columns[: len(plan) + len(promised)] == plan + promised
    with (bar / "out" / "results.csv").open(encoding="utf-8") as stream:
        first, second = csv.DictReader(stream)
    assert (first["status"], first["seconds"], first["# who"], first["line"]) == (
        "done",
        "0.5",
        "me, myself",
        "2",
    )
    assert (second["status"], second["seconds"], second["line"]) == ("wrong", "", "3")
    assert "“none” is not a motion" in second["sentence"]
    assert not (bar / "out" / "results.parquet").exists()


@pytest.mark.extra
def test_write_results_gives_the_table_as_parquet_what_it_promises(run, bar):
    from pyarrow import parquet

    run(*PROMISED)
    found = parquet.read_table(bar / "out" / "results.parquet").to_pylist()
    assert [row["plan_volume"] for row in found] == ["90", ""]
    assert [row["seconds"] for row in found] == [0.5, None]
    assert set(READINGS) <= set(found[0])


def test_write_results_lets_notes_of_a_plan_stay_text(run, planned, bar):
    """Whoever opens the table in a spreadsheet must not run what a stranger wrote."""
    notes = ["=1+1", "@SUM(A1)", "+2+3", "-1.5", "see above"]
    _, table = run(*({"motion": f"twist {k + 1}deg", "# who": note} for k, note in enumerate(notes)))
    assert [row.cells[-1] for row in table.rows] == notes
    with (bar / "out" / "results.csv").open(newline="", encoding="utf-8") as stream:
        cells = [row["# who"] for row in csv.DictReader(stream)]
    assert not [cell for cell in cells if cell[0] in "=+-@" and cell != "-1.5"]
    again = planned(*({"# who": cell} for cell in cells))
    assert [row.cells[-1] for row in again.rows] == notes


def test_study_forecast_forecasts_the_rest_by_what_was_measured(written, planned, bar):
    study = Study(written(*ROWS), bar / "out")
    assert study_forecast(study.plan, bar / "out").seconds is None
    done_one(study)
    study.close()
    more = {"motion": "twist 50deg", "steps": "5"}
    left = study_forecast(planned(*ROWS, more, {"steps": "0"}), bar / "out")
    assert (left.cases, left.done, left.failed, left.wrong) == (5, 1, 0, 1)
    # Half a second for two steps and the shape before them.
    assert left.seconds == pytest.approx(3 * 0.5 + 0.5 / 3 * 6)


def test_study_forecast_knows_which_files_it_can_rely_on(run, planned, bar):
    run(*ROWS[:3])
    plan = planned(*ROWS)
    whole, damaged, lost = (case_path(bar / "out", key) for key in list(plan.cases)[:3])
    damaged.write_bytes(damaged.read_bytes()[:-1])
    lost.unlink()
    assert study_forecast(plan, bar / "out").done == 1
    (bar / "out" / "study.sqlite").unlink()  # as where it is lost: files are read
    before = {path: path.stat().st_mtime_ns for path in bar.rglob("*")}
    assert study_forecast(plan, bar / "out").done == 1
    assert {path: path.stat().st_mtime_ns for path in bar.rglob("*")} == before
    assert whole.exists()


def test_study_has_keys_that_do_not_depend_on_the_place(written, bar, tmp_path_factory):
    study = Study(written(*ROWS), bar / "out")
    other = tmp_path_factory.mktemp("elsewhere")
    moved = Study(written(*ROWS), other)
    assert list(study.unfinished_cases) == list(moved.unfinished_cases)
    assert json.dumps([case.to_json for case in study.unfinished_cases.values()]) == json.dumps(
        [case.to_json for case in moved.unfinished_cases.values()]
    )
    study.close()
    moved.close()


def test_study_store_says_that_a_folder_cannot_be_written(bar, planned):
    (bar / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        StudyStore(bar / "file")
