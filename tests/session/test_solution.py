"""The store knows which document a displayed shape solves, and whether it came there straight from rest."""

import math

import pytest
from driven_session import BENT, pose

from apd_viewer.geometry.pose.constraints import FREE
from apd_viewer.session.model.view import View
from apd_viewer.session.state_store import Activity


@pytest.fixture
def bent(session):
    """A session with a bar bent in one go from rest."""
    session.handles.set_pose(BENT, 0, "bend")
    session.settle()
    return session


def test_solution_is_that_of_the_document_asked_straight_from_rest(bent):
    found = bent.store.solution
    assert found.document is bent.store.state.document
    assert found.is_from_rest
    assert math.isfinite(found.cost.energy)
    assert found.cost.seconds > 0.0


def test_solution_is_missing_at_rest_and_on_the_way(session):
    assert session.store.solution is None
    session.handles.set_pose(BENT, 0, "bend")
    assert session.store.solution is None


@pytest.mark.parametrize(
    "change",
    [
        lambda session: session.handles.set_pose(pose(0.7), 0, "bend"),
        lambda session: session.settings.change(stiffness=0.01),
        lambda session: session.settings.change(area=99.0),
    ],
)
def test_solution_of_a_changed_document_came_by_way_of_another_shape(bent, change):
    change(bent)
    assert bent.store.solution is None
    bent.settle()
    found = bent.store.solution
    assert found.document is bent.store.state.document
    assert not found.is_from_rest


def test_solution_of_a_drag_came_by_way_of_other_shapes(session):
    session.drag(pose(0.2), pose(0.4), BENT)
    session.settle()
    assert not session.store.solution.is_from_rest


def test_solution_after_a_pause_came_by_way_of_another_shape(session, slow):
    session.settings.change(method="arap")
    session.handles.set_pose(BENT, 0, "bend")
    session.until(lambda: session.store.state.frame.iteration > 2)
    session.store.pause_or_resume()
    session.store.pause_or_resume()
    session.settle()
    assert not session.store.solution.is_from_rest


def test_solution_comes_back_with_its_shape_by_undo(bent):
    first = bent.store.solution
    bent.handles.set_pose(pose(0.7), 0, "bend")
    bent.settle()
    bent.gestures.undo()
    bent.settle()
    assert bent.store.solution is first
    bent.shapes.restore()
    bent.settle()
    bent.handles.set_pose(BENT, 0, "bend")
    bent.settle()
    assert bent.store.solution.is_from_rest


def test_shown_activity_comes_back_with_its_shape_by_undo_and_redo(bent):
    store = bent.store
    assert store.shown_activity is Activity.SETTLED
    bent.gestures.undo()
    assert store.shown_activity is Activity.IDLE, "as it was opened"
    bent.gestures.redo()
    assert store.shown_activity is Activity.SETTLED
    assert store.activity is Activity.IDLE, "nothing is asked of the solver"
    bent.handles.set_pose(pose(0.7), 0, "bend")
    bent.settle()
    bent.gestures.undo()
    assert store.shown_activity is Activity.SETTLED


def test_shown_activity_of_an_opened_shape_is_idle(bent, tmp_path):
    bent.files.save(tmp_path / "a.apd", View(), True)
    bent.settle()
    bent.files.open(tmp_path / "a.apd")
    bent.settle()
    assert bent.store.state.frame.converged
    assert bent.store.shown_activity is Activity.IDLE


def test_solution_stays_where_a_change_of_the_document_moves_nothing(bent):
    found = bent.store.solution
    bent.parts.rename_handle(0, "neck")
    assert bent.store.state.document is not found.document
    assert bent.store.solution is found


def test_solution_is_lost_where_vertices_are_let_go(bent):
    held = bent.store.state.document.labels != FREE
    bent.stroke(held.nonzero()[0][:4], FREE)
    bent.settle()
    assert bent.store.solution is None
