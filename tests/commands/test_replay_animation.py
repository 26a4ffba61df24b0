"""The shapes that a replay goes through, written as animations."""

import re
from dataclasses import replace

import numpy as np
import pytest
import pyvista
from animated import read_pc2
from painted_meshes import write_bar

from apd_viewer.__main__ import main
from apd_viewer.commands import replay_command
from apd_viewer.commands.replay_command import replay_session
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.pose.transforms import rotation_about
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.view import View
from apd_viewer.session.storage.session_file import save_session

BENT = rotation_about([1, 1, 0], [1, 0, 0], 0.6)


@pytest.fixture
def session(tmp_path):
    """A session with its handle moved, and its shape still at rest."""
    write_bar(tmp_path)
    state = initial_state(open_mesh(tmp_path / "bar.off"), np.loadtxt(tmp_path / "bar.sel", dtype=np.uint8))
    path = tmp_path / "bar.apd"
    save_session(path, state.updated(state.document.with_pose(0, BENT)).as_unsettled(), View())
    return path


@pytest.fixture
def run(session, tmp_path, capsys):
    """Replay with these words; return the status and the error."""

    def words(*words):
        status = main(["replay", str(session), "-o", str(tmp_path / "out.off"), *map(str, words)])
        return status, capsys.readouterr().err

    return words


def test_replay_animation_begins_with_the_shape_saved_and_has_each_iteration(session, run, tmp_path):
    passed = []
    replay_session(session, on_shape=lambda U: passed.append(U.astype(np.float32)))
    words = [word for name in ("a.pc2", "a.pvd") for word in ("--animation", tmp_path / name)]
    assert run(*words) == (0, "")
    shapes, mesh = read_pc2(tmp_path / "a.pc2"), open_mesh(tmp_path / "bar.off")
    assert len(passed) > 3
    assert np.array_equal(shapes, passed)
    assert np.array_equal(shapes[0], mesh.V.astype(np.float32))
    assert np.array_equal(shapes[-1], open_mesh(tmp_path / "out.off").V.astype(np.float32))
    assert pyvista.get_reader(tmp_path / "a.pvd").time_values == list(range(len(shapes)))


def test_replay_animation_has_some_of_many_iterations(run, tmp_path, monkeypatch):
    recorder = replay_command.ShapeRecorder
    monkeypatch.setattr(replay_command, "ShapeRecorder", lambda folder, _: recorder(folder, 4))
    assert run("--animation", tmp_path / "a.pc2") == (0, "")
    shapes = read_pc2(tmp_path / "a.pc2")
    assert 2 <= len(shapes) <= 4
    assert np.array_equal(shapes[-1], open_mesh(tmp_path / "out.off").V.astype(np.float32))


def settled(session):
    """Save the session again, with its shape converged."""
    document, result = replay_session(session)
    state = initial_state(document.mesh)
    frame = replace(state.frame, U=result.U, settled=True, converged=True)
    save_session(session, replace(state, document=document, frame=frame), View())


def test_replay_animation_has_nothing_of_what_has_settled_but_from_rest(session, run, tmp_path):
    settled(session)
    before = sorted(tmp_path.iterdir())
    status, err = run("--animation", tmp_path / "a.pc2")
    assert status == 2
    assert re.fullmatch(r"error: The saved shape has converged, .+ add --from-rest\.\n", err)
    assert sorted(tmp_path.iterdir()) == before
    assert run("--animation", tmp_path / "a.pc2", "--from-rest") == (0, "")
    V = open_mesh(tmp_path / "bar.off").V
    assert np.array_equal(read_pc2(tmp_path / "a.pc2")[0], V.astype(np.float32))


@pytest.mark.parametrize(
    ("name", "words"),
    [
        (
            "a.gif",
            "a.gif cannot show a replay; use .pc2, .mdd, .glb, .usda, .usdc, .usdz, .pvd, or apd",
        ),
        ("a.abc", "cannot show a replay"),
        ("gone/a.pc2", "There is no folder"),
        ("out.glb", "a name of its own"),
    ],
)
def test_replay_session_says_what_is_wrong_with_an_animation_and_writes_nothing(name, words, run, tmp_path):
    before = sorted(tmp_path.iterdir())
    status, err = run("-o", tmp_path / "out.glb", "--animation", tmp_path / name)
    assert status == 2
    assert words in err
    assert err.count("\n") == 1
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize("option", ["--scalars", "--triangle-scalars", "--report"])
def test_replay_session_refuses_a_file_to_be_written_twice(option, run, tmp_path):
    before = sorted(tmp_path.iterdir())
    name = "a.csv" if option == "--triangle-scalars" else "a.ply"
    more = ["--scalars", tmp_path / "a.csv"] if option == "--triangle-scalars" else ["-o", tmp_path / "a.ply"]
    status, err = run(*more, option, tmp_path / "." / name)
    assert (status, err) == (2, f"error: {name} would be written twice; give each file a name of its own.\n")
    assert sorted(tmp_path.iterdir()) == before


def test_replay_session_writes_nothing_where_its_report_cannot_be_written(run, tmp_path):
    before = sorted(tmp_path.iterdir())
    status, _ = run("--animation", tmp_path / "a.pc2", "--report", tmp_path / "gone" / "r.json")
    assert status == 2
    assert sorted(tmp_path.iterdir()) == before
