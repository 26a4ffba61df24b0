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
    "target": lambda session: session.settings.set_area(101.0),
    "stiffness": lambda session: session.settings.set_stiffness(0.5),
    "method": lambda session: session.settings.set_method("arap"),
}


def wait(session):
    session.until(lambda: session.jobs.current is None)


@pytest.fixture
def opened(empty):
    """A bar on which nothing has been said."""
    empty.show_now(bar())
    return empty


def test_nothing_is_unsaved_before_a_mesh_is_open():
    session = Driven()
    assert not session.saved_work.unsaved
    session.close()


def test_a_mesh_that_was_only_opened_is_not_unsaved(opened):
    assert not opened.saved_work.unsaved
    assert opened.saved_work.path is None


@pytest.mark.parametrize("said", SAID)
def test_whatever_is_said_is_unsaved_until_it_is_saved(opened, tmp_path, said):
    SAID[said](opened)
    assert opened.saved_work.unsaved
    opened.files.save(tmp_path / "a.apd", VIEW)
    assert opened.saved_work.unsaved, "it is not written yet"
    wait(opened)
    assert not opened.saved_work.unsaved
    assert opened.saved_work.path == tmp_path / "a.apd"
    opened.gestures.undo()
    assert opened.saved_work.unsaved, "the file says more than the screen"
    opened.gestures.redo()
    assert not opened.saved_work.unsaved


@pytest.mark.parametrize("said", SAID)
def test_whatever_is_undone_is_no_longer_unsaved(opened, said):
    SAID[said](opened)
    opened.gestures.undo()
    assert not opened.saved_work.unsaved


def test_a_motion_is_unsaved_at_once_and_the_shape_that_follows_is_no_work(session, tmp_path):
    session.files.save(tmp_path / "a.apd", VIEW)
    wait(session)
    session.drag(BENT)
    assert session.saved_work.unsaved
    session.files.save(tmp_path / "a.apd", VIEW)
    session.settle()
    assert not session.saved_work.unsaved


def test_what_is_said_while_a_file_is_written_stays_unsaved(session, tmp_path):
    session.files.save(tmp_path / "a.apd", VIEW)
    session.stroke(np.arange(3), BASE)
    wait(session)
    assert session.saved_work.unsaved
    session.gestures.undo()
    assert not session.saved_work.unsaved


def test_an_exported_mesh_does_not_hold_what_was_said(session, tmp_path):
    session.drag(BENT)
    session.settle()
    session.files.export(tmp_path / "bent.ply")
    wait(session)
    assert session.saved_work.unsaved


def test_what_could_not_be_saved_is_unsaved(session, tmp_path):
    done = []
    session.files.save(tmp_path / "gone" / "a.apd", VIEW, then=lambda: done.append(1))
    wait(session)
    assert (session.saved_work.unsaved, session.saved_work.path, done) == (True, None, [])


def test_an_opened_session_is_saved_where_it_came_from(session, tmp_path):
    save_mesh(bar(), bar().V, tmp_path / "bar.obj")
    save_session(tmp_path / "a.apd", session.store.state, VIEW)
    session.files.open(tmp_path / "a.apd")
    wait(session)
    assert (session.saved_work.unsaved, session.saved_work.path) == (False, tmp_path / "a.apd")


def test_undo_across_an_opened_mesh_leads_back_to_the_file_of_the_first(session, tmp_path):
    session.files.save(tmp_path / "a.apd", VIEW)
    wait(session)
    session.show_now(bar())
    assert (session.saved_work.unsaved, session.saved_work.path) == (False, None)
    session.gestures.undo()
    assert (session.saved_work.unsaved, session.saved_work.path) == (False, tmp_path / "a.apd")
    session.gestures.undo()
    assert session.saved_work.unsaved


def test_a_baked_shape_is_unsaved_work_on_the_same_file(session, tmp_path):
    session.drag(BENT)
    session.settle()
    session.files.save(tmp_path / "a.apd", VIEW)
    wait(session)
    session.rest_shape.bake()
    wait(session)
    assert (session.saved_work.unsaved, session.saved_work.path) == (True, tmp_path / "a.apd")
    session.gestures.undo()
    assert not session.saved_work.unsaved


def test_meshes_out_of_reach_of_undo_are_forgotten(session):
    session.gestures.limit_memory(0)
    others = living(SavedDocument) - 1
    for _ in range(5):
        session.show_now(bar())
    assert living(SavedDocument) - others <= 3


def test_a_drag_called_off_leaves_nothing_unsaved(session, tmp_path):
    session.files.save(tmp_path / "a.apd", VIEW)
    wait(session)
    session.gestures.begin()
    session.handles.drag(pose(0.2))
    assert session.saved_work.unsaved
    session.gestures.cancel()
    assert not session.saved_work.unsaved


def test_a_gesture_under_way_is_unsaved_though_its_beginning_was_saved(session, tmp_path):
    session.gestures.begin()
    session.handles.drag(pose(0.2))
    session.files.save(tmp_path / "a.apd", VIEW)
    wait(session)
    assert session.saved_work.unsaved
    session.gestures.cancel()
    assert not session.saved_work.unsaved
