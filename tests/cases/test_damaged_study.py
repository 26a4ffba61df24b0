"""A folder that was damaged anywhere: the same command makes it whole, and the same tables again."""

import csv
import shutil
import sqlite3
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from immediate import Here

from apd_viewer.cases.case_file import CaseResult, case_path, case_to_bytes
from apd_viewer.cases.case_worker import CaseAnswer
from apd_viewer.cases.database import DATABASE_NAME
from apd_viewer.cases.results import read_results
from apd_viewer.cases.run_case import case_session
from apd_viewer.cases.study import Study
from apd_viewer.cases.study_progress import study_forecast
from apd_viewer.errors import InputError

ROWS = [{"motion": f"twist {angle}deg", "# who": "=me"} for angle in range(1, 13)]
TABLES = "results.csv", "curves.csv"


def curved(task):
    """Answer at once, with curves."""
    part = [float(step) for step in range(task.case.steps + 1)]
    readings = {"seconds": 0.5, "volume": float(task.case.motion[0].split()[-1].removesuffix("deg"))}
    curves = {"part": part, "volume": [x / 3.0 for x in part]}
    told = "done", "Fine.", readings, curves, {}, np.ones((4, 3)) / 3.0
    return CaseAnswer(case_to_bytes(CaseResult(task.case.key, task.case.to_json, *told)))


def run(plan, folder):
    """Run a study; return the motions that were computed, how many were damaged, and the tables."""
    engine, study = Here(curved), Study(plan, folder)
    try:
        study.run(engine)
    finally:
        study.close()
    ran = [motion.split()[-1] for motion in engine.ran]
    return ran, study.damaged_count, [(folder / name).read_bytes() for name in TABLES]


@pytest.fixture
def whole(written, bar):
    """The plan and the folder of a finished study, and its tables."""
    plan = written(*ROWS)
    return plan, bar / "out", run(plan, bar / "out")[2]


def damages(content, places):
    """The content with a page overwritten, and with a byte turned over, at each of the places."""
    chance = np.random.default_rng(0)
    for start, length in places:
        for new in (chance.bytes(length), bytes(length), bytes([content[start] ^ 0xFF])):
            yield content[:start] + new[: len(content) - start] + content[start + len(new) :]


def test_study_makes_a_database_damaged_on_any_page_anew_from_its_cases(whole):
    plan, folder, tables = whole
    sound = (folder / DATABASE_NAME).read_bytes()
    places = [(page, 4096) for page in range(0, len(sound), 4096)]
    for broken in damages(sound, places):
        (folder / DATABASE_NAME).write_bytes(broken)
        assert run(plan, folder) == ([], 0, tables)


def test_study_changes_no_result_by_a_byte_turned_over_anywhere_in_the_database(whole):
    plan, folder, tables = whole
    sound = (folder / DATABASE_NAME).read_bytes()
    chance = np.random.default_rng(1)
    used = np.flatnonzero(np.frombuffer(sound, np.uint8))
    for place in [*range(0, 100, 9), *chance.choice(used, 25, replace=False)]:
        (folder / DATABASE_NAME).write_bytes(
            sound[:place] + bytes([sound[place] ^ 1 << chance.integers(8)]) + sound[place + 1 :]
        )
        assert run(plan, folder) == ([], 0, tables), place


def test_read_results_takes_an_error_of_sqlite_that_is_no_text_for_damage(whole):
    """It quotes the name of a table, in which there may be any byte."""
    plan, folder, tables = whole
    sound = (folder / DATABASE_NAME).read_bytes()
    (folder / DATABASE_NAME).write_bytes(sound.replace(b"tablefactsfacts", b"tablef\xe9ctsfacts", 1))
    with pytest.raises(InputError, match="damaged; run the study again"):
        read_results(folder)
    assert run(plan, folder) == ([], 0, tables)


def test_study_computes_a_case_damaged_at_any_byte_again(whole):
    plan, folder, tables = whole
    path = case_path(folder, read_results(folder).rows[3].key)
    sound = path.read_bytes()
    for place in [*range(0, len(sound), 37), len(sound) - 1]:
        path.write_bytes(sound[:place] + bytes([sound[place] ^ 0x10]) + sound[place + 1 :])
        assert run(plan, folder) == (["4deg"], 1, tables)
        assert path.read_bytes() == sound


def test_study_finds_a_damaged_case_though_others_are_left_to_do(whole, written):
    _, folder, _ = whole
    path = case_path(folder, read_results(folder).rows[3].key)
    path.write_bytes(path.read_bytes()[:-1] + b"x")
    plan = written(*ROWS, {"motion": "twist 90deg"})
    ran, damaged, (_, curves) = run(plan, folder)
    assert (ran, damaged) == (["90deg", "4deg"], 1)
    steps = list(csv.DictReader(curves.decode().splitlines()))
    assert len({row["line"] for row in steps}) == len(ROWS) + 1


def test_study_does_not_take_a_case_in_the_place_of_another_for_it(whole):
    plan, folder, tables = whole
    one, other = (case_path(folder, row.key) for row in read_results(folder).rows[:2])
    shutil.copy(one, other)
    assert run(plan, folder) == (["2deg"], 1, tables)


def drop(path):
    with closing(sqlite3.connect(path)) as base:
        base.execute("drop table cases")


def overwrite(path):
    path.write_bytes(bytes(path.stat().st_size))


@pytest.mark.parametrize("damage", [drop, overwrite, Path.unlink])
def test_study_loses_nothing_by_damage_while_it_runs(whole, written, damage):
    """Who writes next finds it, and goes on with a database made anew."""
    plan, folder, _ = whole
    study = Study(written(*ROWS, {"motion": "twist 90deg"}), folder)
    damage(folder / DATABASE_NAME)
    table = study.run(Here(curved))
    study.close()
    assert [row.status for row in table.rows] == ["done"] * (len(ROWS) + 1)
    assert run(plan, folder)[:2] == ([], 0)
    assert [row.status for row in read_results(folder).rows] == ["done"] * (len(ROWS) + 1)


def test_read_results_tells_readers_of_a_damaged_database_what_to_do(whole, planned):
    plan, folder, tables = whole
    with closing(sqlite3.connect(folder / DATABASE_NAME)) as base:
        base.execute('update cases set readings = \'{"volume": "much"}\'')
        base.commit()
    with pytest.raises(InputError, match="damaged; run the study again"):
        read_results(folder)
    left = study_forecast(planned(*ROWS), folder)
    assert (left.cases, left.done) == (len(ROWS), len(ROWS))
    assert run(plan, folder) == ([], 0, tables)


def test_read_results_does_not_run_a_database_that_is_a_program(whole):
    """A view can take for ever."""
    plan, folder, tables = whole
    with closing(sqlite3.connect(folder / DATABASE_NAME)) as base:
        base.executescript(
            "drop table facts; create view facts as with recursive n(value) as"
            " (select 1 union all select value from n) select 'columns' as name, value from n"
        )
    with pytest.raises(InputError, match="damaged; run the study again"):
        read_results(folder)
    assert run(plan, folder) == ([], 0, tables)


def test_study_puts_a_folder_in_the_place_of_the_database_aside(whole):
    plan, folder, tables = whole
    (folder / DATABASE_NAME).unlink()
    (folder / DATABASE_NAME).mkdir()
    assert run(plan, folder) == ([], 0, tables)


@pytest.mark.parametrize(
    "name", ["results.csv", "curves.csv", ".lock", DATABASE_NAME, "cases", "inputs", "a copy"]
)
def test_study_writes_nothing_through_a_link_out_of_its_folder(whole, planned, name):
    """An unpacked folder of a stranger can have one in the place of anything that is written."""
    plan, folder, _ = whole
    copy = next(iter(planned(*ROWS[:1]).cases.values())).selection.path
    path = folder / "inputs" / copy.parent.name / copy.name if name == "a copy" else folder / name
    outside = plan.with_name("precious")
    if path.exists():
        path.rename(outside)
    elif name == ".lock":
        outside.write_bytes(b"mine")
    precious = outside if outside.is_file() else outside / "precious"
    precious.write_bytes(b"mine")
    path.symlink_to(outside)
    with pytest.raises(InputError, match="link to outside the study; remove it"):
        Study(plan, folder)
    assert precious.read_bytes() == b"mine"
    path.unlink()
    assert run(plan, folder)[1] == 0


def test_study_puts_a_case_in_the_place_of_a_link(whole):
    plan, folder, tables = whole
    path = case_path(folder, read_results(folder).rows[3].key)
    for outside in (plan.with_name("precious"), plan.with_name("nowhere")):
        path.unlink()
        path.symlink_to(outside)
        plan.with_name("precious").write_bytes(b"mine")
        assert run(plan, folder) == (["4deg"], 0, tables)
        assert not path.is_symlink()
    assert plan.with_name("precious").read_bytes() == b"mine"
    assert not plan.with_name("nowhere").exists()


def test_study_makes_a_damaged_copy_of_a_mesh_again(whole, planned):
    plan, folder, _ = whole
    case = next(iter(planned(*ROWS[:1]).cases.values()))
    copies = [folder / "inputs" / each.path.parent.name / each.path.name for each in case.input_files]
    sound = [copy.read_bytes() for copy in copies]
    for copy in copies:
        copy.write_bytes(copy.read_bytes().replace(b"1", b"2"))
    Study(plan, folder).close()
    assert [copy.read_bytes() for copy in copies] == sound


@pytest.mark.parametrize(
    "change",
    [
        {"mesh": {"digest": "0" * 64, "name": "../../../bar.off"}},
        {"mesh": {"digest": "../../..", "name": "bar.off"}},
        {"steps": 10**9},
        {"steps": "many"},
        {"motion": 5},
        {"settings": {"nonsense": 1}},
        {"unit": []},
    ],
)
def test_case_session_of_a_stranger_reaches_nothing_outside_its_folder(whole, planned, change):
    _, folder, _ = whole
    key, case = next(iter(planned(*ROWS[:1]).cases.items()))
    (folder / "inputs" / "0000000000000000").mkdir()
    made = CaseResult(key, {**case.to_json, **change}, "done", "", {}, {}, {}, np.ones((4, 3)))
    case_path(folder, key).write_bytes(case_to_bytes(made))
    with pytest.raises(InputError, match=r"damaged|steps"):
        case_session(folder, key)
