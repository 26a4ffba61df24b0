"""The shape on screen taken for the rest shape: a mesh like any other, of the same file, and undone."""

import time
from dataclasses import replace

import numpy as np
import pytest
from driven_session import BENT, Driven, pose
from meshes import box, rotation

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import WRITABLE_FORMATS, save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import HANDLE
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.view import View
from apd_viewer.session.shape_editor import baked_state
from apd_viewer.session.storage.session_file import open_session, save_session

VIEW = View()


def bake(session: Driven) -> None:
    session.shapes.bake()
    session.until(lambda: session.jobs.current is None)


def test_bake_puts_the_shape_at_rest_as_a_mesh_of_that_shape_would_be(session):
    session.drag(BENT)
    session.settings.change(area=104.0)
    session.parts.add_region()
    session.gestures.begin()
    session.painting.paint_region(np.arange(40), 1)
    session.painting.end_stroke("Paint region")
    session.settings.set_region_area(0, 97.0)
    session.settle()
    before = session.store.state
    bake(session)
    state, document = session.store.state, session.store.state.document
    alone = initial_state(Mesh(before.frame.U, before.document.mesh.F))
    assert state.frame.U is document.mesh.V
    assert np.array_equal(state.frame.U, before.frame.U)
    assert state.frame.area == state.inspection.area == alone.inspection.area
    assert state.inspection.volume == alone.inspection.volume
    assert state.frame.regions == document.region_areas(document.mesh.V) == before.frame.regions
    assert (document.settings.area, document.regions[0].area, document.is_posed) == (100.0, 100.0, False)
    assert document.labels is before.document.labels
    assert session.store.state.is_at_rest
    assert "104.000 %" in session.told[-1]


def test_bake_makes_a_shape_that_deforms_as_a_mesh_of_it_would(session):
    session.drag(BENT)
    session.settle()
    bake(session)
    further = pose(0.0, (0.3, 0.0, 0.2))
    session.drag(further)
    session.settle()
    other = Driven()
    try:
        other.show_now(Mesh(session.store.state.document.mesh.V, session.store.state.document.mesh.F))
        other.gestures.begin()
        for label in (0, HANDLE):
            other.painting.paint(np.flatnonzero(session.store.state.document.labels == label), label)
        other.painting.end_stroke("Paint")
        other.drag(further)
        other.settle()
        assert np.abs(other.U - session.U).max() < 1e-9
    finally:
        other.close()
    assert abs(session.store.state.frame.area_error) < 1e-9


def test_bake_is_undone_and_done_again(session):
    session.drag(BENT)
    session.settle()
    before = session.store.state
    bake(session)
    after = session.store.state
    session.gestures.undo()
    assert session.store.state is before
    session.gestures.redo()
    assert session.store.state is after
    session.shapes.restore()
    assert session.store.state is after, "there is nothing to put back"


def test_bake_takes_the_shape_that_was_on_screen_though_it_goes_on(session):
    session.settings.change(tolerance=1e-12)  # not to be met
    session.settings.change(method="paper")
    session.drag(BENT)
    session.until(lambda: session.store.state.frame.iteration > 3)
    shown = session.U
    session.shapes.bake()
    time.sleep(0.2)
    session.until(lambda: session.jobs.current is None)
    assert session.U is shown
    assert session.U is session.store.state.document.mesh.V


def test_bake_refuses_what_has_been_dragged_on_meanwhile(session):
    session.drag(BENT)
    session.settle()
    before = session.store.state.document.mesh
    session.shapes.bake()
    session.drag(pose(0.2))
    session.until(lambda: session.jobs.current is None)
    assert session.store.state.document.mesh is before
    assert "bake it again" in session.failed[-1]


def test_baked_state_refuses_a_shape_without_area():
    state = initial_state(Mesh(*box(1, 1, 2)))
    flat = state.updated(frame=replace(state.frame, U=np.zeros_like(state.frame.U)))
    with pytest.raises(InputError, match="no area"):
        baked_state(flat)


def turned(mesh: Mesh):
    """The mesh at rest in a shape of which a part stands where the file has it, and what it was before."""
    U = mesh.V.copy()
    upper = U[:, 2] > 2.5
    U[upper] = U[upper] @ rotation((0, 0, 1), 0.3).T + (0.1, 0.0, 1.0 / 3.0)
    U.flags.writeable = False
    state = initial_state(mesh)
    return baked_state(state.updated(frame=replace(state.frame, U=U)))


@pytest.mark.parametrize("suffix", WRITABLE_FORMATS)
def test_save_mesh_writes_a_baked_mesh_into_its_file_as_any_shape(suffix, tmp_path):
    path = tmp_path / f"bar{suffix}"
    save_mesh(made := Mesh(*box(2, 2, 6)), made.V, path)
    mesh = open_mesh(path)
    state = turned(mesh)
    save_mesh(mesh, state.frame.U, tmp_path / f"one{suffix}")
    save_mesh(state.document.mesh, state.frame.U, tmp_path / f"two{suffix}")
    assert (tmp_path / f"one{suffix}").read_bytes() == (tmp_path / f"two{suffix}").read_bytes()
    save_mesh(state.document.mesh, mesh.V, tmp_path / f"back{suffix}")
    assert (tmp_path / f"back{suffix}").read_bytes() == path.read_bytes()
    again = state.document.mesh.baked(mesh.V)
    assert again.origin.mesh is mesh, "not one origin within another"


@pytest.mark.parametrize("suffix", WRITABLE_FORMATS)
def test_open_session_brings_a_baked_mesh_back_with_its_file(suffix, tmp_path):
    path = tmp_path / f"bar{suffix}"
    save_mesh(made := Mesh(*box(2, 2, 6)), made.V, path)
    content = path.read_bytes()
    state = turned(open_mesh(path))
    assert save_session(tmp_path / "a.apd", state, VIEW) is True, "no file holds it"
    path.unlink()
    mesh = open_session(tmp_path / "a.apd")[0].document.mesh
    assert np.array_equal(mesh.V, state.document.mesh.V)
    assert np.array_equal(mesh.weld.first, state.document.mesh.weld.first)
    save_mesh(mesh, mesh.origin.mesh.V, path)
    assert path.read_bytes() == content


def test_mesh_baked_keeps_joined_what_was_joined_and_joins_no_more():
    V, F = box(1, 1, 2)
    V, F = V[F].reshape(-1, 3), np.arange(F.size).reshape(-1, 3)
    mesh = Mesh(V, F)
    U = V + np.array([0.0, 0.0, 1.0]) * (V[:, 2:] > 1.0)
    U.flags.writeable = False
    assert np.array_equal(mesh.baked(U).weld.inverse, mesh.weld.inverse)
    # Two corners that come to lie at one place are not joined by that.
    squeezed = V.copy()
    squeezed[(V == (1.0, 1.0, 2.0)).all(axis=1)] = (0.0, 1.0, 2.0)
    squeezed.flags.writeable = False
    assert len(mesh.baked(squeezed).weld.first) == len(mesh.weld.first)
