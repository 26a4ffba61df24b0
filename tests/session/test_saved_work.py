"""Whatever is said is unsaved until it is saved, or undone up to what was saved."""

import numpy as np
import pytest
from driven_session import BENT, VIEW, Driven, bar, pose
from living import living

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.geometry.pose.constraints import BASE
from apd_viewer.session.saved_work import SavedDocument
from apd_viewer.session.storage.session_file import save_session

SAID = {
    "paint": lambda session: session.stroke(np.arange(9), BASE),
    "region": lambda session: session.parts.add_region(),
    "name": lambda session: session.parts.rename_handle(0, "neck"),
    "pivot": lambda session: session.handles.set_pivot(np.zeros(3), 0),
    "target": lambda session: session.settings.change(area=101.0),
    "stiffness": lambda session: session.settings.change(stiffness=0.5),
    "method": lambda session: session.settings.change(method="arap"),
}


def wait(session):
    session.until(lambda: session.jobs.current is None)


@pytest.fixture
def opened(empty):
    """A bar on which nothing has been said."""
    empty.show_now(bar())
    return empty


def test_saved_work_has_nothing_unsaved_before_a_mesh_is_open():
    session = Driven()
    assert not session.saved_work.is_unsaved
    session.close()


def test_saved_work_does_not_count_a_mesh_that_was_only_opened_as_unsaved(opened):
    assert not opened.saved_work.is_unsaved
    assert opened.saved_work.path is None


@pytest.mark.parametrize("said", SAID)
def test_saved_work_counts_whatever_is_said_as_unsaved_until_it_is_saved(opened, tmp_path, said):
    SAID[said](opened)
    assert opened.saved_work.is_unsaved
    opened.files.save(tmp_path / "a.apd", VIEW)
    assert opened.saved_work.is_unsaved, "it is not written yet"
    wait(opened)
    assert not opened.saved_work.is_unsaved
    assert opened.saved_work.path == tmp_path / "a.apd"
    opened.gestures.undo()
    assert opened.saved_work.is_unsaved, "the file says more than the screen"
    opened.gestures.redo()
    assert not opened.saved_work.is_unsaved


@pytest.mark.parametrize("said", SAID)
def test_saved_work_counts_whatever_is_undone_as_unsaved_no_longer(opened, said):
    SAID[said](opened)
    opened.gestures.undo()
    assert not opened.saved_work.is_unsaved


def test_saved_work_counts_a_motion_as_unsaved_at_once_and_not_the_shape_that_follows(session, tmp_path):
    session.files.save(tmp_path / "a.apd", VIEW)
    wait(session)
    session.drag(BENT)
    assert session.saved_work.is_unsaved
    session.files.save(tmp_path / "a.apd", VIEW)
    session.settle()
    assert not session.saved_work.is_unsaved


def test_saved_work_leaves_unsaved_what_is_said_while_a_file_is_written(session, tmp_path):
    session.files.save(tmp_path / "a.apd", VIEW)
    session.stroke(np.arange(3), BASE)
    wait(session)
    assert session.saved_work.is_unsaved
    session.gestures.undo()
    assert not session.saved_work.is_unsaved


def test_saved_work_stays_unsaved_though_the_mesh_is_exported(session, tmp_path):
    session.drag(BENT)
    session.settle()
    session.files.export(tmp_path / "bent.ply")
    wait(session)
    assert session.saved_work.is_unsaved


def test_saved_work_leaves_unsaved_what_could_not_be_saved(session, tmp_path):
    done = []
    session.files.save(tmp_path / "gone" / "a.apd", VIEW, on_success=lambda: done.append(1))
    wait(session)
    assert (session.saved_work.is_unsaved, session.saved_work.path, done) == (True, None, [])


def test_saved_work_has_an_opened_session_saved_where_it_came_from(session, tmp_path):
    save_mesh(bar(), bar().V, tmp_path / "bar.obj")
    save_session(tmp_path / "a.apd", session.store.state, VIEW)
    session.files.open(tmp_path / "a.apd")
    wait(session)
    assert (session.saved_work.is_unsaved, session.saved_work.path) == (False, tmp_path / "a.apd")


def test_saved_work_goes_back_to_the_file_of_the_first_in_undo_across_an_opened_mesh(session, tmp_path):
    session.files.save(tmp_path / "a.apd", VIEW)
    wait(session)
    session.show_now(bar())
    assert (session.saved_work.is_unsaved, session.saved_work.path) == (False, None)
    session.gestures.undo()
    assert (session.saved_work.is_unsaved, session.saved_work.path) == (False, tmp_path / "a.apd")
    session.gestures.undo()
    assert session.saved_work.is_unsaved


def test_saved_work_counts_a_baked_shape_as_unsaved_on_the_same_file(session, tmp_path):
    session.drag(BENT)
    session.settle()
    session.files.save(tmp_path / "a.apd", VIEW)
    wait(session)
    session.shapes.bake()
    wait(session)
    assert (session.saved_work.is_unsaved, session.saved_work.path) == (True, tmp_path / "a.apd")
    session.gestures.undo()
    assert not session.saved_work.is_unsaved


def test_saved_work_forgets_meshes_out_of_reach_of_undo(session):
    session.gestures.limit_memory(0)
    others = living(SavedDocument) - 1
    for _ in range(5):
        session.show_now(bar())
    assert living(SavedDocument) - others <= 3


def test_saved_work_has_nothing_unsaved_after_a_drag_called_off(session, tmp_path):
    session.files.save(tmp_path / "a.apd", VIEW)
    wait(session)
    session.gestures.begin()
    session.handles.drag(pose(0.2))
    assert session.saved_work.is_unsaved
    session.gestures.cancel()
    assert not session.saved_work.is_unsaved


def test_saved_work_counts_a_gesture_under_way_as_unsaved_though_its_beginning_was_saved(session, tmp_path):
    session.gestures.begin()
    session.handles.drag(pose(0.2))
    session.files.save(tmp_path / "a.apd", VIEW)
    wait(session)
    assert session.saved_work.is_unsaved
    session.gestures.cancel()
    assert not session.saved_work.is_unsaved
