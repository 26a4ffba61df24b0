"""The study of the manual: its plan is made again, and its page says what its table holds."""

import csv
import re
import runpy
from pathlib import Path

import pytest

from apd_viewer.cases.plan import read_plan
from apd_viewer.cases.run_case import CaseDocuments, run_case
from apd_viewer.cases.study_case import InputFiles

DOCS = Path(__file__).parents[2] / "docs"
STUDY = DOCS / "studies" / "crushed-bottle"


def rows_of(path):
    with path.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


@pytest.fixture(scope="module")
def results():
    return rows_of(STUDY / "results.csv")


def left(row):
    """Percent of the volume."""
    return 100.0 * float(row["volume"]) / float(row["volume_rest"])


def test_worked_study_has_a_script_that_makes_its_plan_again(tmp_path):
    script = runpy.run_path(str(STUDY / "make.py"))["plan"]
    script.__globals__["HERE"] = tmp_path
    for name in ("bottle.obj", "bottle.sel"):
        (tmp_path / name).write_bytes((STUDY / name).read_bytes())
    script()
    assert rows_of(tmp_path / "plan.csv") == rows_of(STUDY / "plan.csv")


def test_worked_study_has_the_table_of_its_plan(results):
    plan = rows_of(STUDY / "plan.csv")
    assert [{name: row[name] for name in plan[0]} for row in results] == plan
    assert {(row["status"], row["crossings"]) for row in results} == {("done", "0")}
    assert max(abs(float(row["area_error"])) for row in results) <= 1e-10


def test_worked_study_says_on_its_page_what_its_table_holds(results):
    said = " ".join(
        (DOCS / "howto" / "studies.md").read_text(encoding="utf-8").partition("## A worked")[2].split()
    )
    least = min(results, key=left)
    twist, push = re.findall(r"[\d.]+", least["motion"])
    motion = f"by a twist of {float(twist):.0f}° and a push of {float(push):.0f} %"
    assert f"{left(least):.1f} % of the volume, {motion}" in said
    for low, high in ((1e-4, 3e-4), (3e-4, 1e-3), (1e-3, 3e-3), (3e-3, 1e-2)):
        assert f"{min(left(row) for row in results if low <= float(row['stiffness']) < high):.1f} %" in said
    assert f"up to {max(map(left, results)):.1f} % of the volume" in said
    assert f"In {sum(row['unsettled_steps'] != '0' for row in results)}, of the thinnest" in said


@pytest.mark.night
def test_run_case_computes_a_case_as_in_the_table(results, tmp_path):
    (row,) = (row for row in results if row["motion"].startswith("twist 43.2612deg"))
    columns = list(rows_of(STUDY / "plan.csv")[0])
    cells = [str(STUDY / row[name]) if name in ("mesh", "selection") else row[name] for name in columns]
    (tmp_path / "plan.csv").write_text(",".join(columns) + "\n" + ",".join(cells) + "\n", encoding="utf-8")
    (planned,) = read_plan(tmp_path / "plan.csv", InputFiles(tmp_path / "inputs")).rows
    found = run_case(planned.case, CaseDocuments(lambda source: source.path.read_bytes()))
    assert found.readings["volume"] == pytest.approx(float(row["volume"]), rel=1e-3)
    assert found.readings["energy"] == pytest.approx(float(row["energy"]), rel=1e-2)
