"""The command that presses: what it writes, and that it writes all of it or nothing."""

import csv
import itertools
import json
import re
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from matplotlib.figure import Figure
from meshes import can, sphere, tube
from PIL import Image

from apd_viewer.__main__ import main
from apd_viewer.commands import press_command
from apd_viewer.figures import curves
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.solver import plate_press, pressed_mesh
from apd_viewer.geometry.solver.pressed_mesh import LoadCurve
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.view import View
from apd_viewer.session.storage.session_file import save_session


@pytest.fixture
def ball(tmp_path):
    V, F = sphere(1)
    save_mesh(Mesh(V, F), V, tmp_path / "ball.off")
    return tmp_path / "ball.off"


@pytest.fixture
def smooth_ball(tmp_path):
    V, F = sphere(3)
    save_mesh(Mesh(V, F), V, tmp_path / "smooth.off")
    return tmp_path / "smooth.off"


@pytest.fixture
def press(tmp_path, capsys):
    """Run the command; return its status, what it said and the mesh that it was to write."""

    def run(*words, out=tmp_path / "pressed.off"):
        try:
            status = main(["press", *map(str, words), *(["-o", str(out)] if out else [])])
        except SystemExit as end:  # of argparse
            status = end.code
        said = capsys.readouterr()
        return status, said.out, said.err, out

    return run


def rows(path):
    with path.open(encoding="utf-8") as stream:
        found = list(csv.DictReader(stream))
    return [{name: float(value) if value else None for name, value in row.items()} for row in found]


QUICK = "--axis", "z", "--to", "90%", "--steps", 2, "--stiffness", 0.001


def test_press_command_writes_a_curve_alone_but_not_nothing(ball, press, tmp_path):
    curve = tmp_path / "c.csv"
    status, said, err, _ = press(ball, *QUICK, "--curve", curve, out=None)
    assert (status, err) == (0, "")
    assert said.startswith(str(curve))
    assert len(rows(curve)) == 3
    assert {path.name for path in tmp_path.iterdir()} == {ball.name, curve.name}
    status, _, err, _ = press(ball, *QUICK, out=None)
    assert status == 2
    assert "Nothing would be written; add -o, --curve, --figure or --json." in err


def test_press_command_says_the_same_in_mesh_curve_figure_and_report(ball, press, tmp_path):
    curve, figure, report = tmp_path / "c.csv", tmp_path / "f.png", tmp_path / "r.json"
    status, said, err, out = press(ball, *QUICK, "--curve", curve, "--figure", figure, "--report", report)
    assert (status, err) == (0, "")
    U, lines, found = open_mesh(out).V, rows(curve), json.loads(report.read_text(encoding="utf-8"))
    assert np.ptp(U[:, 2]) <= 1.8 + 1e-9
    first = lines[0]["distance"]
    assert first > 2.0, "the plates touch, a wall's thickness away"
    assert [line["distance"] for line in lines] == pytest.approx(np.linspace(first, 1.8, 3))
    shape = trimesh.load(out, process=False)
    assert shape.volume == pytest.approx(lines[-1]["volume"], rel=1e-9)
    for name, value in lines[-1].items():
        assert found[name] == pytest.approx(value), name
    assert found["area_rest"] == pytest.approx(trimesh.load(ball, process=False).area, rel=1e-9)
    assert said.splitlines()[0] == f"{out}: plates 1.8 apart, 90.0 % of the extent"
    assert f"work {found['work']:.5g}" in said
    assert (tmp_path / "f.svg").exists()
    with Image.open(figure) as image:
        assert image.width > image.height


def test_press_command_captions_its_chart_by_the_conditions_of_its_newtons(
    smooth_ball, press, tmp_path, monkeypatch
):
    """The wall of its own method stretches as well: the caption says the phrase of the summary."""
    titles = []

    def draw(fill, size, folder, name):
        figure = Figure(figsize=size)
        fill(figure)
        titles.append(figure.axes[0].get_title().splitlines()[0])
        (folder / f"{name}.svg").touch()

    monkeypatch.setattr(curves, "draw_figure", draw)
    words = "--axis", "z", "--to", "99%", "--steps", 1, "--unit", "cm", "--thickness", "0.3mm", "--young", "1"
    words = *words, "--figure", tmp_path / "f.png"
    said = [press(smooth_ball, *words, *more)[1] for more in ((), ("--stiffness", 0.001, "--method", "arap"))]
    for summary, title in zip(said, titles, strict=True):
        conditions = title.removeprefix("Load, N, ")
        assert f" N above, {conditions}" in summary
    assert titles[0] == "Load, N, for this thin elastic wall"
    assert titles[1] != titles[0]


@pytest.mark.parametrize("method", ["exact", "local", "arap"])
def test_press_command_has_both_plates_carry_the_same_and_no_load_at_first(method, ball, press, tmp_path):
    words = "--curve", tmp_path / "c.csv", "--method", method
    assert press(ball, *QUICK, *words)[0] == 0
    lines = rows(tmp_path / "c.csv")
    assert all(line["settled"] for line in lines)
    assert all(line["crossings"] == 0 for line in lines)
    for line in lines[1:]:
        assert line["load_low"] == pytest.approx(line["load_high"], rel=0.01)
        assert line["load_low"] > 0.0
    assert lines[1]["load_low"] < lines[2]["load_low"]


@pytest.mark.parametrize(
    ("text", "distance"), [("60%", "60.0%"), (" 120/2 % ", "60.0%"), ("1.2", 1.2), ("6/5", 1.2)]
)
def test_parse_distance_takes_a_length_or_a_percentage(text, distance):
    assert press_command.parse_distance(text) == distance


def test_press_command_gives_an_open_surface_the_volume_within_its_caps(press, tmp_path):
    V, F = tube(16, 20)
    save_mesh(Mesh(V, F), V, tmp_path / "tube.off")
    curve = tmp_path / "c.csv"
    words = "--to", "80%", "--steps", 2, "--stiffness", 0.01, "--thickness", 0.02
    status, said, err, _ = press(tmp_path / "tube.off", *words, "--curve", curve)
    assert (status, err) == (0, "")
    first, *_, last = rows(curve)
    assert last["volume"] is None
    assert last["volume_capped"] < first["volume_capped"]
    assert "openings capped flat" in said
    assert first["distance"] == pytest.approx(np.ptp(V[:, 0]) + 0.04)


@pytest.mark.night
def test_press_command_writes_the_same_files_when_repeated(ball, press, tmp_path):
    for name in ("a", "b"):
        folder = tmp_path / name
        folder.mkdir()
        beside = "--curve", folder / "c.csv", "--figure", folder / "f.png", "--report", folder / "r.json"
        assert press(ball, *QUICK, *beside, out=folder / "o.off")[0] == 0
    for name in ("c.csv", "f.png", "f.svg", "r.json", "o.off"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes(), name


def test_press_command_says_progress_in_lines(ball, press, monkeypatch):
    clock = itertools.count()
    monkeypatch.setattr("time.monotonic", lambda: float(next(clock)))
    _, said, _, _ = press(ball, *QUICK, "--progress-lines")
    lines = [json.loads(line) for line in said.splitlines() if line.startswith("{")]
    done = [line["done"] for line in lines]
    assert len(done) > 5
    assert done == sorted(done)
    assert 0.0 < done[0] < done[-1] <= 1.0
    assert {line["doing"] for line in lines} == {"pressing"}


def test_press_command_counts_crossings_in_the_words_of_the_window(ball, press, monkeypatch):
    monkeypatch.setattr(plate_press, "crossings", lambda *_: np.arange(12))
    _, said, _, _ = press(ball, *QUICK)
    assert "12 intersecting triangles" in said.splitlines()


def test_press_command_names_steps_that_do_not_come_to_rest(ball, press, tmp_path):
    beside = "--curve", tmp_path / "c.csv", "--report", tmp_path / "r.json"
    _, said, _, _ = press(ball, *QUICK, "--iterations", 1, *beside)
    assert "Not every step came to rest" in said
    assert [line["settled"] for line in rows(tmp_path / "c.csv")] == [1.0, 0.0, 0.0]
    report = json.loads((tmp_path / "r.json").read_text(encoding="utf-8"))
    assert report["apparent_stiffness"] is None, "the plates have not moved"


def test_press_command_fills_in_the_wall_by_a_material_and_gives_loads_in_newtons_too(ball, press, tmp_path):
    """A ball of 2 cm of a wall of 0.3 mm: mass, yield radius, newtons in table, report and summary."""
    curve, report = tmp_path / "c.csv", tmp_path / "r.json"
    words = "--unit", "cm", "--material", "pet-bottle", "--curve", curve, "--report", report
    status, said, err, _ = press(ball, *QUICK, *words)
    assert (status, err) == (0, "")
    lines, found = rows(curve), json.loads(report.read_text(encoding="utf-8"))
    area = found["area_rest"]
    assert found["mass_grams"] == pytest.approx(area * 0.03 * 1.36)
    assert found["yield_radius"] == pytest.approx(0.03 / (2 * 0.0175))
    rigidity = 3.4e9 * 0.3e-3**3 / (12 * (1 - 0.38**2))
    per_load = rigidity / (2 * 0.001 * area * 0.01)
    for line in lines:
        assert line["load_low_newton"] == pytest.approx(per_load * line["load_low"])
        assert line["load_high_newton"] == pytest.approx(per_load * line["load_high"])
    assert found["apparent_stiffness_newton_per_mm"] == pytest.approx(
        per_load * found["apparent_stiffness"] / 10.0
    )
    assert found["work_joule"] == pytest.approx(per_load * found["work"] * 0.01)
    assert f"{found['load_low_newton']:.3g} N below" in said
    assert "Callister" in said
    assert found["stiffness_of_wall"] == pytest.approx(0.03**2 / (6 * (1 - 0.38**2) * area))


@pytest.mark.night
def test_press_command_takes_a_wall_distribution_for_its_thickness(ball, press, tmp_path):
    """In centimetres or millimetres it is the same wall, with the mass of its mean, and other loads."""
    reports = []
    walls, report = tmp_path / "walls.csv", tmp_path / "r.json"
    for text in (
        "z,thickness\n-1,0.02\n1,0.04\n",
        "z,thickness (mm)\n-1,0.2\n1,0.4\n",
        "z,thickness\n0,0.03\n",
        "z,thickness,young,yield_radius\n0,0.03,3.4,1\n1,0.03,3.4,2\n",
        "z,thickness,young (MPa)\n-1,0.03,2000\n1,0.03,4000\n",
    ):
        walls.write_text(text)
        words = "--unit", "cm", "--material", "pet-bottle", "--method", "wall", "--thickness", walls
        status, _, err, _ = press(ball, *QUICK[:-2], *words, "--report", report)
        assert (status, err) == (0, "")
        reports.append(json.loads(report.read_text(encoding="utf-8")))
    one, same, even, creasing, graded = reports
    for name in ("mass_grams", "load_low_newton", "wall_thickness_least", "yield_radius"):
        assert one[name] == pytest.approx(same[name], rel=1e-4), "millimetres round otherwise"
    assert one["mass_grams"] == pytest.approx(one["area_rest"] * 0.03 * 1.36, rel=1e-3)
    assert 0.02 < one["wall_thickness_least"] < 0.022 < 0.038 < one["wall_thickness_most"] < 0.04
    assert one["load_low_newton"] != pytest.approx(even["load_low_newton"], rel=1e-3)
    assert (creasing["young"], creasing["young_least"]) == (3.4e9, 3.4e9)
    assert 1.0 == creasing["yield_radius_least"] < creasing["yield_radius"] < 2.0
    assert graded["young"] == pytest.approx(3e9, rel=1e-3)
    assert graded["young_least"] < 2.2e9 < 3.8e9 < graded["young_most"]
    assert graded["mass_grams"] == pytest.approx(even["mass_grams"], rel=1e-6)
    walls.write_text("vertex,thickness\n0,0.03\n")
    status, _, err, _ = press(ball, *QUICK[:-2], *words, "--report", report)
    assert (status, err.count("\n")) == (2, 1)
    assert "walls.csv: It has 1 rows" in err


def test_press_command_takes_the_wall_itself_where_its_thickness_and_modulus_are_known(press, tmp_path):
    """A ring of 60 mm with a wall of 0.3 mm: the load of an inextensional ring in newtons."""
    V, F = tube(60, 2)
    save_mesh(Mesh(V, F), 30.0 * V, tmp_path / "ring.obj")
    known = "--unit", "mm", "--material", "pet-bottle", "--young", "3.4GPa", "--poisson", 0
    curve = tmp_path / "c.csv"
    status, said, err, _ = press(
        tmp_path / "ring.obj", "--axis", "x", "--to", "50%", "--steps", 2, *known, "--curve", curve
    )
    assert (status, err) == (0, "")
    assert "for this thin wall that keeps creases" in said
    last, width = rows(curve)[-1], 0.03 * np.ptp(V[:, 2])
    rigidity = 3.4e9 * 0.3e-3**3 / 12.0
    gap = 1e-3 * (last["distance"] - 2.0 * 0.08)  # less what the plates keep, about
    for side in ("low", "high"):
        assert last[f"load_{side}_newton"] == pytest.approx(5.742160 * rigidity * width / gap**2, rel=0.02)
    assert last["newton_factor"] == pytest.approx(1.0)
    assert last["load_excess_percent"] == 0.0


def test_press_command_says_of_a_wall_that_gave_way_how_uncertain_it_is(press, tmp_path, monkeypatch):
    V, F = tube(30, 2)
    save_mesh(Mesh(V, F), 30.0 * V, tmp_path / "ring.obj")
    words = "--axis", "x", "--to", "90%", "--steps", 2, "--unit", "mm", "--material", "pet-bottle"

    def uncertain(*more):
        status, said, _, _ = press(tmp_path / "ring.obj", *words, *more)
        assert status == 0
        return "depend on small imperfections" in said

    assert not uncertain()  # the load of a ring rises
    monkeypatch.setattr(pressed_mesh, "load_curve", lambda x, y: LoadCurve(y[1], x[1], 1.0, 1.0))
    assert uncertain()
    assert not uncertain("--method", "exact", "--stiffness", 0.01)


@pytest.mark.night
def test_press_command_tells_the_band_of_several_runs(press, tmp_path):
    """Table, report and summary say the same; the mesh that is written is of the first run."""
    V, F = can(24, 1.0)
    save_mesh(Mesh(V, F), 30.0 * V, tmp_path / "can.obj")
    wall = "--unit", "mm", "--material", "pet-bottle", "--thickness", "2mm", "--dents", 30
    words = tmp_path / "can.obj", "--axis", "z", "--to", "93%", "--steps", 5, *wall
    table, report = tmp_path / "band.csv", tmp_path / "band.json"
    status, said, _, out = press(*words, "--runs", 2, "--curve", table, "--report", report)
    assert status == 0
    first, (_, alone, _, own) = out.read_bytes(), press(*words, out=tmp_path / "alone.off")
    assert "2 runs, each with other dents of 30 % of the wall thickness" in said
    assert "each with other dents" not in alone
    assert "add --runs 10" in alone
    assert "add --runs 10" not in said
    assert first == own.read_bytes()
    found, band = rows(table), json.loads(report.read_text(encoding="utf-8"))["band"]
    assert [row["run"] for row in found] == 6 * [1] + 6 * [2]
    for k, load in enumerate(band["yield_loads_newton"]):
        loads = [
            0.5 * (row["load_low_newton"] + row["load_high_newton"]) for row in found if row["run"] == k + 1
        ]
        assert max(loads) == pytest.approx(load, rel=1e-9)
    assert band["radius_over_thickness"] == pytest.approx(15.0, rel=1e-3)
    places = [f"{100.0 * place:.0f}" for place in sorted(band["buckle_heights"])]
    assert f"the first buckle comes at {' to '.join(dict.fromkeys(places))} % of the height" in said
    assert all(0.0 <= place <= 1.0 for place in band["buckle_heights"])
    share = [100.0 * load / band["classical_load"] for load in sorted(band["yield_loads"])]
    assert f"the runs yield at {share[0]:.0f} to {share[1]:.0f} % of it" in said
    assert f"count on {100.0 * band['knock_down_factor']:.0f} % of that, at R/t 15." in said


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--drop", "1m"), "A drop needs a weight; add --weight such as 2kg."),
        (("--weight", "2kg"), "A weight needs newtons; add --material, or --thickness and --young."),
    ],
)
def test_press_command_says_which_weights_there_are(words, sentence, ball, press):
    status, _, said, _ = press(ball, "--to", 1.8, *words)
    assert status != 0
    assert said.strip() == f"error: {sentence}"


def test_press_command_says_at_which_deflection_a_weight_is_borne(smooth_ball, press, tmp_path):
    report = tmp_path / "r.json"
    known = "--unit", "cm", "--thickness", "0.3mm", "--young", "3.4GPa", "--to", "97%", "--steps", 2

    def found(*words):
        status, said, _, _ = press(smooth_ball, *known, *words, "--report", report)
        assert status == 0
        return said, json.loads(report.read_text(encoding="utf-8"))

    said, kilogram = found("--weight", "0.1kg", "--drop", "1mm")
    assert f"at rest: deflection {kilogram['weight_deflection']:.4g}\xa0cm" in said
    assert kilogram["weight_newton"] == pytest.approx(0.980665)
    assert kilogram["weight_deflection"] < kilogram["drop_deflection"]
    _, newton = found("--weight", "0.980665N")
    assert newton["weight_deflection"] == pytest.approx(kilogram["weight_deflection"], rel=1e-9)
    said, none = found("--weight", "9000kg")
    assert none["weight_deflection"] is None
    assert "never borne" in said


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--runs", 0), "The number of runs must be a whole number from 1 to 1,000."),
        (("--dents", -1), "The depth of the dents must be above 0 and at most 1000 % of the wall thickness."),
        (("--dents", 5), "Dents are of a thin wall; add --method wall and --thickness."),
        (("--runs", 2), "Dents are of a thin wall; add --method wall and --thickness."),
    ],
)
def test_press_command_says_which_runs_and_dents_there_are(words, sentence, ball, press):
    status, _, said, _ = press(ball, "--to", 1.8, *words)
    assert status != 0
    assert said.strip() == f"error: {sentence}"


@pytest.mark.parametrize(
    ("words", "named"),
    [
        ((), "for this thin elastic wall"),
        (("--yield-radius", "4mm"), "for this thin wall that keeps creases"),
    ],
)
def test_press_command_names_the_wall_that_its_newtons_are_of(ball, press, words, named):
    known = "--unit", "cm", "--thickness", "0.3mm", "--young", "3.4GPa"
    status, said, err, _ = press(ball, "--to", "98%", "--steps", 1, *known, *words)
    assert (status, err) == (0, "")
    assert named in said


def test_press_command_tells_the_expected_excess_beside_the_load(smooth_ball, press, tmp_path):
    """0.75 h^2 over D = 2 stiffness area; the edges of a ball are nearly alike. A tenth of it for local."""
    mesh = trimesh.load(smooth_ball, process=False)
    square = (mesh.edges_unique_length**2).mean()
    curve, report = tmp_path / "c.csv", tmp_path / "r.json"
    for method, weight in (("exact", 1.0), ("local", 0.1)):
        words = "--method", method, "--curve", curve, "--report", report
        _, said, _, _ = press(smooth_ball, *QUICK, *words)
        lines, found = rows(curve), json.loads(report.read_text(encoding="utf-8"))
        known = 100.0 * weight * 0.75 * square / (2 * 0.001 * mesh.area)
        assert found["load_excess_percent"] == pytest.approx(known, rel=0.05)
        assert [line["load_excess_percent"] for line in lines] == [found["load_excess_percent"]] * len(lines)
        said = re.search(r"load .* above .*; expected excess of loads ([\d.]+) %", said)
        assert float(said[1]) == pytest.approx(found["load_excess_percent"], rel=0.05)


def test_press_command_without_stiffness_says_no_excess_but_that_loads_mean_little(ball, press, tmp_path):
    report = tmp_path / "r.json"
    _, said, _, _ = press(ball, *QUICK, "--stiffness", 0, "--report", report)
    assert json.loads(report.read_text(encoding="utf-8"))["load_excess_percent"] is None
    assert "loads mean little" in said


def test_newton_conversion_of_a_shape_that_has_to_stretch_says_how_much_too_low_they_may_be(
    smooth_ball, press, tmp_path
):
    """A ball resists by the root of D E t: by the root of how much stiffer it was pressed than it is."""
    curve, report = tmp_path / "c.csv", tmp_path / "r.json"
    words = "--unit", "cm", "--material", "pet-bottle", "--curve", curve, "--report", report
    _, said, _, _ = press(smooth_ball, *QUICK, *words)
    found = json.loads(report.read_text(encoding="utf-8"))
    assert found["stretching_percent"] == pytest.approx(50.0, abs=4.0)
    root = (0.001 / found["stiffness_of_wall"]) ** 0.5
    assert found["newton_factor"] == pytest.approx(root, rel=0.1)
    assert rows(curve)[-1]["newton_factor"] == pytest.approx(found["newton_factor"])
    factor = f"up to {found['newton_factor']:.2g} times too low"
    assert f" N above, {factor}\n" in said
    assert "Stretching takes up to" in said
    assert "hardly stretch" not in said


@pytest.mark.night
def test_newton_conversion_of_a_tube_pressed_flat_needs_no_factor_and_along_its_axis_does(press, tmp_path):
    V, F = tube(24, 10, height=1.5)
    save_mesh(Mesh(V, F), V, tmp_path / "tube.off")
    report = tmp_path / "r.json"
    words = "--steps", 2, "--stiffness", 0.001, "--unit", "cm", "--material", "pet-bottle", "--report", report
    _, said, _, _ = press(tmp_path / "tube.off", "--axis", "x", "--to", "70%", *words)
    assert json.loads(report.read_text(encoding="utf-8"))["newton_factor"] == 1.0
    assert "if walls bend and hardly stretch" in said
    assert "too low" not in said
    _, said, _, _ = press(tmp_path / "tube.off", "--axis", "z", "--to", "99%", *words)
    found = json.loads(report.read_text(encoding="utf-8"))
    assert found["stretching_percent"] > 90.0
    assert found["newton_factor"] > (0.001 / found["stiffness_of_wall"]) ** 0.9
    assert "times too low" in said


def test_newton_conversion_is_not_said_where_it_is_not_known(ball, press, tmp_path):
    curve, report = tmp_path / "c.csv", tmp_path / "r.json"
    for words in ((), ("--unit", "cm", "--thickness", "0.3mm"), ("--unit", "cm", "--material", "fabric")):
        status, said, _, _ = press(ball, *QUICK, *words, "--curve", curve, "--report", report)
        assert status == 0
        assert "newton" not in curve.read_text(encoding="utf-8") + report.read_text(encoding="utf-8")
        assert " N below" not in said


def test_press_command_takes_what_is_typed_before_what_a_material_has(ball, press, tmp_path):
    report = tmp_path / "r.json"
    words = "--thickness", "0.5mm", "--young", "2GPa", "--poisson", 0.3, "--density", "900 kg/m3"
    words += "--yield-radius", "4mm", "--unit", "mm", "--material", "hdpe"
    assert press(ball, *QUICK, *words, "--thickness", "0.05", "--report", report)[0] == 0
    found = json.loads(report.read_text(encoding="utf-8"))
    assert (found["young"], found["poisson"], found["wall_thickness"]) == (2e9, 0.3, 0.05)
    assert found["density"] == pytest.approx(0.9)
    assert found["yield_radius"] == pytest.approx(4.0)


def test_press_command_keeps_the_volume_by_gas_whose_pressure_may_be_in_atmospheres(ball, press, tmp_path):
    report, volumes, gas = tmp_path / "r.json", [], []
    wall = "--unit", "cm", "--material", "pet-bottle"
    for words in ((), ("--gas", "1atm"), ("--gas", "101.325 kPa"), ("--gas", "30")):
        assert press(ball, *QUICK, *wall, *words, "--report", report)[0] == 0
        found = json.loads(report.read_text(encoding="utf-8"))
        volumes.append(found["volume"] / found["volume_rest"])
        gas.append(found["gas"])
    assert gas[0] is None
    known = 101_325 * 1e-4 / found["newtons_per_load"] * found["volume_rest"] / found["area_rest"]
    assert gas[1:] == pytest.approx([known, known, 30.0])
    assert volumes[0] < volumes[1] < 1.0
    assert volumes[2] == volumes[1]


@pytest.mark.night
def test_press_command_holds_a_pressure_of_its_wall(ball, press, tmp_path):
    """In the report it is that of a wall of Young's modulus times thickness 4."""
    report, volumes = tmp_path / "r.json", []
    wall = "--unit", "cm", "--thickness", "0.3mm", "--young", "3GPa", "--method", "wall"
    for words in (("--pressure", "-2kPa"), (), ("--pressure", "20mbar")):
        status, said, *_ = press(ball, *QUICK, *wall, *words, "--report", report)
        found = json.loads(report.read_text(encoding="utf-8"))
        volumes.append(found["volume"])
        assert status == 0
        assert ("a constant pressure of" in said) == ("pressure_pascal" in found) == bool(words)
    assert "inside  a constant pressure of 20 mbar\n" in said
    assert found["pressure_pascal"] == pytest.approx(2000.0)
    assert found["pressure"] == pytest.approx(2000.0 * 4.0 / (3e9 * 0.03))
    assert volumes[0] < volumes[1] < volumes[2]


WRONG = {
    "pressure of no unit": (["--pressure", "0.1"], "A pressure needs a unit"),
    "pressure in newtons of no wall": (["--pressure", "30mbar"], "add --material"),
    "gas of no pressure": (["--gas", "0"], "greater than 0"),
    "gas in a unit that is none": (["--gas", "1 kg"], "use kPa, bar, atm"),
    "gas in newtons of no wall": (["--gas", "1atm"], "add --material"),
    "a material without a unit": (["--material", "paper"], "add --unit"),
    "a material that is none": (["--material", "wood", "--unit", "cm"], "choose one of pet-bottle"),
    "newtons without a wall": (["--young", "2GPa", "--unit", "cm"], "add --thickness"),
    "newtons without a unit": (["--young", "2GPa", "--thickness", "0.01"], "add --unit"),
    "newtons of cloth": (
        ["--young", "2GPa", "--thickness", "0.01", "--unit", "cm", "--stiffness", "0", "--method", "exact"],
        "add --method wall",
    ),
    "a modulus": (["--young", "hard", "--thickness", "0.01", "--unit", "cm"], "is not a unit of Young"),
    "a ratio": (["--poisson", "0.7", "--unit", "cm"], "from 0 to 0.5"),
    "a density": (["--density", "0"], "out of range"),
    "a thickness in a unit": (["--thickness", "0.3mm"], "add --unit"),
    "a letter that is no axis": (["--axis", "w"], "is not a direction"),
    "two numbers": (["--axis", "1 0"], "is not a direction"),
    "a direction without length": (["--axis", "0 0 0"], "is not a direction"),
    "a distance of nothing": (["--to", "0"], "greater than 0"),
    "a distance that is negative": (["--to=-5%"], "greater than 0"),
    "plates that do not touch": (["--to", "120%"], "enter a smaller distance"),
    "a distance that is no number": (["--to", "half"], "is unknown"),
    "a method that cannot touch": (["--method", "paper"], "paper"),
    "a method that is none": (["--method", "x"], "x"),
    "stiffness": (["--stiffness", "-1"], "stiffness must be"),
    "no stiffness": (["--stiffness", "nan"], "stiffness must be"),
    "steps": (["--steps", "0"], "from 1 to 1,000"),
    "iterations": (["--iterations", "0"], "at least 1"),
    "a thickness of nothing": (["--thickness", "0"], "greater than 0"),
    "walls thicker than the mesh": (["--thickness", "3"], "check the unit"),
}


@pytest.mark.parametrize("case", WRONG)
def test_press_command_says_what_is_wrong_in_a_line_and_writes_nothing(case, ball, press, tmp_path):
    words, sentence = WRONG[case]
    before = sorted(tmp_path.rglob("*"))
    beside = "--curve", tmp_path / "c.csv", "--figure", tmp_path / "f.png", "--report", tmp_path / "r.json"
    status, out, err, _ = press(ball, *QUICK, *words, *beside)
    assert (status, out) == (2, "")
    assert re.fullmatch(r"error: .+\n", err)
    assert sentence in err
    assert sorted(tmp_path.rglob("*")) == before


def test_press_command_names_a_file_to_be_written_twice(ball, press, tmp_path):
    same = tmp_path / "same.txt"
    status, out, err, written = press(ball, *QUICK, "--curve", same, "--report", same)
    assert (status, out) == (2, "")
    assert err == "error: same.txt would be written twice; give each file a name of its own.\n"
    assert not same.exists()
    assert not written.exists()


@pytest.mark.parametrize("option", ["--curve", "--figure", "--report"])
def test_press_command_names_a_folder_in_place_of_a_file_at_once(option, ball, press, tmp_path, monkeypatch):
    monkeypatch.setattr(press_command, "PlatePress", None)  # nothing is pressed before
    (tmp_path / ("folder.svg" if option == "--figure" else "folder.png")).mkdir()
    status, out, err, written = press(ball, *QUICK, option, tmp_path / "folder.png")
    assert (status, out) == (2, "")
    assert "(it is a folder)" in err
    assert not written.exists()


@pytest.mark.parametrize("option", ["--curve", "--figure", "--report"])
def test_press_command_names_a_folder_that_is_not_there_at_once(option, ball, press, tmp_path, monkeypatch):
    before = sorted(tmp_path.rglob("*"))
    monkeypatch.setattr(press_command, "PlatePress", None)  # nothing is pressed before
    status, out, err, _ = press(ball, *QUICK, option, tmp_path / "gone" / "file.png")
    assert (status, out) == (2, "")
    assert err == f"error: There is no folder {tmp_path / 'gone'}; create it or choose another.\n"
    assert sorted(tmp_path.rglob("*")) == before


def test_press_command_refuses_a_mesh_of_an_unknown_kind_before_anything_is_pressed(ball, press, tmp_path):
    status, _, err, _ = press(ball, *QUICK, out=tmp_path / "a.xyz")
    assert status == 2
    assert "supported ending" in err


def test_press_command_leaves_nothing_when_interrupted(ball, press, tmp_path, monkeypatch):
    before = sorted(tmp_path.rglob("*"))

    def stop(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(press_command.Progress, "show", stop)
    assert press(ball, *QUICK, "--curve", tmp_path / "c.csv")[0] == 130
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize("radius", [pytest.param(None, marks=pytest.mark.night), 4.0])
def test_press_command_writes_what_remains_of_creases(press, tmp_path, radius):
    """The plates open until they no longer touch; without creases all springs back."""
    (V, F), ball = sphere(2), tmp_path / "fine.off"
    save_mesh(Mesh(V, F), V, ball)
    words = "--axis", "z", "--to", "60%", "--steps", 2, "--stiffness", 0.002, "--release"
    curve, report = tmp_path / "c.csv", tmp_path / "r.json"
    words += () if radius is None else ("--yield-radius", radius)
    crushed = tmp_path / "crushed.off"
    status, said, _, out = press(ball, *words, "--curve", curve, "--report", report, "--crushed", crushed)
    assert status == 0
    lines, found = rows(curve), json.loads(report.read_text(encoding="utf-8"))
    assert [line["opening"] for line in lines][:4] == [0, 0, 0, 1]
    assert max(lines[-1]["load_low"], lines[-1]["load_high"]) <= 1e-9 * lines[2]["load_low"]
    between = trimesh.load(crushed, process=False)
    assert between.volume == pytest.approx(lines[2]["volume"], rel=1e-9)
    assert np.ptp(between.vertices[:, 2]) == pytest.approx(1.2, abs=0.01)
    volume = trimesh.load(out, process=False).volume
    assert found["volume"] == pytest.approx(volume, rel=1e-9)
    assert "remain" in said
    whole = trimesh.load(ball, process=False).volume
    assert volume < 0.99 * whole if radius else volume == pytest.approx(whole, rel=1e-4)


def test_press_command_begins_from_the_shape_of_a_session(press, tmp_path):
    """A flattened tube springs back first, and less where its bends keep creases."""
    V, F = tube(24, 12)
    path = tmp_path / "tube.off"
    save_mesh(Mesh(V, F), V, path)
    mesh = open_mesh(path)
    state = initial_state(mesh)
    flat = V * (1.0, 0.5, 1.0)
    U = flat * np.array([1.0, 1.0, 0.0]) * (face_areas(V, F).sum() / face_areas(flat, F).sum()) + V * (
        0,
        0,
        1,
    )
    save_session(tmp_path / "flat.apd", state.updated(frame=replace(state.frame, U=U)), View())
    widths = []
    for radius in ((), ("--yield-radius", 4.0)):
        words = "--axis", "y", "--to", "50%", "--steps", 1, "--stiffness", 0.01
        curve = tmp_path / "c.csv"
        assert press(tmp_path / "flat.apd", *words, *radius, "--curve", curve)[0] == 0
        widths.append(rows(curve)[0]["distance"])
    assert widths[0] == pytest.approx(np.ptp(V[:, 1]), rel=0.01)
    assert 1.2 < widths[1] < 0.97 * widths[0]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--yield-radius", 0], "greater than 0"),
        (["--yield-radius", 2, "--stiffness", 0], "enter a stiffness, too"),
    ],
)
def test_press_command_says_in_one_sentence_that_a_yield_radius_cannot_be(words, sentence, ball, press):
    status, _, said, out = press(ball, *QUICK, *words)
    assert status == 2
    assert sentence in said
    assert len(said.splitlines()) == 1
    assert not out.exists()


def test_press_refuses_an_impossible_imperfection_or_seed(ball, press):
    for words, sentence in (
        (("--imperfection", 2), "The imperfection must be a number from 0 to 0.1, such as 1e-4."),
        (("--seed", -1), "The seed must be a whole number from 0 to 1,000,000."),
    ):
        status, _, err, mesh = press(ball, "--to", "90%", *words)
        assert status == 2
        assert sentence in err
        assert not mesh.exists()
