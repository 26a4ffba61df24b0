"""The command volumes: what it prints and writes, and that it says no in one line."""

import json

import meshes
import pytest

import apd_viewer
from apd_viewer.__main__ import main
from apd_viewer.commands.volumes_command import volume_lines
from apd_viewer.figures import curves
from apd_viewer.presentation.volume_text import PUBLISHED_VOLUMES, VolumeName, VolumeRow
from apd_viewer.session.quantities.expressions import parse_volume
from apd_viewer.session.quantities.units import Unit


@pytest.fixture
def files(tmp_path):
    """A box of 4 x 5 x 10 and the same at half its height."""
    V, F = meshes.box(4, 5, 10)
    mesh = apd_viewer.Mesh(V, F)
    paths = tmp_path / "rest.obj", tmp_path / "half.obj"
    for path, scale in zip(paths, (1.0, 0.5), strict=True):
        apd_viewer.save_mesh(mesh, V * [1, 1, scale], path)
    return paths


def test_volumes_command_says_the_reason_of_a_missing_volume(files, tmp_path, capsys):
    rest, _ = files
    mesh = apd_viewer.open_mesh(rest)
    broken = apd_viewer.Mesh(mesh.V, [*mesh.F, mesh.F[0]])  # two triangles in one place
    apd_viewer.save_mesh(broken, broken.V, tmp_path / "broken.obj")
    assert main(["volumes", str(tmp_path / "broken.obj"), "--rest", str(rest)]) == 0
    assert capsys.readouterr().out.splitlines()[-1].startswith("broken.obj: There is no volume: the surface")
    assert main(["volumes", str(rest)]) == 0
    assert "There is no volume" not in capsys.readouterr().out


def test_volumes_command_writes_and_says_readings_of_both_shapes(files, tmp_path, capsys):
    rest, half = files
    words = ["--unit", "cm", "--bag", "45", "--thickness", "0.3mm", "--density", "1"]
    out = tmp_path / "v.json"
    assert main(["volumes", str(half), "--rest", str(rest), *words, "--json", str(out)]) == 0
    said, report = capsys.readouterr().out, json.loads(out.read_text(encoding="utf-8"))
    assert (report["mesh"], report["rest"], report["unit"]) == ("half.obj", "rest.obj", "cm")
    for suffix, volume in (("", 100.0), ("_rest", 200.0)):
        for name in ("enclosed_volume", "hull_volume", "packed_volume"):
            assert report[name + suffix] == pytest.approx(volume)
        assert report["bulk_volume" + suffix] == pytest.approx(volume / report["packing"])
        assert report["objects_in_bag" + suffix] == int(45_000 * report["packing"] / volume)
        low, high = report["objects_in_bag_range" + suffix]
        assert low < report["objects_in_bag" + suffix] < high
        assert report["minimum_width" + suffix] == pytest.approx(4.0)
    assert report["material_volume"] == report["material_volume_rest"] == pytest.approx(0.03 * 220)
    assert report["bulk_density_rest"] == pytest.approx(1000 * 0.03 * 220 * 0.64 / 200)
    assert report["bulk_density"] == pytest.approx(1000 * 0.03 * 220 * 0.64 / 100), "of the same plastic"
    assert set(report["published"]) == {quantity.value for quantity in PUBLISHED_VOLUMES}
    assert {quantity.value for quantity in VolumeName} <= set(report)
    for figures in PUBLISHED_VOLUMES.values():
        for figure in figures:
            assert f"published: {figure.words} [{figure.source}]" in said
    assert "100.0\u00a0cm³ of 200.0\u00a0cm³  −50.0 %" in said


def test_volumes_command_says_no_change_of_a_mesh_alone(files, capsys):
    assert main(["volumes", str(files[0])]) == 0
    said = capsys.readouterr().out
    assert " of " not in next(line for line in said.splitlines() if line.startswith("Enclosed"))
    assert "0.0 %" not in said


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--bag", "45"], "add --unit"),
        (["--bag", "0", "--unit", "cm"], "more than 0 litres"),
        (["--density", "1"], "add --thickness"),
        (["--thickness", "0"], "greater than 0"),
        (["--thickness", "0.3mm"], "unit of the mesh"),
        (["--rest", "gone.obj"], "no file"),
    ],
)
def test_volumes_command_says_no_in_one_line_and_writes_nothing(files, tmp_path, capsys, words, sentence):
    out = tmp_path / "v.json"
    assert main(["volumes", str(files[0]), *words, "--json", str(out)]) == 2
    said = capsys.readouterr()
    assert sentence in said.err
    assert said.err.count("\n") == 1
    assert not out.exists()


def test_volumes_output_has_readings_below_each_other_however_long_the_titles_are():
    rows = [
        VolumeRow(VolumeName.ENCLOSED, title, "", ("-", ""), ("12 cm³", ""), "", ())
        for title in ("Volume", "A title of another language, which is longer")
    ]
    _, *lines = volume_lines("box.obj", rows, has_rest=False).splitlines()
    assert len({line.index("12 cm³") for line in lines}) == 1
    assert all("  12 cm³" in line for line in lines)


def test_volumes_command_fills_a_shape_and_says_what_spills(files, tmp_path, capsys):
    rest, half = files
    out, levels = tmp_path / "v.json", tmp_path / "levels.csv"
    words = ["volumes", str(half), "--rest", str(rest), "--unit", "cm", "--json", str(out)]
    assert main([*words, "--up", "z", "--fill", "150ml", "--levels", str(levels)]) == 0
    said, report = capsys.readouterr().out, json.loads(out.read_text(encoding="utf-8"))
    assert (report["brimful_volume"], report["brimful_volume_rest"]) == pytest.approx((100.0, 200.0))
    assert (report["fill_level"], report["fill_level_rest"]) == pytest.approx((5.0, 7.5))
    assert (report["freeboard"], report["freeboard_rest"]) == pytest.approx((0.0, 2.5))
    assert (report["spilled_volume"], report["spilled_volume_rest"]) == pytest.approx((50.0, 0.0))
    assert "50.00\u00a0cm³ of 0\u00a0cm³" in said
    head, *rows = levels.read_text(encoding="utf-8").splitlines()
    assert head == "level,volume"
    assert [tuple(map(float, row.split(","))) for row in rows] == [
        pytest.approx((0.05 * k, 20.0 * 0.05 * k), abs=1e-9) for k in range(101)
    ]


@pytest.mark.parametrize(
    ("words", "volume"), [([], 60.0), (["--closed", "1"], 120.0), (["--closed", "2,1"], 200.0)]
)
def test_volumes_command_counts_openings_as_closed(tmp_path, words, volume):
    mesh = apd_viewer.Mesh(*meshes.box_with_openings())
    apd_viewer.save_mesh(mesh, mesh.V, tmp_path / "box.obj")
    U = mesh.V * [1, 1, -1]  # upside down: the opening that was the lower one is the higher one
    apd_viewer.save_mesh(mesh, U, tmp_path / "turned.obj")
    out = tmp_path / "v.json"
    command = [
        "volumes",
        str(tmp_path / "turned.obj"),
        "--rest",
        str(tmp_path / "box.obj"),
        "--up",
        "z",
        *words,
    ]
    assert main([*command, "--json", str(out)]) == 0
    report = json.loads(out.read_text(encoding="utf-8"))
    assert report["brimful_volume_rest"] == pytest.approx(volume)
    assert report["brimful_volume"] == pytest.approx(200.0 if volume == 200.0 else 60.0)


@pytest.mark.parametrize("same_name", [False, True])
def test_volumes_command_draws_the_level_of_both_shapes(files, tmp_path, monkeypatch, same_name):
    """Boxes of 20 cm²: straight lines up to their brims, with the filled volume on that of the shape."""
    rest, half = files
    if same_name:  # in another folder
        (tmp_path / "after").mkdir()
        half = half.rename(tmp_path / "after" / rest.name)
    seen, draw = [], curves.draw_fill_levels
    monkeypatch.setattr(curves, "draw_fill_levels", lambda *given: (seen.append(given), draw(*given)))
    words = ["volumes", str(half), "--rest", str(rest), "--unit", "cm", "--up", "z", "--fill", "80ml"]
    assert main([*words, "--figure", str(tmp_path / "levels.png")]) == 0
    ((drawn, units, _, filled),) = seen
    assert units == ("l", "cm")
    assert list(drawn) == [half.name, "rest.obj, at rest"]
    for rows, most in zip(drawn.values(), (0.1, 0.2), strict=True):
        assert rows[-1, 0] == pytest.approx(most)
        assert rows[:, 0] == pytest.approx(0.02 * rows[:, 1])
    assert filled == ("0.08\u00a0l: level 4.000\u00a0cm", pytest.approx(0.08), pytest.approx(4.0))
    assert {path.name for path in tmp_path.glob("levels.*")} == {"levels.png", "levels.svg"}


def test_volumes_command_says_before_it_writes_what_cannot_be_written(files, tmp_path, capsys):
    (tmp_path / "levels.svg").mkdir()
    words = ["volumes", str(files[0]), "--up", "z", "--levels", str(tmp_path / "levels.csv")]
    assert main([*words, "--figure", str(tmp_path / "levels.png")]) == 2
    assert "levels.svg cannot be written (it is a folder)" in capsys.readouterr().err
    assert {path.name for path in tmp_path.glob("levels.*")} == {"levels.svg"}


@pytest.mark.parametrize(
    ("words", "part"),
    [
        (["--fill", "50%"], "It is not clear on which side"),
        (["--up", "z", "--fill", "100ml"], "add --unit"),
        (["--up", "z", "--fill", "10mm", "--unit", "cm"], "This is a length; enter a volume such as 250ml"),
        (["--up", "z", "--fill", "201"], "It holds 200 cubic mesh units"),
        (["--up", "z", "--fill", "-1"], "It holds 200 cubic mesh units"),
        (["--up", "up"], "is not a direction"),
        (["--up", "z", "--closed", "1"], "There is no opening “1”"),
    ],
)
def test_volumes_command_refuses_what_cannot_be_filled(files, capsys, words, part):
    assert main(["volumes", str(files[0]), *words]) == 2
    error = capsys.readouterr().err
    assert part in error
    assert len(error.splitlines()) == 1


@pytest.mark.parametrize(
    ("text", "volume"),
    [("250ml", 250.0), ("0.25 l", 250.0), ("25cl", 250.0), ("2.5e5mm^3", 250), ("9", 9)],
)
def test_parse_volume_reads_litres_and_cubes(text, volume):
    assert parse_volume(text, Unit.CENTIMETRE) == pytest.approx(volume, rel=1e-12)
