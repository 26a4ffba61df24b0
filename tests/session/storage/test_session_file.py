"""Sessions as files: what is opened is what was saved, wherever the mesh is now."""

import io
import json
import os
import shutil
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from driven_session import BENT, VIEW, Driven, check_equal, check_same_array, pose
from meshes import box, ends, rotation, soup

from apd_viewer.commands.replay_command import replay_session
from apd_viewer.errors import InputError
from apd_viewer.files import mesh_location
from apd_viewer.files.mesh_writing import WRITABLE_FORMATS, save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.samples import open_sample
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.geometry.solver.convergence import Convergence
from apd_viewer.geometry.solver.methods import METHODS
from apd_viewer.session.model.state import State, initial_state
from apd_viewer.session.model.view import CameraPose, View
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import WallText
from apd_viewer.session.quantities.wall_distribution import thickness_text
from apd_viewer.session.session import Session
from apd_viewer.session.settings_editor import SettingsEditor
from apd_viewer.session.state_store import Activity, Listener
from apd_viewer.session.storage.session_file import open_session, save_session

Change = Callable[[SettingsEditor], object]
SETTINGS: dict[str, Change] = {
    "exact": lambda _: None,
    "exact, all targets": lambda settings: settings.change(area=104.0, volume=97.0, stiffness=0.01),
    "local": lambda settings: settings.change(method="local", area_stiffness=7.0, shear_stiffness=0.3),
    "local, total area": lambda settings: settings.change(method="local", hold_area=True, volume=100.0),
    "paper": lambda settings: settings.change(method="paper", tolerance=1e-4),
    "converged earlier": lambda settings: settings.change(convergence=Convergence(700, 1e-5, 1e-4)),
    "arap": lambda settings: settings.change(method="arap", stiffness=1 / 3),
    "a soft handle": lambda settings: settings.set_falloff(1, 1.7),
    "sr-arap": lambda settings: settings.change(method="sr-arap", stiffness=0.02),
    "wall": lambda settings: settings.change(method="wall", wall_thickness=0.05, poisson=0.3),
    "bag": lambda settings: settings.change(method="wall", tension_field=True, filled_volume=24.5),
    "in contact": lambda settings: settings.set_contact(True, 0.0123),
}
assert set(METHODS) <= set(SETTINGS)


def test_session_file_tells_wall_maps_of_the_same_mean_apart(tmp_path):
    """The shape was solved by one modulus, and the wall has another by now."""
    mesh = Mesh(*box(2, 2, 6))
    walls = []
    for name, young in (("a.csv", 2), ("b.csv", 3), ("c.csv", 4)):
        (tmp_path / name).write_text(f"z,thickness,young\n0,0.02,1\n6,0.02,{young}\n")
        walls.append(thickness_text(str(tmp_path / name), mesh, Unit.NONE))
    state = initial_state(mesh)
    state = state.updated(state.document.with_settings(method="wall", wall_thickness=walls[0].thickness))
    save_session(tmp_path / "a.apd", state, View(wall=WallText(walls[1])), embed=True)
    found, seen = open_session(tmp_path / "a.apd")
    assert found.document.settings.wall_thickness == walls[0].thickness
    assert seen.wall.thickness == walls[1]
    assert len({each.thickness.digest for each in walls}) == 3


def test_session_file_keeps_a_wall_distribution(tmp_path):
    """Bit for bit: that of the wall as typed, and that by which the shape was solved, in its own unit."""
    V, F = box(2, 2, 6)
    mesh = Mesh(V, F)
    heading = "z,thickness (mm),young,yield_radius (cm)"
    (tmp_path / "walls.csv").write_text(f"{heading}\n0,0.2,2,0.6\n6,0.5,3,0.8\n")
    typed = thickness_text(str(tmp_path / "walls.csv"), mesh, Unit.CENTIMETRE)
    state = initial_state(mesh)
    thickness = typed.in_unit(Unit.CENTIMETRE)
    state = state.updated(state.document.with_settings(method="wall", wall_thickness=thickness))
    view = View(unit="cm", wall=WallText(typed, "1.38"))
    save_session(tmp_path / "a.apd", state, view, embed=True)
    found, seen = open_session(tmp_path / "a.apd")
    assert seen.wall == view.wall
    assert found.document.settings == state.document.settings
    kept = found.document.settings.wall_thickness
    for one, other in ((kept, thickness), (kept.young, thickness.young)):
        assert float(one) == float(other)
        assert np.array_equal(one.triangles, other.triangles)
    assert kept.yield_radius == thickness.yield_radius
    with zipfile.ZipFile(tmp_path / "a.apd") as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    damaged = np.load(io.BytesIO(members["thickness-0.npy"]))
    damaged[3] = -1.0
    stream = io.BytesIO()
    np.save(stream, damaged)
    with zipfile.ZipFile(tmp_path / "b.apd", "w") as archive:
        for name, content in (members | {"thickness-0.npy": stream.getvalue()}).items():
            archive.writestr(name, content)
    with pytest.raises(InputError, match="wall"):
        open_session(tmp_path / "b.apd")


@pytest.fixture
def session():
    session = Driven()
    yield session
    session.close()


@pytest.fixture
def bar(tmp_path):
    """The file of a bar."""
    (tmp_path / "meshes").mkdir()
    path = tmp_path / "meshes" / "bar.obj"
    mesh = Mesh(*box(2, 2, 6))
    save_mesh(mesh, mesh.V, path)
    return path


@pytest.fixture
def saved(bar, tmp_path):
    """A session beside the folder of its mesh; both in a folder that can be moved."""
    state = initial_state(open_mesh(bar))
    assert save_session(tmp_path / "a.apd", state, VIEW) is False
    return tmp_path / "a.apd"


def two_handles(session: Driven, mesh: Mesh, change: Change = lambda _: None) -> State:
    """Paint a base, two handles and two regions on a bar, one of which keeps an area; move both handles."""
    session.show_now(mesh)
    base, top = ends(mesh.V)
    left = mesh.V[top, 0] <= 0.5
    session.stroke(base, BASE)
    session.stroke(top[left], HANDLE)
    session.parts.add_handle()
    session.stroke(top[~left], HANDLE + 1)
    for number, inside in ((1, mesh.V[:, 2] <= 2), (2, mesh.V[:, 2] >= 4)):
        session.gestures.begin()
        session.painting.paint_region(np.flatnonzero(inside), number)
        session.painting.end_stroke("Paint region")
    session.parts.rename_region(0, "label «é»")
    session.settings.set_region_area(1, 103.0)
    change(session.settings)
    session.gestures.begin()
    session.handles.drag(BENT, 0)
    session.handles.drag(pose(0.5, (0.7, 0.1, 0.3)), 1)
    session.gestures.end("Move handles")
    session.handles.set_pivot(np.array([0.5, 0.4, 2.0]), 1)
    return session.store.state


def settled(session: Driven, mesh: Mesh, change: Change = lambda _: None) -> State:
    two_handles(session, mesh, change)
    session.settle()
    assert session.store.activity in (Activity.SETTLED, Activity.UNREACHED), session.failed
    return session.store.state


# What is saved and opened, and what comes of it


@pytest.mark.parametrize("case", SETTINGS)
def test_open_session_opens_a_session_as_it_was_saved_and_it_replays_to_the_same(
    case, session, bar, tmp_path
):
    path = tmp_path / "a.apd"
    state = settled(session, open_mesh(bar), SETTINGS[case])
    assert save_session(path, state, VIEW) is False
    found, view = open_session(path)
    assert view == VIEW
    check_equal(found, state)

    for _ in range(2):
        document, result = replay_session(path)
        check_same_array(result.U, state.frame.U)
        assert document.mesh.digest == state.document.mesh.digest
        assert (result.method, result.iterations) == (state.document.settings.method, 0)
        assert result.converged == state.frame.converged
        assert result.area == pytest.approx(state.frame.area, rel=1e-12)
        assert result.handle_drift == pytest.approx(state.frame.handle_drift, abs=1e-12)
        assert [part.name for part in result.regions] == ["label «é»", "Region 2"]
    first, second = (replay_session(path, from_rest=True)[1] for _ in range(2))
    check_same_array(first.U, second.U)
    assert first.iterations > 0
    assert first.converged
    if case == "exact, all targets":
        assert first.area == pytest.approx(1.04 * first.area_rest, rel=1e-9)
        assert first.volume == pytest.approx(0.97 * first.volume_rest, rel=1e-9)
        assert first.regions[1].area == pytest.approx(1.03 * first.regions[1].area_rest, rel=1e-9)
    if case != "paper":
        held = state.document.constraints()
        np.testing.assert_allclose(first.U[held.fixed], held.targets, rtol=0, atol=1e-13)


@pytest.mark.night
def test_open_session_and_replay_bring_the_sample_bottle_back_as_it_was_saved(session, tmp_path):
    path = tmp_path / "bottle.apd"
    session.files.open_sample("bottle")
    session.until(lambda: session.jobs.current is None)
    document = session.store.state.document
    top = np.flatnonzero(document.labels == HANDLE)
    session.parts.add_handle()
    session.stroke(top[document.mesh.V[top, 0] > 0], HANDLE + 1)
    session.gestures.begin()
    height = document.mesh.V[:, 1]
    session.painting.paint_region(np.flatnonzero((height > 8) & (height < 11)), 1)
    session.painting.end_stroke("Paint region")
    session.parts.rename_region(0, "label")
    turn = np.eye(4)
    turn[:3, :3] = rotation((0, 1, 0), 0.6)
    session.gestures.begin()
    session.handles.drag(turn, 0)
    session.handles.drag(turn, 1)
    session.gestures.end("Move handles")
    assert session.wait_idle(120.0)
    assert session.store.activity is Activity.SETTLED
    session.files.save(path, VIEW)
    session.until(lambda: session.jobs.current is None)
    assert session.told == ["Saved bottle.apd."]
    check_equal(open_session(path)[0], session.store.state)
    gone_on, second = (replay_session(path)[1] for _ in range(2))
    check_same_array(gone_on.U, second.U)
    np.testing.assert_allclose(gone_on.U, session.U, rtol=0, atol=1e-12)
    first, second = (replay_session(path, from_rest=True)[1] for _ in range(2))
    check_same_array(first.U, second.U)
    assert first.energy == pytest.approx(gone_on.energy, rel=1e-2)


def test_open_session_brings_what_is_at_rest_back_as_the_mesh_s_own(tmp_path):
    state = initial_state(*open_sample("duck"))
    save_session(tmp_path / "a.apd", state, View())
    found, view = open_session(tmp_path / "a.apd")
    check_equal(found, state)
    assert view == View()
    assert found.frame.U is found.document.initial_positions is found.document.mesh.V
    with zipfile.ZipFile(tmp_path / "a.apd") as archive:
        assert archive.namelist() == ["session.json", "labels.npy", "member.npy"]


def test_replay_session_goes_on_with_a_shape_on_its_way_from_where_it_was(session, bar, tmp_path):
    two_handles(session, open_mesh(bar))
    session.until(lambda: session.store.state.frame.iteration > 0)
    state = session.store.state
    session.settle()
    if state.frame.settled:
        state = state.as_unsettled()
    save_session(tmp_path / "a.apd", state, VIEW)
    check_equal(open_session(tmp_path / "a.apd")[0], state)
    first, second = (replay_session(tmp_path / "a.apd")[1] for _ in range(2))
    check_same_array(first.U, second.U)
    assert first.converged
    assert first.iterations > 0


def test_open_session_keeps_what_cannot_be_reached_with_its_sentence(session, bar, tmp_path):
    state = settled(session, open_mesh(bar), lambda settings: settings.change(area=50.0, volume=300.0))
    assert state.frame.unreached
    save_session(tmp_path / "a.apd", state, VIEW)
    check_equal(open_session(tmp_path / "a.apd")[0], state)
    _, result = replay_session(tmp_path / "a.apd")
    check_same_array(result.U, state.frame.U)
    assert not result.converged
    assert state.frame.unreached in result.warnings


def test_open_session_brings_back_a_shape_that_is_gripped_where_it_is(session, bar, tmp_path):
    """After a stroke on a deformed shape the handles are held where they are, with poses of none."""
    settled(session, open_mesh(bar))
    session.stroke(np.array([9, 10]), BASE)
    session.settle()
    state = session.store.state
    assert state.document.initial_positions is not state.document.mesh.V
    save_session(tmp_path / "a.apd", state, VIEW)
    check_equal(open_session(tmp_path / "a.apd")[0], state)
    check_same_array(replay_session(tmp_path / "a.apd")[1].U, state.frame.U)


def test_replay_session_goes_on_with_a_settled_shape_that_is_not_what_it_says(session, bar, tmp_path):
    state = settled(session, open_mesh(bar))
    moved = state.document.with_pose(0, pose(0.2))
    for wrong in (
        replace(state, document=moved),
        replace(state, document=state.document.with_settings(area=110.0)),
    ):
        save_session(tmp_path / "a.apd", wrong, VIEW)
        _, result = replay_session(tmp_path / "a.apd")
        assert result.iterations > 0
        held = wrong.document.constraints()
        np.testing.assert_allclose(result.U[held.fixed], held.targets, rtol=0, atol=1e-13)
        assert result.area == pytest.approx(result.area_rest * wrong.document.settings.area / 100, rel=1e-9)


def test_open_session_brings_numbers_of_all_sizes_back_bit_for_bit(tmp_path):
    chance = np.random.default_rng(5)
    state = initial_state(Mesh(*soup(*box(1, 1, 2))))
    document = state.document
    P = np.vstack([chance.normal(size=(3, 4)) * 10.0 ** chance.integers(-30, 9, (3, 4)), [[0, 0, 0, 1]]])
    P[0, 0], P[1, 1] = -0.0, 5e-324
    U = frozen(document.mesh.V + chance.normal(size=document.mesh.V.shape) * 1e-9)
    document = document.with_settings(tolerance=0.1 + 0.2, stiffness=1e-7 / 3).with_pose(0, P)
    document = replace(document, initial_positions=frozen(U + 1e-17))
    state = replace(state, document=document, frame=replace(state.frame, U=U, handle_drift=1 / 3))
    save_session(tmp_path / "a.apd", state, VIEW)
    found, _ = open_session(tmp_path / "a.apd")
    check_same_array(found.frame.U, U)
    check_same_array(found.document.initial_positions, document.initial_positions)
    check_same_array(found.document.handles[0].pose, document.handles[0].pose)
    assert found.document.settings.tolerance == document.settings.tolerance
    assert found.document.settings.stiffness == document.settings.stiffness
    assert found.frame.handle_drift == 1 / 3


def test_save_session_gives_the_same_file_for_the_same_session(session, bar, tmp_path):
    state = settled(session, open_mesh(bar))
    for name in ("a.apd", "b.apd"):
        save_session(tmp_path / name, state, VIEW, embed=True)
    assert (tmp_path / "a.apd").read_bytes() == (tmp_path / "b.apd").read_bytes()


def test_open_session_ignores_what_a_later_program_adds(session, bar, tmp_path):
    state = settled(session, open_mesh(bar))
    save_session(tmp_path / "a.apd", state, VIEW)
    with zipfile.ZipFile(tmp_path / "a.apd") as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    said = json.loads(members["session.json"])
    for part in (
        said,
        *(said[key] for key in ("mesh", "document", "frame", "view")),
        said["document"]["handles"][0],
    ):
        part["colour"] = {"of": ["the", "sky", 3]}
    with zipfile.ZipFile(tmp_path / "b.apd", "w") as archive:
        for name, content in {**members, "session.json": json.dumps(said), "../extra": b"?"}.items():
            archive.writestr(name, content)
    check_equal(open_session(tmp_path / "b.apd")[0], state)


# Where the mesh is


def test_open_session_finds_the_mesh_of_a_session_moved_together_with_it(saved, bar, tmp_path_factory):
    there = tmp_path_factory.mktemp("elsewhere") / "moved"
    shutil.move(saved.parent, there)
    found, _ = open_session(there / "a.apd")
    assert found.document.mesh.path == there / "meshes" / "bar.obj"
    shutil.move(there / "meshes" / "bar.obj", there)
    assert open_session(there / "a.apd")[0].document.mesh.path == there / "bar.obj"


def test_open_session_finds_the_mesh_of_a_session_moved_away_from_it(saved, bar, tmp_path_factory):
    there = tmp_path_factory.mktemp("elsewhere") / "b.apd"
    shutil.move(saved, there)
    assert open_session(there)[0].document.mesh.path == bar


def test_open_session_finds_a_session_from_another_folder(bar, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    save_session("a.apd", initial_state(open_mesh("meshes/bar.obj")), VIEW)
    monkeypatch.chdir(tmp_path / "meshes")
    assert open_session("../a.apd")[0].document.mesh.path == bar


def test_open_session_finds_a_sample_by_its_name(tmp_path, monkeypatch):
    """Another installation has it elsewhere."""
    mesh, _ = open_sample("duck")
    gone = {"path": "/gone/duck.obj", "relative": "gone/duck.obj"}
    to_json = mesh_location.mesh_location_to_json
    monkeypatch.setattr(mesh_location, "mesh_location_to_json", lambda *given: {**to_json(*given), **gone})
    save_session(tmp_path / "a.apd", initial_state(mesh), VIEW)
    assert open_session(tmp_path / "a.apd")[0].document.mesh.path == mesh.path


def test_open_session_misses_a_missing_mesh_by_name_and_place(saved, bar):
    bar.unlink()
    with pytest.raises(InputError, match=r"^bar\.obj, a mesh of a\.apd, is missing .*bar\.obj.*\.$") as error:
        open_session(saved)
    assert str(bar) in str(error.value)
    assert str(saved.parent / "bar.obj") in str(error.value)


def test_open_session_does_not_take_a_changed_mesh_for_the_mesh(saved, bar):
    mesh = open_mesh(bar)
    save_mesh(mesh, mesh.V * [1.0, 1.0, 1.0 + 1e-12], bar)
    with pytest.raises(
        InputError, match=r"bar\.obj is not the mesh that a\.apd was saved with \(it has been changed"
    ):
        open_session(saved)
    cube = Mesh(*box(1, 1, 1))
    save_mesh(cube, cube.V, bar)
    with pytest.raises(InputError, match=r"it has 8 vertices instead of 58"):
        open_session(saved)
    bar.write_text("nonsense")
    with pytest.raises(InputError, match=r"bar\.obj"):
        open_session(saved)
    save_mesh(mesh, mesh.V, saved.parent / "bar.obj")
    assert open_session(saved)[0].document.mesh.path == saved.parent / "bar.obj"


@pytest.mark.parametrize("suffix", WRITABLE_FORMATS)
def test_save_session_takes_a_copy_of_the_mesh_along(suffix, tmp_path):
    path = tmp_path / f"bar{suffix}"
    mesh = Mesh(*box(2, 2, 6))
    save_mesh(mesh, mesh.V, path)
    content, mesh = path.read_bytes(), open_mesh(path)
    assert save_session(tmp_path / "a.apd", initial_state(mesh), VIEW, embed=True) is True
    with zipfile.ZipFile(tmp_path / "a.apd") as archive:
        assert archive.read(f"mesh{suffix}") == content
    path.unlink()
    found = open_session(tmp_path / "a.apd")[0].document.mesh
    assert found.digest == mesh.digest
    assert found.name == path.name
    save_mesh(found, found.V, tmp_path / f"again{suffix}")
    assert (tmp_path / f"again{suffix}").read_bytes() == content
    # And once more, though there is no file any more.
    assert save_session(tmp_path / "b.apd", initial_state(found), VIEW) is True
    assert open_session(tmp_path / "b.apd")[0].document.mesh.digest == mesh.digest


def test_save_session_takes_a_mesh_that_needs_other_files_along_as_arrays(tmp_path):
    made = trimesh.Trimesh(*box(1, 1, 2), process=False).export(file_type="gltf")
    for name, content in made.items():
        (tmp_path / name.replace("model", "bar")).write_bytes(content)
    mesh = open_mesh(tmp_path / "bar.gltf")
    assert save_session(tmp_path / "a.apd", initial_state(mesh), VIEW, embed=True) is True
    for name in made:
        (tmp_path / name.replace("model", "bar")).unlink()
    found = open_session(tmp_path / "a.apd")[0].document.mesh
    assert (found.digest, found.name) == (mesh.digest, "bar.gltf")


def test_save_session_always_takes_a_mesh_of_no_file_along(tmp_path):
    mesh = Mesh(*soup(*box(1, 1, 2)))
    assert save_session(tmp_path / "a.apd", initial_state(mesh), VIEW) is True
    found = open_session(tmp_path / "a.apd")[0].document.mesh
    check_same_array(found.V, mesh.V)
    check_same_array(found.F, mesh.F)
    assert found.path is None


def test_save_session_takes_a_mesh_along_whose_file_has_changed_since(bar, tmp_path):
    mesh = open_mesh(bar)
    save_mesh(mesh, mesh.V * 2.0, bar)
    assert save_session(tmp_path / "a.apd", initial_state(mesh), VIEW) is True
    assert open_session(tmp_path / "a.apd")[0].document.mesh.digest == mesh.digest


# Writing


def test_save_session_leaves_the_file_as_it_was_when_it_cannot_write(saved, bar, monkeypatch):
    before, state = saved.read_bytes(), initial_state(open_mesh(bar))

    def full(descriptor):
        raise OSError(28, "No space left on device")

    with pytest.raises(InputError, match=r"use \.apd"):
        save_session(saved.with_suffix(".zip"), state, VIEW)
    with pytest.raises(InputError, match="cannot be written"):
        save_session(saved.parent / "gone" / "a.apd", state, VIEW)
    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(InputError, match="No space left on device"):
        save_session(saved, state, View())
    assert saved.read_bytes() == before
    assert sorted(path.name for path in saved.parent.iterdir()) == ["a.apd", "meshes"]


# The session's verbs


def test_files_save_and_open_sessions_in_the_background(session, bar, tmp_path):
    state = settled(session, open_mesh(bar))
    assert session.saved_work.is_unsaved
    session.files.save(tmp_path / "a.apd", VIEW)
    assert session.jobs.current.title == "Saving a.apd"
    assert not session.jobs.current.can_be_cancelled
    session.until(lambda: session.jobs.current is None)
    assert not session.saved_work.is_unsaved
    session.settings.change(method="local")
    session.settle()
    assert session.saved_work.is_unsaved
    now = session.store.state
    session.files.open(tmp_path / "a.apd")
    assert session.jobs.current.title == "Opening a.apd"
    session.until(lambda: session.jobs.current is None)
    check_equal(session.store.state, state)
    assert session.store.state.document.settings.method == "exact"
    assert session.store.activity is Activity.IDLE
    assert session.gestures.history.next_undo_name == "Open a.apd"
    session.gestures.undo()
    assert session.store.state is now
    session.gestures.redo()
    check_equal(session.store.state, state)
    session.drag(pose(0.3))
    session.settle()
    assert session.store.activity is Activity.SETTLED
    assert session.failed == []


def test_files_open_tells_the_listener_the_view_after_the_state(bar, tmp_path):
    save_session(tmp_path / "a.apd", initial_state(open_mesh(bar)), VIEW)
    seen: list[object] = []
    silent = {"wake": lambda: None, "status_changed": lambda: None, "message_sent": seen.append}
    listener = Listener(
        **silent, changed=lambda *_: seen.append("state"), failed=seen.append, view_opened=seen.append
    )
    session = Session(listener)
    for path in (tmp_path / "a.apd", bar):
        session.files.open(path)
        assert session.wait_idle(20.0)
    session.close()
    assert seen == ["state", VIEW, "state"]


def test_files_open_lets_a_shape_on_its_way_go_on(session, bar, tmp_path):
    state = two_handles(session, open_mesh(bar)).as_unsettled()
    session.settle()
    save_session(tmp_path / "a.apd", state, VIEW)
    session.files.open(tmp_path / "a.apd")
    session.settle()
    assert session.store.activity is Activity.SETTLED


def test_files_save_leaves_out_a_gesture_under_way(session, bar, tmp_path):
    state = settled(session, open_mesh(bar))
    session.gestures.begin()
    session.painting.paint(np.arange(9, 20), BASE)
    session.files.save(tmp_path / "a.apd", VIEW)
    session.until(lambda: session.jobs.current is None)
    check_equal(open_session(tmp_path / "a.apd")[0], state)


def test_files_open_tells_of_a_session_that_cannot_be_opened_and_changes_nothing(session, bar, tmp_path):
    state = settled(session, open_mesh(bar))
    (tmp_path / "bad.apd").write_text("nonsense")
    session.files.open(tmp_path / "bad.apd")
    session.until(lambda: session.jobs.current is None)
    session.files.save(tmp_path / "gone" / "a.apd", VIEW)
    session.until(lambda: session.jobs.current is None)
    assert [said.split()[0] for said in session.failed] == ["bad.apd", str(tmp_path / "gone" / "a.apd")]
    assert session.store.state is state
    assert session.saved_work.is_unsaved


def test_open_session_opens_the_first_version_for_ever():
    """``version-1.apd`` was made by the first program that could; do not make it again."""
    path = Path(__file__).with_name("version-1.apd")
    state, view = open_session(path)
    document, frame = state.document, state.frame
    V = document.mesh.V
    assert (document.mesh.name, len(V), len(document.mesh.F)) == ("bar.obj", 24, 44)
    assert [part.name for part in document.handles] == ["left", "right"]
    lifted = np.eye(4)
    lifted[2, 3] = 0.125
    assert np.array_equal([part.pose for part in document.handles], [np.eye(4), lifted])
    assert [(part.name, part.area) for part in document.regions] == [("foot", None), ("neck é", 102.5)]
    assert document.settings.method == "exact"
    assert (document.settings.tolerance, document.settings.stiffness) == (0.002, 0.01)
    assert (document.settings.area_stiffness, document.settings.shear_stiffness) == (12.5, 0.25)
    assert (document.settings.area, document.settings.hold_area, document.settings.volume) == (
        101.0,
        True,
        99.0,
    )
    x, _, z = V.T
    base, top = (z == 0) | ((z == 1) & (x == 0)), z == 3
    painted = np.select([base, top & (x == 0), top & (x == 2)], [0, 2, 3], 1)
    assert np.array_equal(document.labels, painted)
    assert np.array_equal(document.member, np.where(z <= 1, 1, 2))
    held = document.constraints()
    assert np.array_equal(frame.U[held.fixed], held.targets)
    assert np.array_equal(document.initial_positions[document.labels == 3], V[document.labels == 3])
    assert frame.U[3].tolist() == [0.25, 0.0, 3.5]
    assert frame.U.sum() == pytest.approx(75.42164786109885, rel=1e-14)
    assert (frame.iteration, frame.settled, frame.converged) == (9, True, True)
    assert frame.area == pytest.approx(22.22, rel=1e-9)
    assert frame.volume == pytest.approx(5.94, rel=1e-9)
    assert frame.regions[1] == pytest.approx(8.2, rel=1e-9)
    assert view == View(CameraPose((0.0, -12.0, 4.0), (1.0, 0.5, 1.5), (0.0, 0.0, 1.0), 0.5), "cm")
    check_same_array(replay_session(path)[1].U, frame.U)
    assert replay_session(path, from_rest=True)[1].converged


# Loose parts


def with_buttons(session: Driven) -> State:
    """A bent bar with two loose boxes beside it, the second of which stays."""
    (V, F), (W, G) = box(2, 2, 6), box(1, 1, 1)
    V = np.vstack([V, 0.2 * W + [2.1, 1.0, 4.0], 0.2 * W + [2.1, 1.0, 2.0]])
    F = np.vstack([F, G + F.max() + 1, G + F.max() + 1 + len(W)])
    session.show_now(Mesh(V, F))
    n = len(V) - 2 * len(W)
    base, top = ends(V[:n])
    session.stroke(base, BASE)
    session.stroke(top, HANDLE)
    session.drag(BENT)
    session.settings.set_components_immobile([n + len(W)], True)
    session.settle()
    return session.store.state


def test_save_session_keeps_what_stays_and_it_is_replayed(session, tmp_path):
    state = with_buttons(session)
    first, second = np.split(np.arange(len(state.document.mesh.V))[-16:], 2)
    assert state.document.immobile_components == (second[0],)
    V = state.document.mesh.V
    assert np.array_equal(state.frame.U[second], V[second])
    assert np.abs(state.frame.U[first] - V[first]).max() > 0.1
    save_session(tmp_path / "a.apd", state, VIEW, embed=True)
    check_equal(open_session(tmp_path / "a.apd")[0], state)
    check_same_array(replay_session(tmp_path / "a.apd")[1].U, state.frame.U)
    again = replay_session(tmp_path / "a.apd", from_rest=True)[1]
    assert np.array_equal(again.U[second], V[second])
    assert np.abs(again.U[first] - state.frame.U[first]).max() < 1e-3


def rewritten(path: Path, change) -> None:
    """Change what a session says about its document."""
    with zipfile.ZipFile(path) as archive:
        contents = {name: archive.read(name) for name in archive.namelist()}
    said = json.loads(contents["session.json"])
    change(said["document"])
    contents["session.json"] = json.dumps(said).encode()
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in contents.items():
            archive.writestr(name, content)


def test_open_session_lets_loose_parts_of_an_older_session_stay(session, tmp_path):
    state = with_buttons(session)
    U = state.frame.U.copy()
    U[-16:] = state.document.mesh.V[-16:]
    path = tmp_path / "a.apd"
    save_session(path, replace(state, frame=replace(state.frame, U=frozen(U))), VIEW, embed=True)
    rewritten(path, lambda said: said.pop("staying"))
    assert len(open_session(path)[0].document.immobile_components) == 2
    check_same_array(replay_session(path)[1].U, U)
    assert np.array_equal(replay_session(path, from_rest=True)[1].U[-16:], U[-16:])


def test_open_session_lets_loose_parts_of_an_older_session_at_rest_go_along(session, tmp_path):
    state = with_buttons(session)
    path = tmp_path / "a.apd"
    save_session(path, initial_state(state.document.mesh, state.document.labels), VIEW, embed=True)
    rewritten(path, lambda said: said.pop("staying"))
    assert open_session(path)[0].document.immobile_components == ()


@pytest.mark.parametrize("mirror", ["w", "", "xy", 0])
def test_open_session_refuses_an_unknown_axis_of_symmetry(mirror, saved):
    rewritten(saved, lambda said: said.update(mirror=mirror))
    with pytest.raises(InputError, match="mirror"):
        open_session(saved)


@pytest.mark.parametrize("staying", ["all", [-1], [0.5], [10_000], [True]])
def test_open_session_refuses_to_let_parts_stay_that_are_not_there(staying, session, tmp_path):
    path = tmp_path / "a.apd"
    save_session(path, with_buttons(session), VIEW, embed=True)
    rewritten(path, lambda said: said.update(staying=staying))
    with pytest.raises(InputError, match="staying"):
        open_session(path)
