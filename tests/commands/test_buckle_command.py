"""The command that finds buckling modes, and the options that it shares with other commands."""

import json
import re

import numpy as np
import pytest
from meshes import can
from PIL import Image

from apd_viewer.__main__ import main
from apd_viewer.commands import buckle_command
from apd_viewer.commands.terminal.mesh_options import parse_axis
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh

WALL = "--unit", "mm", "--material", "pet-bottle", "--thickness", "2mm"


@pytest.fixture
def buckle(tmp_path, capsys):
    """Run the command on a can 60 mm wide; return its status, what it said and its shape at rest."""
    V, F = can(32, 1.5)
    save_mesh(Mesh(V, F), 30.0 * V, tmp_path / "can.obj")

    def run(*words):
        status = main(["buckle", str(tmp_path / "can.obj"), *map(str, words)])
        said = capsys.readouterr()
        return status, said.out, said.err, 30.0 * V

    return run


def test_buckle_command_writes_and_says_the_modes_of_a_can(buckle, tmp_path):
    out, report, figure = tmp_path / "mode.off", tmp_path / "modes.json", tmp_path / "modes.png"
    files = "-o", out, "--json", report, "--figure", figure
    status, said, err, V = buckle("--axis", "z", "--modes", 2, *WALL, *files)
    assert (status, err) == (0, "")
    found = json.loads(report.read_text(encoding="utf-8"))
    assert found["buckling_loads"][0] / found["classical_load"] == pytest.approx(0.9, abs=0.1)
    assert f"mode 1 buckles at {found['buckling_loads_newton'][0]:,.0f} N" in re.sub(r"[ \xa0]+", " ", said)
    assert not re.search("^ ", said, re.MULTILINE), "nothing is above which a line could stand aligned"
    size = np.linalg.norm(np.ptp(V, axis=0))
    assert {path.name for path in tmp_path.glob("mode*.off")} == {"mode-1.off", "mode-2.off"}
    for number in (1, 2):
        U = open_mesh(tmp_path / f"mode-{number}.off").V
        assert np.linalg.norm(U - V, axis=1).max() == pytest.approx(0.03 * size, rel=1e-3)
    assert figure.exists() or "not drawn" in said


def test_buckle_command_takes_the_wall_of_the_press_and_needs_no_file(buckle, tmp_path):
    """Twice as thick a wall has about eight times the bending, and buckles at about four times the load."""
    loads = []
    for thickness in ("1mm", "2mm"):
        assert buckle(*("--axis", "z", *WALL[:-1], thickness), "--json", tmp_path / "m.json")[0] == 0
        loads.append(json.loads((tmp_path / "m.json").read_text(encoding="utf-8"))["buckling_loads_newton"])
    assert [len(each) for each in loads] == [4, 4]
    assert loads[1][0] / loads[0][0] == pytest.approx(4.0, rel=0.25)


@pytest.mark.parametrize("up", ["z", "-x"])
def test_buckle_command_draws_the_mesh_upright_with_arrows_along_the_axis(buckle, tmp_path, up, monkeypatch):
    asked = {}

    def draw(_, pictures, size, look, above, **how):
        asked.update(how, look=look, up=above, size=size, words=pictures[0].captions)
        return True

    monkeypatch.setattr(buckle_command, "draw_shapes", draw)
    status, *_, V = buckle("--axis", "x", "--modes", 5, f"--up={up}", "--figure", tmp_path / "f.png")
    assert status == 0
    assert asked["up"] == tuple(parse_axis(up))
    assert 0.0 < np.dot(asked["look"], asked["up"]) < np.linalg.norm(asked["look"]), (
        "seen from a little above"
    )
    assert [title for title, _ in asked["words"]] == [f"mode {k}" for k in (1, 2, 3, 4)]
    for (tail, tip), way, end in zip(
        asked["arrows"], (1.0, -1.0), (V.min(axis=0), V.max(axis=0)), strict=True
    ):
        np.testing.assert_allclose((tip - tail) / np.linalg.norm(tip - tail), [way, 0.0, 0.0], atol=1e-12)
        assert (end - tip)[0] * way > 0.0, "it ends before the mesh"


@pytest.mark.night
def test_buckle_command_draws_letters_legible_at_half_the_size(buckle, tmp_path):
    """A digit of the load is at least 12 pixels high in a picture twice as wide as a dialog."""
    figure = tmp_path / "f.png"
    _, said, *_ = buckle("--axis", "z", "--modes", 4, *WALL, "--figure", figure)
    assert figure.exists(), said
    with Image.open(figure) as image:
        dark = np.asarray(image.convert("L")) < 160
    rows = np.flatnonzero(dark[int(0.86 * len(dark)) :, : dark.shape[1] // 8].any(axis=1))
    assert np.ptp(rows) + 1 >= 16


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--modes", 0), "The number of modes must be a whole number from 1 to 50."),
        (("--axis", "0 0 0"), "is not a direction"),
        (("--figure", "f.svg"), "f.svg does not have the ending of a picture; use .png."),
        (("-o", "mode.off", "--figure", "gone/f.png"), "There is no folder"),
        (("--material", "pet-bottle"), "A material needs the unit of the mesh"),
    ],
)
def test_buckle_command_says_what_is_wrong_in_a_line_and_writes_nothing(words, sentence, buckle, tmp_path):
    before = sorted(tmp_path.rglob("*"))
    status, out, err, _ = buckle(*words)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert sentence in err
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize("text", ["z", "Z", " z ", "+Z", "0 0 2", "0,0,1", "0, 0, 0.5"])
def test_parse_axis_takes_a_letter_or_three_numbers(text):
    np.testing.assert_array_equal(parse_axis(text) / max(parse_axis(text)), [0, 0, 1])
    assert text.strip("+ ").lower() != "z" or np.array_equal(parse_axis("-z"), -parse_axis(text))
