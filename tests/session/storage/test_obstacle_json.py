"""Obstacles in sessions: they come back bit for bit, and damaged ones are refused."""

import json
from dataclasses import replace

import numpy as np
import pytest
from driven_session import check_equal
from meshes import tube

from apd_viewer.commands.replay_command import replay_session
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.storage.json_fields import JsonFields
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.solver.deformation_result import iterate_to_result
from apd_viewer.session.model.named_obstacle import MOST_OBSTACLES, NamedObstacle, ObstacleKind
from apd_viewer.session.model.state import State, initial_state
from apd_viewer.session.model.view import View
from apd_viewer.session.processes.document_deformation import deformation_of, document_iteration
from apd_viewer.session.storage.part_json import obstacle_from_json, obstacle_to_json
from apd_viewer.session.storage.session_file import open_session, save_session
from apd_viewer.session.storage.session_json import document_to_json, frame_to_json

X, Y, Z = map(frozen, np.eye(3))
ROD = NamedObstacle("Stab «é»", ObstacleKind.CYLINDER, frozen(np.array([1.31, 0.0, 2.7])), Y, 0.3, 1 / 3)
WALL = NamedObstacle("Wall", ObstacleKind.PLATE, frozen(-1.01 * X), X)
BALL = NamedObstacle("Ball", ObstacleKind.SPHERE, frozen(3.0 * Y), radius=0.1)


def pressed(path) -> State:
    """A tube that nothing holds, pressed by a rod against a wall."""
    mesh = Mesh(*tube(12, 12))
    save_mesh(mesh, mesh.V, path)
    state = initial_state(open_mesh(path))
    obstacles = (ROD.with_shift(-0.2 * X), WALL, BALL)
    document = replace(state.document.with_settings(contact=True, stiffness=0.001), obstacles=obstacles)
    solver = deformation_of(document, document.constraints())
    walk = document_iteration(solver, document, document.mesh.V, start_shifts=np.zeros((3, 3)))
    iterate_to_result(solver, walk, 0.0)
    return state.updated(document, walk.frame())


def test_obstacle_json_brings_obstacles_back_bit_for_bit_to_be_replayed(tmp_path):
    state = pressed(tmp_path / "tube.obj")
    assert state.frame.settled
    assert state.frame.loads[0, 0] > 0.1
    save_session(tmp_path / "a.apd", state, View())
    found, _ = open_session(tmp_path / "a.apd")
    check_equal(found, state)
    _, result = replay_session(tmp_path / "a.apd")
    assert result.iterations == 0
    assert np.array_equal(result.U, state.frame.U)
    _, again = replay_session(tmp_path / "a.apd", from_rest=True)
    assert again.converged
    assert np.array_equal(again.shifts, state.frame.shifts)
    assert np.allclose(again.loads, state.frame.loads, rtol=0.02, atol=1e-2)


def test_document_to_json_and_frame_said_say_nothing_of_obstacles_without_any():
    state = initial_state(Mesh(*tube(8, 4)))
    assert "obstacles" not in document_to_json(state.document)
    assert not {"loads", "shifts"} & set(frame_to_json(state.frame, 0))


def test_frame_to_json_leaves_out_shifts_of_other_obstacles(tmp_path):
    """A frame of one obstacle less may arrive for the document that has a new one."""
    state = initial_state(Mesh(*tube(8, 4)))
    document = replace(state.document, obstacles=(WALL, BALL))
    state = state.updated(document, frame=replace(state.frame, shifts=frozen(np.zeros((1, 3)))))
    save_session(tmp_path / "a.apd", state, View(), embed=True)
    assert len(open_session(tmp_path / "a.apd")[0].document.obstacles) == 2


@pytest.mark.parametrize("obstacle", [ROD, WALL, BALL], ids=lambda each: each.name)
def test_obstacle_from_json_needs_only_what_the_kind_has(obstacle):
    said = json.loads(json.dumps(obstacle_to_json(obstacle)))
    unused = {"plate": ("radius", "length"), "sphere": ("axis", "length"), "cylinder": ()}
    for key in (*unused[said["kind"]], "shift", "name"):
        del said[key]
    found = obstacle_from_json(JsonFields(said, "obstacle"), "Obstacle 1")
    assert found.name == "Obstacle 1"
    assert np.array_equal(found.to_obstacle(1.0).points, obstacle.to_obstacle(1.0).points)
    assert found.to_obstacle(1.0).radius == obstacle.radius


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("kind", "cone"),
        ("kind", None),
        ("place", [0.0, 1.0]),
        ("place", ["a", 0.0, 0.0]),
        ("axis", [0.0, 0.0, 0.0]),
        ("axis", None),
        ("radius", -1.0),
        ("radius", 0.0),
        ("length", 0.0),
        ("shift", [1e90, 0.0, 0.0]),
        ("name", ""),
    ],
)
def test_obstacle_from_json_refuses_a_damaged_obstacle(key, value):
    with pytest.raises(ValueError, match="“"):
        obstacle_from_json(JsonFields({**obstacle_to_json(ROD), key: value}, "obstacle"))


def test_json_fields_parts_refuses_more_obstacles_than_the_limit():
    said = JsonFields({"obstacles": [obstacle_to_json(BALL)] * (MOST_OBSTACLES + 1)}, "document")
    with pytest.raises(ValueError, match="obstacles"):
        said.nested_list("obstacles", MOST_OBSTACLES)


@pytest.mark.parametrize(
    "settings",
    [
        {"filled_volume": 1.2e9},
        {"filled_volume": 1e12},
        {"pressure": 5e11},
        {"wall_thickness": 1e-15},
        {"yield_radius": 1e12},
    ],
    ids=str,
)
def test_settings_to_json_writes_what_is_read_again(settings, tmp_path):
    state = initial_state(Mesh(*tube(8, 4)))
    state = state.updated(state.document.with_settings(**settings))
    save_session(tmp_path / "a.apd", state, View(), embed=True)
    assert open_session(tmp_path / "a.apd")[0].document.settings == state.document.settings
