"""Pipes and devices are refused in a sentence, whether a command names them or a file does."""

import csv
import io
import json
import os
import zipfile
from pathlib import Path

import numpy as np
import pytest
from meshes import ends, sphere
from watched_pipe import WatchedPipe

from apd_viewer.__main__ import main
from apd_viewer.cases.database import DATABASE_NAME
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.view import View
from apd_viewer.session.storage.session_file import save_session

PAINTED = ("deform", "part.off", "--selection", "part.sel")
COMMANDS = {
    "selection": ("deform", "part.off", "--twist", "3deg", "-o", "x.off", "--selection", "{}"),
    "transform": (*PAINTED, "-o", "x.off", "--transform", "{}"),
    "obstacles": (*PAINTED, "--twist", "3deg", "-o", "x.off", "--obstacles", "{}"),
    "region": (*PAINTED, "--twist", "3deg", "-o", "x.off", "--region", "100", "{}"),
    "compare": (*PAINTED, "--twist", "3deg", "-o", "x.off", "--iterations", "1", "--compare", "{}.off"),
    "sweep selection": ("sweep", "part.off", "--twist", "3deg", "-o", "x", "--selection", "{}"),
    "sweep transform": ("sweep", "part.off", "--selection", "part.sel", "-o", "x", "--transform", "{}"),
    "rest": ("volumes", "part.off", "--rest", "{}.off"),
    "info": ("info", "{}.off"),
    "info compare": ("info", "part.off", "--compare", "{}.off"),
    "deck": ("deck", "{}.apd", "-o", "x.inp"),
    "replay": ("replay", "{}.apd", "-o", "x.off"),
    "press": ("press", "{}.off", "--to", "95%", "-o", "x.off"),
    "study": ("study", "{}", "-o", "x"),
    "study by a scheduler": ("study", "plan.csv", "-o", "x", "--scheduler-file", "{}"),
    "thumbnail of a session": ("thumbnail", "{}.apd", "x.png"),
    "thumbnail of a mesh": ("thumbnail", "{}.off", "x.png"),
    "window": ("{}.off",),
    "window on a session": ("{}.apd",),
}
ENDINGS = "", ".off", ".apd", ".sel", ".json", ".npz", ".ply", ".dmat"


@pytest.fixture
def pipe(tmp_path, monkeypatch):
    """A pipe by many names, in the working folder, beside a mesh with its paint."""
    monkeypatch.chdir(tmp_path)
    V, F = sphere(2)
    save_mesh(Mesh(V, F), V, Path("part.off"))
    labels = np.ones(len(V), dtype=int)
    labels[ends(V)[0]], labels[ends(V)[1]] = 0, 2
    np.savetxt("part.sel", labels, fmt="%d")
    pipe = WatchedPipe(tmp_path / "pipe")
    for ending in ENDINGS:
        Path(f"zero{ending}").symlink_to("/dev/zero")
        if ending:
            Path(f"pipe{ending}").symlink_to("pipe")
    plan = ("mesh", "selection", "motion"), ("part.off", "part.sel", "twist 3deg")
    with Path("plan.csv").open("w", newline="") as stream:
        csv.writer(stream).writerows(plan)
    yield pipe
    pipe.close()


def refused(capsys, words, begins="error: "):
    """The one sentence by which a command refuses."""
    try:
        status = main(words)
    except SystemExit as end:
        status = end.code
    said = capsys.readouterr().err.strip()
    assert status == 2, said
    assert said.startswith(begins), said
    assert len(said.splitlines()) == 1
    return said


@pytest.mark.parametrize("named", ["pipe", "zero"])
@pytest.mark.parametrize("what", COMMANDS)
def test_main_refuses_a_pipe_given_by_name_and_does_not_open_it(what, named, pipe, capsys):
    said = refused(capsys, [word.format(named) for word in COMMANDS[what]])
    assert not pipe.opened, said
    assert named in said


@pytest.mark.parametrize("ending", ENDINGS[3:])
@pytest.mark.parametrize("named", ["pipe", "zero"])
def test_deform_refuses_a_pipe_in_the_place_of_each_kind_of_selection(named, ending, pipe, capsys):
    words = [word.format(f"{named}{ending}") for word in COMMANDS["selection"]]
    assert "name a file instead" in refused(capsys, words)
    assert not pipe.opened


def test_deform_refuses_a_pipe_of_the_shell_without_waiting(pipe, capsys):
    """As by ``<(...)`` or ``... |``: what is in it is lost, and nothing is waited for."""
    read, write = os.pipe()
    os.write(write, Path("part.sel").read_bytes()[:1000])
    try:
        said = refused(capsys, [word.format(f"/dev/fd/{read}") for word in COMMANDS["selection"]])
    finally:
        os.close(read)
        os.close(write)
    assert "name a file instead" in said


@pytest.mark.parametrize("named", ["pipe", "zero"])
def test_study_opens_no_pipe_that_a_plan_of_a_stranger_names(named, pipe):
    plan = (
        ("mesh", "selection", "motion"),
        (f"{named}.off", "part.sel", "twist 3deg"),
        ("part.off", f"{named}.sel", "twist 3deg"),
        ("part.off", f"{named}.json", "twist 3deg"),
        (f"{named}.apd", "", "twist 3deg"),
    )
    with Path("plan.csv").open("w", newline="") as stream:
        csv.writer(stream).writerows(plan)
    assert main(["study", "plan.csv", "-o", "x", "--processes", "1"]) in (0, 2)
    assert not pipe.opened
    notes = list(csv.DictReader(io.StringIO(Path("x/results.csv").read_text(encoding="utf-8-sig"))))
    assert len(notes) == 4
    for row in notes:
        assert any("is not a file" in cell or "name a file instead" in cell for cell in row.values()), row


@pytest.mark.parametrize("ending", ["", "-journal", "-wal"])
def test_study_opens_no_pipe_in_a_folder_from_a_stranger(ending, pipe, capsys):
    Path("x").mkdir()
    if ending:
        (Path("x") / DATABASE_NAME).write_bytes(b"")
    (Path("x") / f"{DATABASE_NAME}{ending}").symlink_to(pipe.path)
    said = refused(capsys, ["study", "plan.csv", "-o", "x", "--processes", "1"])
    assert f"{DATABASE_NAME}{ending}" in said
    assert not pipe.opened


def edited(session, change):
    """Change what a session says."""
    with zipfile.ZipFile(session) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    said = json.loads(members["session.json"])
    change(said)
    members["session.json"] = json.dumps(said).encode()
    with zipfile.ZipFile(session, "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)


@pytest.mark.parametrize("named", ["pipe", "zero"])
def test_open_session_opens_no_pipe_that_a_session_of_a_stranger_names(named, pipe, capsys):
    V = open_mesh("part.off").V
    state = initial_state(open_mesh("part.off"), np.loadtxt("part.sel").astype(np.uint8))
    save_session("mesh.apd", state, View())

    def change(said):
        said["mesh"] |= {
            "name": f"{named}.off",
            "path": str(Path(f"{named}.off").absolute()),
            "relative": f"{named}.off",
        }

    edited("mesh.apd", change)
    refused(capsys, ["deck", "mesh.apd", "-o", "x.inp"])
    save_session("target.apd", state, View())
    told = {"name": f"{named}.off", "vertices": len(V), "faces": 3, "digest": "0" * 64}
    edited(
        "target.apd", lambda said: said.update(target=told | {"path": str(Path(f"{named}.off").absolute())})
    )
    main(["replay", "target.apd", "-o", "x.off"])
    assert not pipe.opened
