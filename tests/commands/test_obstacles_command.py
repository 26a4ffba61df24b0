"""Obstacles on the command line: a file of them, and sweeps of what they carry."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from meshes import tube

from apd_viewer.__main__ import main
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.view import View
from apd_viewer.session.storage.session_file import save_session

X = np.eye(3)[0]
PLATES = [
    {"kind": "plate", "place": [-1.01, 0, 0], "axis": [1, 0, 0]},
    {"kind": "plate", "place": [1.01, 0, 0], "axis": [-1, 0, 0], "shift": [-0.4, 0, 0]},
]


@pytest.fixture
def mesh(tmp_path):
    mesh = Mesh(*tube(12, 12))
    save_mesh(mesh, mesh.V, tmp_path / "tube.obj")
    return open_mesh(tmp_path / "tube.obj")


def command(*words):
    return main([str(word) for word in words])


def deformed(mesh, obstacles, folder, *more):
    (folder / "obstacles.json").write_text(json.dumps(obstacles))
    files = "--obstacles", folder / "obstacles.json", "-o", folder / "out.obj", "--report", folder / "r.json"
    return command("deform", mesh.path, "--stiffness", 0.001, *files, *more)


def test_deform_presses_what_nothing_holds_by_plates_of_a_file(mesh, tmp_path):
    assert not deformed(mesh, PLATES, tmp_path)
    said, U = json.loads((tmp_path / "r.json").read_text()), open_mesh(tmp_path / "out.obj").V
    assert np.ptp(U[:, 0]) == pytest.approx(1.62, abs=0.02)
    assert said["shifts"] == [[0, 0, 0], [-0.4, 0, 0]]
    low, high = np.array(said["loads"])
    assert high[0] > 1.0
    assert low[0] == pytest.approx(-high[0], rel=0.01)
    assert abs(said["area_error"]) <= 1e-9
    square = (trimesh.load(mesh.path, process=False).edges_unique_length ** 2).mean()
    assert said["load_excess_percent"] == pytest.approx(75.0 * square / (0.002 * said["area_rest"]), rel=0.25)


def test_deform_with_obstacles_has_the_contact_that_a_thickness_needs(mesh, tmp_path):
    assert not deformed(mesh, PLATES, tmp_path, "--thickness", 0.02)
    assert np.ptp(open_mesh(tmp_path / "out.obj").V[:, 0]) < 1.61  # between plates 1.62 apart


@pytest.mark.parametrize(
    ("obstacles", "words"),
    [
        ([{**PLATES[0], "kind": "cone"}], "kind"),
        ([{"kind": "sphere", "place": [0, 0, 0]}], "radius"),
        ({"kind": "plate"}, "obstacles"),
        ([{**PLATES[0], "place": [0, 0, 0]}], "intersects the initial shape"),
    ],
)
def test_deform_refuses_obstacles_that_cannot_be_used(obstacles, words, mesh, tmp_path, capsys):
    assert deformed(mesh, obstacles, tmp_path)
    assert words in capsys.readouterr().err
    assert not (tmp_path / "out.obj").exists()


def test_deform_needs_a_selection_without_obstacles(mesh, tmp_path, capsys):
    assert command("deform", mesh.path, "-o", tmp_path / "out.obj")
    assert "--selection" in capsys.readouterr().err


def squeezed(mesh) -> Document:
    """Nothing held, and a plate that moves towards another one."""
    plates = (
        NamedObstacle("Wall", ObstacleKind.PLATE, frozen(-1.01 * X), frozen(X)),
        NamedObstacle("Plate", ObstacleKind.PLATE, frozen(1.01 * X), frozen(-X)).with_shift(-0.4 * X),
    )
    document = initial_state(mesh).document.with_settings(stiffness=0.001, contact=True)
    return replace(document, obstacles=plates)


@pytest.mark.night
def test_sweep_of_obstacles_alone_tells_the_load_of_every_step(mesh, tmp_path):
    state = initial_state(mesh)
    save_session(tmp_path / "a.apd", state.updated(squeezed(mesh)), View())
    out = tmp_path / "swept"
    assert not command("sweep", tmp_path / "a.apd", "--steps", 8, "--methods", "exact", "-o", out)
    rows = list(csv.DictReader((out / "sweep.csv").read_text().splitlines()))
    (excess,) = {float(row["load_excess_percent"]) for row in rows}
    square = (trimesh.load(mesh.path, process=False).edges_unique_length ** 2).mean()
    assert excess == pytest.approx(75.0 * square / (0.002 * state.inspection.area), rel=0.25)
    load = np.array([[float(row["load_1"]), float(row["load_2"])] for row in rows])
    assert {row["settled"] for row in rows} == {rows[0]["settled"]}, "as the first, where nothing moves"
    assert load[0] == pytest.approx(0.0, abs=1e-6)
    assert (np.diff(load[:, 1]) > 0.0).all()
    assert np.allclose(load[2:, 0], load[2:, 1], rtol=0.01)
    assert [float(row["part"]) for row in rows] == pytest.approx(np.linspace(0, 1, 9))
    assert any(path.suffix == ".png" or path.suffix == ".pdf" for path in out.iterdir())


def test_sweep_refuses_a_method_without_contact_where_obstacles_alone_move(mesh, tmp_path, capsys):
    save_session(tmp_path / "a.apd", initial_state(mesh).updated(squeezed(mesh)), View())
    assert command("sweep", tmp_path / "a.apd", "--methods", "exact,paper", "-o", tmp_path / "swept")
    assert "omit it" in capsys.readouterr().err
