"""The claim of the paper, on the samples: the area comes back to within 0.1 % where ARAP loses it."""

import csv
import json

import numpy as np
import pytest
import trimesh
from meshes import box, ends
from PIL import Image

from apd_viewer.__main__ import main
from apd_viewer.commands import paper_command
from apd_viewer.commands.terminal.columns import column_count
from apd_viewer.figures import paper_figures
from apd_viewer.geometry.mesh.mesh import Mesh


def standing_bar(_):
    """A bar that stands like the bottle, and is held like it."""
    V, F = box(2, 2, 6)
    V = V[:, [1, 2, 0]]
    labels = np.ones(len(V), dtype=np.uint8)
    base, handle = ends(V, axis=1)
    labels[base], labels[handle] = 0, 2
    return Mesh(V, F), labels


@pytest.fixture(scope="module", params=["bar", pytest.param("samples", marks=pytest.mark.night)])
def table(request):
    """The rows of all motions: of a bar, and by night of the samples that the paper has."""
    with pytest.MonkeyPatch.context() as patch:
        if request.param == "bar":
            patch.setattr(paper_command, "open_sample", standing_bar)
        yield list(paper_command.table_rows())


def test_paper_tables_keep_the_area_where_arap_changes_it(table):
    assert [row.name for row in table] == list(paper_command.PAPER_CASES)
    for row in table:
        assert row.paper.converged
        assert row.arap.converged
        assert row.is_within_tolerance
        assert abs(row.paper.area_error) <= 1e-3 < abs(row.arap.area_error)


def test_paper_tables_have_the_areas_of_the_shapes(table):
    for row in table:
        mesh, _ = paper_command.open_sample(row.case.sample)
        for result in (row.arap, row.paper):
            shape = trimesh.Trimesh(result.U, mesh.F, process=False)
            assert shape.area == pytest.approx(result.area, rel=1e-12)
            assert shape.volume == pytest.approx(result.volume, rel=1e-9)


def test_paper_tables_say_what_was_measured_beside_what_the_paper_says(table):
    text = paper_command.format_tables(table)
    assert [line for line in text.splitlines() if line.startswith("Table")] == list(
        paper_command.TABLE_TITLES.values()
    )
    cells = [
        [cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if "%" in line
    ]
    ours = [line for line in cells if line[1] == "this program"]
    theirs = [line for line in cells if line[1] == "Li & Hui"]
    for row, own, said in zip(table, ours, theirs, strict=True):
        assert own[0] == row.case.title
        assert float(own[6].removesuffix(" %")) == pytest.approx(100 * row.paper.area_error, abs=5e-4)
        assert float(said[6].removesuffix(" %")) == pytest.approx(
            100 * (float(said[5]) / float(said[2]) - 1), abs=5e-4
        )
        assert own[-1] == said[-1] == "pass"
    # In percent, as they are printed in the paper.
    assert [line[4] for line in theirs] == ["-1.92 %", "-0.44 %", "-0.68 %", "-1.35 %"]


def test_format_markdown_has_columns_of_equal_width(table):
    for sample in paper_command.TABLE_TITLES:
        rows = [row for row in table if row.case.sample == sample]
        assert len({len(line) for line in paper_command.format_markdown(rows).splitlines()}) == 1


def test_format_markdown_has_columns_of_equal_width_in_chinese(table):
    row = table[0]._replace(case=table[0].case._replace(title="瓶子扭转 60°"))
    lines = paper_command.format_markdown([row, *table[:2]]).splitlines()
    assert len(set(map(column_count, lines))) == 1


def test_row_outside_the_tolerance_does_not_pass(table):
    failed = table[0]._replace(paper=table[0].arap)
    assert not failed.is_within_tolerance
    assert failed.lines()[0][-1] == "fail"
    assert paper_command.tolerance_verdict(table).startswith("Pass")
    assert "twisted by 60°" in paper_command.tolerance_verdict([failed, *table[1:]])
    assert paper_command.tolerance_verdict([failed, *table[1:]]).startswith("Fail")


def test_write_csv_keeps_all_digits(table, tmp_path):
    paper_command.write_csv(table, tmp_path / "tables.csv")
    with (tmp_path / "tables.csv").open(encoding="utf-8") as stream:
        read = list(csv.DictReader(stream))
    results = [result for row in table for result in (row.arap, row.paper)]
    assert np.array_equal([float(line["area"]) for line in read], [result.area for result in results])
    assert {line["within_tolerance"] for line in read if line["method"] == "paper"} == {"1"}
    assert {line["within_tolerance"] for line in read if line["method"] == "arap"} == {"0"}


# ---- The command, on a bar in place of the bottle and on nothing in place of the duck.

FILES = {
    *("tables.csv", "tables.md", "bottle.png", "handle.csv", "handle.png", "handle.svg"),
    *("loss-against-angle.csv", "loss-against-angle.png", "loss-against-angle.svg"),
}


@pytest.fixture
def coarse(monkeypatch):
    """Re-run only one move, on a bar that stands like the bottle."""
    name = "bottle-twist-60"
    monkeypatch.setattr(paper_command, "open_sample", standing_bar)
    monkeypatch.setattr(paper_command, "PAPER_CASES", {name: paper_command.PAPER_CASES[name]})


def read(path):
    with path.open(encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


@pytest.mark.night
@pytest.mark.usefixtures("coarse")
def test_paper_writes_tables_curves_and_figures(tmp_path, capsys):
    folder = tmp_path / "new" / "folder"
    assert main(["paper", "-o", str(folder), "--progress-lines"]) == 0
    assert {path.name for path in folder.iterdir()} == FILES
    assert [path.name for path in tmp_path.iterdir()] == ["new"], "scratch was left"
    lines = capsys.readouterr().out.splitlines()
    done = [json.loads(line)["done"] for line in lines if line.startswith("{")]
    assert done
    assert done == sorted(done)
    said = "\n".join(line for line in lines if not line.startswith("{"))
    assert (folder / "tables.md").read_text(encoding="utf-8").strip() in said
    for name in ("bottle", "handle", "loss-against-angle"):
        with Image.open(folder / f"{name}.png") as image:
            assert np.ptp(np.asarray(image.convert("L"))) > 150, "an empty picture"
    losses = read(folder / "loss-against-angle.csv")
    at_rest = [float(line["area_error"]) for line in losses if float(line["degrees"]) == 0]
    assert max(map(abs, at_rest)) < 1e-12
    assert len({line["iterations"] for line in losses}) == 6
    held = read(folder / "handle.csv")
    pulls = {float(line["asked"]): float(line["got"]) for line in held if line["motion"] == "pull"}
    assert pulls[0] == 0
    assert 0 <= pulls[0.4] < 0.2, "Eq. 8 takes a pull back"


@pytest.mark.usefixtures("coarse", "without_opengl")
def test_paper_does_without_pictures_of_shapes_without_opengl(tmp_path, capsys):
    assert main(["paper", "-o", str(tmp_path)]) == 0
    assert "The shapes were not drawn" in capsys.readouterr().out
    assert {path.name for path in tmp_path.iterdir()} == FILES - {"bottle.png"}


def test_paper_refuses_in_one_line_a_folder_that_cannot_be_made(tmp_path, capsys):
    (tmp_path / "taken").write_text("")
    assert main(["paper", "-o", str(tmp_path / "taken")]) == 2
    said = capsys.readouterr().err
    assert said.startswith("error: ")
    assert said.count("\n") == 1


@pytest.mark.usefixtures("coarse")
def test_paper_leaves_nothing_when_interrupted(tmp_path, monkeypatch):
    def stop(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(paper_figures, "handle_curve", stop)
    assert main(["paper", "-o", str(tmp_path / "out")]) == 130
    assert list(tmp_path.iterdir()) == []
