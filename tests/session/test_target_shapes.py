"""A target shape is a step of undo, is kept in the session file, and is not sent to the solver."""

import json
import threading
import zipfile
from dataclasses import replace

import numpy as np
import pytest
from driven_session import VIEW, bar, check_equal
from meshes import sphere

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session import shape_editor
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.processes.array_pipe import ArrayPacker
from apd_viewer.session.storage.session_file import open_session, save_session


@pytest.fixture
def file(tmp_path):
    """The bar, longer by a half, in a file."""
    mesh, path = bar(), tmp_path / "shapes" / "longer.obj"
    path.parent.mkdir()
    save_mesh(mesh, mesh.V * [1.0, 1.0, 1.5], path)
    return path


@pytest.fixture
def mesh(tmp_path):
    """The bar in a file."""
    mesh, path = bar(), tmp_path / "bar.obj"
    save_mesh(mesh, mesh.V, path)
    return open_mesh(path)


@pytest.fixture
def compared(file, mesh):
    """The bar with its target shape."""
    state = initial_state(mesh)
    return state.updated(replace(state.document, target_shape=TargetShape(open_mesh(file))))


def load(session, path):
    session.shapes.load_target(path)
    session.until(lambda: session.jobs.current is None)


def test_target_shapes_load_and_clear_are_steps_of_undo(session, file):
    first = session.store.state.document
    load(session, file)
    second = session.store.state.document
    assert second.target_shape.mesh.path == file
    assert second.target_shape.has_same_triangles(second.mesh)
    assert session.told[-1] == "Comparing with longer.obj."
    assert session.saved_work.is_unsaved
    session.shapes.clear_target()
    assert session.store.state.document.target_shape is None
    session.gestures.undo()
    assert session.store.state.document is second
    session.gestures.undo()
    assert session.store.state.document is first
    session.gestures.redo()
    assert session.store.state.document is second
    assert session.gestures.history.undo_names[-1] == "Load target shape"
    session.show_now(Mesh(*sphere(1)))
    assert session.store.state.document.target_shape is None, "it was for another mesh"


def test_target_shapes_say_that_another_mesh_was_opened_meanwhile(session, file, monkeypatch):
    read = threading.Event()
    monkeypatch.setattr(shape_editor, "open_mesh", lambda path: open_mesh(path) if read.wait(60.0) else None)
    before = session.store.state
    session.show_now(Mesh(*sphere(1)))
    session.shapes.load_target(file)
    session.gestures.undo()
    read.set()
    session.until(lambda: session.jobs.current is None)
    assert session.store.state.document is before.document
    assert session.failed == ["Another mesh was opened meanwhile; load the file again."]


def test_target_shapes_leave_the_shape_to_be_solved_as_without_a_target(session, file, monkeypatch):
    load(session, file)
    document = session.store.state.document
    sent, packed_message = [], ArrayPacker.packed_message

    def noted(packer, request):
        sent.append(request.document)
        return packed_message(packer, request)

    monkeypatch.setattr(ArrayPacker, "packed_message", noted)
    session.drag(np.diag([1.0, 1.0, 1.1, 1.0]))
    session.settle()
    assert session.store.state.document.target_shape is document.target_shape
    assert session.store.state.frame.converged
    assert {each.target_shape for each in sent} == {None}
    assert sent[-1].labels is document.labels


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ("", "longer.obj is empty"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "no faces"),
        (None, "There is no file"),
    ],
)
def test_target_shapes_load_refuses_a_file_that_is_no_mesh_in_a_sentence(session, file, content, sentence):
    file.unlink()
    if content is not None:
        file.write_text(content)
    before = session.store.state
    load(session, file)
    assert session.store.state is before
    assert sentence.lower() in session.failed[-1].lower()


def test_target_shapes_load_tells_of_a_target_in_another_unit(session, file):
    mesh = bar()
    save_mesh(mesh, 1000.0 * mesh.V, file)
    load(session, file)
    assert session.told[-1] == (
        "longer.obj is 1e+03 times as large as mesh; check its unit of length and scale its file."
    )


@pytest.mark.parametrize("embed", [False, True])
def test_open_session_opens_a_session_with_its_target(compared, file, tmp_path, embed):
    path = tmp_path / "a.apd"
    save_session(path, compared, VIEW, embed=embed)
    copies = [name for name in zipfile.ZipFile(path).namelist() if name.startswith("target-")]
    assert copies == (["target-mesh.obj"] if embed else [])
    if embed:
        file.unlink()
    found, _ = open_session(path)
    check_equal(found, compared)
    assert found.document.target_shape.mesh.name == file.name


def test_save_session_embeds_a_target_that_is_in_no_file(compared, tmp_path):
    target = TargetShape(Mesh(*sphere(1)))
    state = compared.updated(replace(compared.document, target_shape=target))
    assert save_session(tmp_path / "a.apd", state, VIEW) is False, "the mesh itself is in its file"
    found, _ = open_session(tmp_path / "a.apd")
    assert found.document.target_shape.mesh.digest == target.mesh.digest


def test_open_session_misses_a_missing_target_and_does_not_forget_it(session, compared, file, tmp_path):
    path, away = tmp_path / "a.apd", tmp_path / "away.obj"
    save_session(path, compared, VIEW)
    file.rename(away)
    session.files.open(path)
    session.until(lambda: session.jobs.current is None)
    document = session.store.state.document
    assert document.target_shape is None
    assert session.told[-1].startswith(
        "The target shape is not shown: longer.obj, a mesh of a.apd, is missing (looked for at"
    )
    save_session(tmp_path / "again.apd", session.store.state, VIEW)
    away.rename(file)
    found, _ = open_session(tmp_path / "again.apd")
    assert found.document.target_shape.mesh.path == file
    session.shapes.clear_target()
    assert session.store.state.document.missing_target_shape is None


def test_open_session_refuses_a_damaged_target(compared, tmp_path):
    path = tmp_path / "a.apd"
    save_session(path, compared, VIEW, embed=True)
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    said = json.loads(members["session.json"])
    for change in ({"embedded": ["target-shape.npy"]}, {"digest": "0" * 64}, {"name": 3}):
        with zipfile.ZipFile(path, "w") as archive:
            for name, content in members.items():
                wrong = json.dumps({**said, "target": {**said["target"], **change}}).encode()
                archive.writestr(name, wrong if name == "session.json" else content)
        if change == {"embedded": ["target-shape.npy"]}:
            (tmp_path / "shapes" / "longer.obj").unlink()
        with pytest.raises(InputError, match=r"a\.apd is not a valid session"):
            open_session(path)
