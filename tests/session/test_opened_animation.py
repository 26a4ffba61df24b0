"""Animations on the timeline: looked at, measured, exported, made the rest shape, and gone back from."""

import numpy as np
import pytest
import trimesh
from animated import animated
from meshes import box

from apd_viewer.files.animations.animation_files import write_animation
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.timeline import Timeline
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.storage.timeline_file import write_timeline

BAR = Mesh(*box(2, 2, 6))


@pytest.fixture
def series(tmp_path):
    """A series of four shapes, and these."""
    animation, shapes = animated(BAR, tmp_path / "shapes")
    write_animation(animation, tmp_path / "a.pvd")
    return tmp_path / "a.pvd", shapes


def opened(session, path):
    session.files.open(path)
    session.settle()
    return session.player.timeline.steps


def test_opened_animation_is_a_step_for_each_shape(empty, series):
    path, shapes = series
    steps = opened(empty, path)
    assert np.array_equal([step.state.frame.U for step in steps], shapes)
    assert empty.store.state is steps[0].state
    assert empty.player.shown_step == 0
    assert [step.begins_run for step in steps] == [True, False, False, False]
    assert not empty.saved_work.is_unsaved
    assert empty.saved_work.last_saved.title == "a.pvd"
    area = [step.state.frame.area for step in steps]
    assert area == pytest.approx([trimesh.Trimesh(U, BAR.F, process=False).area for U in shapes])


def test_opened_animation_lets_a_shape_be_measured_exported_and_baked(empty, series, tmp_path):
    path, shapes = series
    opened(empty, path)
    empty.player.show_step(2)
    empty.player.accept_shown_step()
    empty.settle()
    assert np.array_equal(empty.U, shapes[2])
    assert empty.gestures.history.undo_names == [], "all shapes are on the timeline"
    assert not empty.saved_work.is_unsaved
    empty.files.export(tmp_path / "b.vtu")
    empty.settle()
    assert np.array_equal(open_mesh(tmp_path / "b.vtu").V, shapes[2])
    empty.shapes.bake()
    empty.settle()
    assert np.array_equal(empty.store.state.document.mesh.V, shapes[2])
    assert empty.player.timeline.belongs_to(empty.store.state.document), "it has the same triangles"
    empty.player.show_step(1)
    assert np.array_equal(empty.U, shapes[1])


def test_opened_animation_is_deformed_from_the_shape_on_screen(empty, series):
    path, shapes = series
    opened(empty, path)
    empty.player.show_step(1)
    empty.player.accept_shown_step()
    empty.stroke(np.flatnonzero(BAR.V[:, 2] < 0.5), BASE)
    assert np.array_equal(empty.store.state.document.initial_positions, shapes[1])
    assert np.array_equal(empty.U, shapes[1])
    empty.player.show_step(3)
    empty.player.accept_shown_step()
    assert empty.gestures.history.undo_names[-1] == "Go to another step"
    empty.gestures.undo()
    assert empty.store.state.document.label_counts[BASE] > 0


def test_opened_animation_of_a_point_cache_goes_onto_the_open_mesh(session, tmp_path):
    before = session.store.state
    animation, shapes = animated(before.document.mesh, tmp_path / "shapes")
    write_animation(animation, tmp_path / "a.pc2")
    session.drag(np.eye(4) + np.eye(4, k=3))
    session.settle()
    steps = opened(session, tmp_path / "a.pc2")
    for step, U in zip(steps, shapes, strict=True):
        np.testing.assert_allclose(step.state.frame.U, U, atol=1e-6)
    document = session.store.state.document
    assert document.mesh is before.document.mesh
    assert document.labels is before.document.labels
    assert not document.is_posed
    assert session.gestures.history.undo_names[-1] == "Open a.pc2"


def test_opened_animation_of_a_point_cache_needs_its_mesh(empty, tmp_path):
    animation, _ = animated(BAR, tmp_path / "shapes")
    write_animation(animation, tmp_path / "a.mdd")
    opened(empty, tmp_path / "a.mdd")
    assert "open the mesh that it was written of first" in empty.failed[-1]
    assert empty.store.state is None


def test_opened_mesh_leaves_the_timeline_of_another_one(empty, series, tmp_path):
    path, _ = series
    steps = opened(empty, path)
    empty.files.export(tmp_path / "b.obj")
    empty.settle()
    assert opened(empty, tmp_path / "b.obj") is steps
    assert not empty.player.timeline.belongs_to(empty.store.state.document)
    empty.gestures.undo()
    assert empty.player.shown_step == 0, "undo leads back to the animation"


def test_write_timeline_writes_an_animation_in_metres_of_its_unit(tmp_path):
    timeline = Timeline().with_state(initial_state(BAR))
    write_timeline(timeline, tmp_path / "a.glb", [(np.nan, np.nan)], unit=Unit.CENTIMETRE)
    np.testing.assert_allclose(open_mesh(tmp_path / "a.glb").V, 0.01 * BAR.V, atol=1e-9)
