"""Volumes in units given to the commands."""

import json

import numpy as np
import pytest
from meshes import box

from apd_viewer.__main__ import main
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.operators import volume
from apd_viewer.verification.case_meshes import disc, sewn_sheets


@pytest.fixture
def pouch(tmp_path, monkeypatch):
    """A flat pouch of two 18-gons with a radius of 5, its first vertex the base."""
    monkeypatch.chdir(tmp_path)
    V, F = sewn_sheets(*disc(3), 1e-3)
    mesh = Mesh(5.0 * V, F)
    save_mesh(mesh, mesh.V, tmp_path / "pouch.off")
    np.savetxt(tmp_path / "pouch.txt", np.arange(len(V)) > 0, fmt="%d")
    return tmp_path


def deform(words):
    return main(f"deform pouch.off --selection pouch.txt -o out.off {words}".split())


def test_deform_fills_a_flat_pouch_to_a_volume_in_a_unit(pouch):
    assert deform("--method wall --tension-field --unit cm --volume 0.1l --report r.json") == 0
    out = open_mesh(pouch / "out.off")
    assert volume(out.V, out.F) == pytest.approx(100.0, rel=1e-4)
    said = json.loads((pouch / "r.json").read_text(encoding="utf-8"))
    assert said["converged"]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ("--volume 100ml", "add --unit mm, cm, m, in or ft for ml"),
        ("--unit cm --volume 1l", "holds at most 179.5 cubic mesh units, as a ball"),
        ("--unit cm --volume 3cm", "enter a volume such as 250ml"),
        ("--method wall --pressure 30mbar", "add --young"),
        ("--method wall --pressure 30 --young 1GPa", "needs a unit"),
        ("--pressure 30mbar --young 1GPa", "Only the method Wall"),
        ("--method wall --pressure -30mbar --young 1GPa --no-contact", "Reduced pressure needs contact"),
        ("--method wall --pressure 30mbar --young 1GPa --volume 100", "exclude each other"),
    ],
)
def test_deform_refuses_a_volume_that_it_cannot_hold_or_read(pouch, capsys, words, sentence):
    assert deform(words) != 0
    assert sentence in capsys.readouterr().err


def test_deform_fills_a_flat_pouch_by_a_pressure_of_its_wall(pouch):
    """More pressure, more volume; a stiffer wall at the same share of its modulus has the same shape."""
    film, found = "--method wall --tension-field --wall-thickness 0.01", []
    for words in ("10mbar --young 1GPa", "0.02bar --young 2GPa", "1bar --young 1GPa"):
        assert deform(f"{film} --pressure {words}") == 0
        out = open_mesh(pouch / "out.off")
        found.append(volume(out.V, out.F))
    assert found[1] == pytest.approx(found[0], rel=1e-6)
    assert 0.9 * 1.2185 * 125.0 < found[0] < found[2]


def test_press_holds_a_volume_in_a_unit(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mesh = Mesh(*box(2, 2, 2))
    save_mesh(mesh, mesh.V, tmp_path / "box.off")
    words = "press box.off --axis z --to 1.9 --steps 1 --unit cm --volume 8ml --report r.json -o out.off"
    assert main(words.split()) == 0
    out = open_mesh(tmp_path / "out.off")
    assert volume(out.V, out.F) == pytest.approx(8.0, rel=1e-4)


def test_press_fills_a_flat_pouch_before_the_plates_touch_it(pouch, capsys):
    bag = "press pouch.off --unit cm --volume 100ml --method wall --tension-field --thickness 1mm"
    assert main(f"{bag} --axis z --to 80% --steps 2 --curve c.csv -o out.off".split()) == 0
    assert "80.0 % of the extent" in capsys.readouterr().out
    out = open_mesh(pouch / "out.off")
    assert volume(out.V, out.F) == pytest.approx(100.0, rel=1e-4)
    curve = np.genfromtxt(pouch / "c.csv", delimiter=",", names=True)
    assert curve["volume"] == pytest.approx(100.0, rel=1e-6)
    assert np.ptp(out.V[:, 2]) < 0.8 * curve["distance"][0]
    assert curve["distance"][0] > 1.0
