"""The worked example of the manual: a bottle is twisted, crushed and weighed by its own command lines.

To save time it is pressed in one step, and not as flat. That its commands are understood is tested with those
of all pages.
"""

import json
import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest
from crossing_check import CrossingCheck

from apd_viewer.__main__ import main
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.presentation.volume_text import PUBLISHED_VOLUMES

ROOT = Path(__file__).parents[2]
CHAPTER = (ROOT / "docs/howto/bottle.md").read_text(encoding="utf-8")
BLOCK, TABLE = CHAPTER.split("```")[1], CHAPTER.split("```")[2]
SHORTER = {"50%": "92%", "5": "1"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Folder with all files after the commands, and what the last one printed."""
    folder = tmp_path_factory.mktemp("example")
    for name in ("bottle.obj", "bottle.sel", "bottle-twist-180.def"):
        shutil.copy(ROOT / "resources" / name, folder)
    return folder


def commands():
    return [shlex.split(line)[1:] for line in BLOCK.splitlines() if line.startswith("apd-viewer")]


def numbers(text):
    return [float(word.replace(",", "")) for word in re.findall(r"\d[\d,.]*", text)]


@pytest.mark.night
def test_worked_example_runs_its_commands_and_they_print_the_quantities_of_its_table(
    folder, monkeypatch, capsys
):
    monkeypatch.chdir(folder)
    twist, press, volumes = commands()
    assert main(twist) == 0
    assert main([SHORTER.get(word, word) for word in press] + ["--report", "press.json"]) == 0
    capsys.readouterr()
    assert main([*volumes, "--json", "volumes.json"]) == 0
    said = capsys.readouterr().out
    found = json.loads((folder / "volumes.json").read_text(encoding="utf-8"))
    pressed = json.loads((folder / "press.json").read_text(encoding="utf-8"))
    check_shapes(folder)
    assert pressed["settled"]
    assert pressed["crossings"] == 0
    assert pressed["load_low"] == pytest.approx(pressed["load_high"], rel=0.01)
    assert pressed["load_low_newton"] > 0.0
    assert f"{pressed['mass_grams']:.1f} g" in CHAPTER
    check_volumes(found)
    check_table(said, found)


def test_worked_example_names_in_its_table_what_is_printed(folder, monkeypatch, capsys):
    """With a bottle that is drawn together instead of twisted and crushed, which takes half a minute."""
    monkeypatch.chdir(folder)
    rest = open_mesh("bottle.obj")
    save_mesh(rest, rest.V * [0.9, 1.0, 0.9], "crushed.obj")
    *_, volumes = commands()
    assert main([*volumes, "--json", "volumes.json"]) == 0
    check_table(capsys.readouterr().out, json.loads(Path("volumes.json").read_text(encoding="utf-8")))


def check_shapes(folder):
    """The area stays on the way, and no wall is crossed."""
    rest, twisted, crushed = (
        open_mesh(folder / name) for name in ("bottle.obj", "twisted.obj", "crushed.obj")
    )
    area = face_areas(rest.V, rest.F).sum()
    for mesh in (twisted, crushed):
        assert face_areas(mesh.V, mesh.F).sum() == pytest.approx(area, rel=1e-6)  # digits of the file
        assert not CrossingCheck(rest.V, rest.F).crosses(mesh.V)
    assert np.ptp(crushed.V[:, 0]) < 0.93 * np.ptp(rest.V[:, 0])


def check_volumes(found):
    """Each quantity by its own name, all down but the material."""
    for name in ("enclosed_volume", "hull_volume", "bulk_volume", "packed_volume", "minimum_width"):
        assert found[name] < 0.97 * found[f"{name}_rest"], name
    assert found["bulk_volume"] == pytest.approx(found["hull_volume"] / 0.64)
    assert found["objects_in_bag"] > found["objects_in_bag_rest"]
    assert found["material_volume"] == pytest.approx(found["material_volume_rest"], rel=1e-6)
    assert set(found["published"]) == {quantity.value for quantity in PUBLISHED_VOLUMES}


def check_table(said, found):
    """The manual names the quantities that are printed, in their order, with what they are at rest."""
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in TABLE.splitlines() if "|" in line][
        2:
    ]
    places = [said.index(f"\n{title}") for title, *_ in rows]
    assert places == sorted(places)
    for title, rest, *_ in rows:
        line = re.search(rf"\n{re.escape(title)}\s+(.*)", said)[1]
        after = re.sub(r"\([^)]*\)", "", line).split(" of ", 1)[1]
        assert numbers(after)[: len(numbers(rest))] == pytest.approx(numbers(rest), rel=1e-3), title
    assert found["enclosed_volume_rest"] == pytest.approx(500.0, rel=1e-4)
