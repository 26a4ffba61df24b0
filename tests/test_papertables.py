"""The claim of the paper, on the samples: the area comes back to within 0.1 % where ARAP loses it."""

import csv

import numpy as np
import pytest
import trimesh

from apd_viewer import papertables
from apd_viewer.__main__ import main
from apd_viewer.files.samples import open_sample


@pytest.fixture(scope="module")
def table():
    return list(papertables.rows())


def test_the_area_is_kept_where_arap_changes_it(table):
    assert [row.name for row in table] == list(papertables.CASES)
    for row in table:
        assert row.paper.converged
        assert row.arap.converged
        assert abs(row.paper.area_error) <= 1e-3 < abs(row.arap.area_error)


def test_the_areas_are_those_of_the_shapes(table):
    for row in table:
        mesh, _ = open_sample(papertables.CASES[row.name][0])
        for result in (row.arap, row.paper):
            shape = trimesh.Trimesh(result.U, mesh.F, process=False)
            assert shape.area == pytest.approx(result.area, rel=1e-12)
            assert shape.volume == pytest.approx(result.volume, rel=1e-9)


def test_the_table_says_what_was_measured(table):
    lines = papertables.markdown(table).splitlines()
    assert len({len(line) for line in lines}) == 1, "columns of equal width"
    for row, line in zip(table, lines[2:], strict=True):
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        assert cells[0] == row.title
        assert float(cells[5].removesuffix(" %")) == pytest.approx(100 * row.paper.area_error, abs=5e-4)
        assert cells[-1] == "yes"


def test_a_row_outside_the_tolerance_does_not_say_yes(table):
    row = table[0]
    assert row._replace(paper=row.arap).cells()[-1] == "no"


def test_the_csv_holds_all_digits(table, tmp_path):
    papertables.write_csv(table, tmp_path / "tables.csv")
    with (tmp_path / "tables.csv").open(encoding="utf-8") as stream:
        read = list(csv.DictReader(stream))
    results = [result for row in table for result in (row.arap, row.paper)]
    assert np.array_equal([float(line["area"]) for line in read], [result.area for result in results])


def test_the_command_writes_table_and_pictures(table, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(papertables, "CASES", {"duck-bend-015": papertables.CASES["duck-bend-015"]})
    assert main(["paper", "-o", str(tmp_path / "new" / "folder")]) == 0
    assert "duck's tail" in capsys.readouterr().out
    assert {path.name for path in (tmp_path / "new" / "folder").iterdir()} == {
        "tables.csv",
        "duck-bend-015.png",
    }


def test_a_folder_that_cannot_be_made_is_refused_in_one_line(tmp_path, capsys):
    (tmp_path / "taken").write_text("")
    assert main(["paper", "-o", str(tmp_path / "taken")]) == 2
    said = capsys.readouterr().err
    assert said.startswith("error: ")
    assert said.count("\n") == 1
