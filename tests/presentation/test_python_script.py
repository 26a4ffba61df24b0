"""Python lines run, and give the shape that the session replays to, bit for bit."""

from collections.abc import Callable

import numpy as np
import pytest
from driven_session import Driven, bar, pose
from meshes import ends

from apd_viewer.commands.replay_command import replay_session
from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.energy.wall_map import wall_map_of
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.geometry.solver.convergence import Convergence
from apd_viewer.presentation.python_script import python_script
from apd_viewer.session.model.named_obstacle import ObstacleKind
from apd_viewer.session.model.view import View
from apd_viewer.session.settings_editor import SettingsEditor
from apd_viewer.session.storage.session_file import save_session

SETTINGS: dict[str, Callable[[SettingsEditor], object]] = {
    "exact": lambda _: None,
    "all targets": lambda settings: settings.change(area=104.0, volume=97.0, stiffness=0.01),
    "local": lambda settings: settings.change(
        method="local", area_stiffness=7.0, shear_stiffness=0.3, hold_area=True
    ),
    "paper": lambda settings: settings.change(method="paper", tolerance=1e-4),
    "arap": lambda settings: settings.change(method="arap", stiffness=1 / 3),
    "sr-arap": lambda settings: settings.change(method="sr-arap", stiffness=0.02),
    "another end": lambda settings: settings.change(convergence=Convergence(40, 1e-4)),
    "in contact": lambda settings: settings.set_contact(True, 0.01),
    "what stays": lambda settings: settings.set_components_immobile((0,), True),
}


@pytest.fixture
def session(tmp_path):
    """A bar from a file, with a base and two handles that have been moved."""
    mesh, path = bar(), tmp_path / "bar.obj"
    save_mesh(mesh, mesh.V, path)
    session = Driven()
    session.show_now(open_mesh(path))
    base, top = ends(mesh.V)
    left = mesh.V[top, 0] <= 0.5
    session.stroke(base, BASE)
    session.stroke(top[left], HANDLE)
    session.parts.add_handle()
    session.stroke(top[~left], HANDLE + 1)
    yield session
    session.close()


def move(session):
    session.gestures.begin()
    session.handles.drag(pose(0.4, (0.3, 0.0, 0.1)), 0)
    session.handles.drag(pose(0.4, (0.3, 0.0, 0.1)), 1)
    session.gestures.end("Move handles")


def check_repeats(session, folder, monkeypatch):
    state = session.store.state
    save_session(folder / "a.apd", state, View())
    expected = replay_session(folder / "a.apd", from_rest=True)[1].U
    monkeypatch.chdir(folder)
    names = {}
    exec(python_script(state.document), names)
    assert np.array_equal(names["result"].U, expected)
    assert np.abs(open_mesh(folder / "bar-deformed.obj").V - expected).max() < 1e-12


@pytest.mark.parametrize("case", SETTINGS)
def test_python_script_repeats_what_the_session_says(case, session, tmp_path, monkeypatch):
    SETTINGS[case](session.settings)
    move(session)
    check_repeats(session, tmp_path, monkeypatch)


def test_python_script_repeats_regions(session, tmp_path, monkeypatch):
    V = session.store.state.document.mesh.V
    session.gestures.begin()
    session.painting.paint_region(np.flatnonzero(V[:, 2] <= 2), 1)
    session.painting.end_stroke("Paint region")
    session.parts.rename_region(0, "a 'label', too")
    session.settings.set_region_area(0, 103.0)
    move(session)
    check_repeats(session, tmp_path, monkeypatch)


def test_python_script_repeats_turns_of_more_than_half(session, tmp_path, monkeypatch):
    session.settings.set_contact(False)
    session.gestures.begin()
    for angle in np.linspace(0.3, 3.5, 6):
        for k in (0, 1):
            session.handles.drag(pose(angle), k)
    session.gestures.end("Move handles")
    assert session.store.state.document.has_half_turn
    check_repeats(session, tmp_path, monkeypatch)


def put_obstacles(session):
    """A plate and a finger that push the side of the bar, and a sphere on the other."""
    out = np.array([1.0, 0.0, 0.0])
    for kind, outwards, point in (
        (ObstacleKind.PLATE, out, (2.0, 1.0, 3.0)),
        (ObstacleKind.CYLINDER, -out, (0.0, 1.0, 3.0)),
        (ObstacleKind.SPHERE, -out, (0.0, 1.0, 2.0)),
    ):
        proposed = session.obstacles.proposed_obstacle(kind, np.array(point), outwards)
        session.obstacles.add(proposed)
    session.obstacles.move(1, 0.15 * out)


def test_python_script_repeats_obstacles_where_something_is_held(session, tmp_path, monkeypatch):
    session.settings.change(stiffness=0.01)
    put_obstacles(session)
    check_repeats(session, tmp_path, monkeypatch)


def test_python_script_repeats_obstacles_where_nothing_is_held(session, tmp_path, monkeypatch):
    session.painting.clear_all()
    put_obstacles(session)
    check_repeats(session, tmp_path, monkeypatch)


def test_python_script_holds_what_was_painted_on_a_bent_shape_where_it_was(session, tmp_path, monkeypatch):
    move(session)
    assert session.wait_idle(60.0)
    V = session.store.state.document.mesh.V
    session.stroke(np.flatnonzero(V[:, 2] == 5.0), HANDLE)
    move(session)
    check_repeats(session, tmp_path, monkeypatch)


def test_python_script_refuses_what_its_lines_cannot_say(session):
    document = session.store.state.document
    session.settings.set_falloff(0, 1.0)
    with pytest.raises(InputError, match="falloff"):
        python_script(session.store.state.document)
    mesh = document.mesh
    thickness = wall_map_of(np.full(len(mesh.F), 0.1), mesh.V, mesh.F)
    with pytest.raises(InputError, match="wall distribution"):
        python_script(document.with_settings(method="wall", wall_thickness=thickness))
    with pytest.raises(InputError, match="no base"):
        python_script(document.with_label(np.arange(len(document.labels)), HANDLE))
    session.show_now(bar())
    session.paint_ends()
    with pytest.raises(InputError, match="not in a file"):
        python_script(session.store.state.document)
