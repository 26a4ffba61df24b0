"""Seams are welded at a click: a step of undo, kept in the session; the file gets its own vertices back."""

import numpy as np
import pytest
from seams import halves

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.analysis.shape_check import SEAMS
from apd_viewer.geometry.measuring.measurement import Plane
from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.presentation.python_script import python_script
from apd_viewer.session.model import memo
from apd_viewer.session.model.view import View
from apd_viewer.session.storage.session_file import open_session, save_session

V, F = halves(1e-5)
COPIES = Mesh(V, F).welded().weld.representative
APART = np.flatnonzero(np.arange(len(V)) != COPIES)


@pytest.fixture
def tube(empty, tmp_path):
    """A session on the file of a tube in two halves, its ends painted; of the seam one side only."""
    save_mesh(Mesh(V, F), V, tmp_path / "halves.obj")
    empty.show_now(open_mesh(tmp_path / "halves.obj"))
    low, high = np.flatnonzero(V[:, 2] < 0.01), np.flatnonzero(V[:, 2] > 5.9)
    empty.stroke(np.setdiff1d(low, APART), BASE)
    empty.stroke(np.setdiff1d(high, COPIES[APART]), HANDLE)
    return empty


def weld(session):
    session.shapes.weld()
    session.until(lambda: session.jobs.current is None)
    session.settle()


def quarter():
    pose = np.eye(4)
    pose[:2, :2] = [[0.0, -1.0], [1.0, 0.0]]
    return pose


def torn(U):
    return np.linalg.norm(U[APART] - U[COPIES[APART]], axis=1).max()


def kinds(session):
    return [finding.kind for finding in session.store.state.inspection.findings]


def test_weld_is_a_step_of_undo(tube):
    before = tube.store.state
    assert SEAMS in kinds(tube)
    weld(tube)
    document = tube.store.state.document
    assert SEAMS not in kinds(tube)
    assert document.mesh.V is before.document.mesh.V
    assert tube.U is document.mesh.V, "at rest it stays"
    assert np.array_equal(document.labels, document.labels[COPIES]), "both sides are painted alike"
    assert document.label_counts[BASE] == document.label_counts[HANDLE] == 14
    tube.gestures.undo()
    assert tube.store.state is before
    tube.gestures.redo()
    assert tube.store.state.document.mesh.has_welded_seams


def test_weld_holds_a_tube_together_in_the_pose(tube):
    weld(tube)
    tube.drag(quarter())
    tube.settle()
    assert tube.store.state.frame.converged
    assert torn(tube.U) < 1.01 * torn(V)


def test_weld_closes_a_torn_shape(tube):
    tube.drag(quarter())
    tube.settle()
    assert torn(tube.U) > 0.1
    tube.stroke(np.flatnonzero(np.abs(V[:, 2] - 3.0) < 0.1), BASE)  # gripped where it is torn
    weld(tube)
    assert not tube.failed
    assert torn(tube.U) < 1.01 * torn(V)


def test_save_session_keeps_the_weld_and_the_file_its_vertices(tube, tmp_path):
    weld(tube)
    tube.drag(quarter())
    tube.settle()
    state = tube.store.state
    save_session(tmp_path / "tube.apd", state, View())
    found, _ = open_session(tmp_path / "tube.apd")
    assert np.array_equal(found.document.mesh.weld.representative, state.document.mesh.weld.representative)
    assert np.array_equal(found.frame.U, state.frame.U)
    assert found.frame.area == pytest.approx(state.frame.area, rel=1e-12)
    save_mesh(state.document.mesh, state.frame.U, tmp_path / "out.obj")
    again = open_mesh(tmp_path / "out.obj")
    assert np.array_equal(again.F, F)
    np.testing.assert_allclose(again.V, state.frame.U, rtol=0, atol=1e-12)
    rest = state.document.mesh
    save_mesh(rest, rest.V, tmp_path / "rest.obj")
    assert (tmp_path / "rest.obj").read_bytes() == (tmp_path / "halves.obj").read_bytes()
    assert "weld=True" in python_script(state.document)


def test_open_session_opens_without_a_weld_a_session_that_has_none(tube, tmp_path):
    save_session(tmp_path / "tube.apd", tube.store.state, View())
    assert not open_session(tmp_path / "tube.apd")[0].document.mesh.has_welded_seams


def test_bake_leaves_a_welded_shape_welded(tube, tmp_path):
    weld(tube)
    tube.drag(quarter())
    tube.settle()
    tube.shapes.bake()
    tube.until(lambda: tube.jobs.current is None)
    state = tube.store.state
    save_session(tmp_path / "tube.apd", state, View())
    found = open_session(tmp_path / "tube.apd")[0].document.mesh
    assert np.array_equal(found.weld.representative, COPIES)


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_in_place_tolerance_is_so_in_any_unit(scale):
    large = Mesh(scale * V, F).welded()
    there = [memo.in_place_tolerance(mesh.V, mesh.weld) for mesh in (Mesh(V, F).welded(), large)]
    assert there[1] == pytest.approx(scale * there[0], rel=1e-3)


def test_open_session_refuses_a_damaged_weld(tube, tmp_path, monkeypatch):
    weld(tube)
    mesh = tube.store.state.document.mesh
    damaged = np.full(len(V), len(V) - 1)
    monkeypatch.setattr(type(mesh.weld), "representative", property(lambda _: damaged))
    save_session(tmp_path / "tube.apd", tube.store.state, View())
    monkeypatch.undo()
    with pytest.raises(InputError, match="weld"):
        open_session(tmp_path / "tube.apd")


def test_weld_measures_the_shape_anew(tube):
    """A section encloses an area only once the seam is welded."""
    tube.measurements.add(MeasurementKind.SECTION, plane=Plane((0.0, 0.0, 1.0), 2.75))

    def area_at_rest():
        (reading,) = tube.measurement_readings.readings(tube.store.state)
        return reading.rest.values[1]

    assert np.isnan(area_at_rest())
    weld(tube)
    assert area_at_rest() == pytest.approx(3.0, rel=1e-4)  # of a dodecagon in a circle of radius 1
    tube.gestures.undo()
    assert np.isnan(area_at_rest())
