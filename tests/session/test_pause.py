"""A paused solver stops where it is, and goes on from there."""

import pytest
from driven_session import BENT, pose

from apd_viewer.session.state_store import Activity

pytestmark = pytest.mark.usefixtures("slow")


@pytest.fixture
def paused(session):
    """A session paused on the way to a bent bar."""
    session.settings.change(method="arap")
    session.settle()
    session.drag(BENT)
    session.until(lambda: session.store.state.frame.iteration > 2)
    session.store.pause_or_resume()
    session.listen(0.1)  # a frame may be on its way
    return session


def test_pause_or_resume_lets_a_paused_shape_stand_still(paused):
    assert paused.store.activity is Activity.PAUSED
    before = paused.store.state
    paused.listen(0.2)
    assert paused.store.state is before
    assert not before.frame.settled


def test_pause_or_resume_goes_on_where_it_was_and_converges(paused):
    iteration = paused.store.state.frame.iteration
    paused.store.pause_or_resume()
    assert paused.store.activity is Activity.REFINING
    paused.settle()
    assert paused.store.activity is Activity.SETTLED
    assert paused.store.state.frame.iteration > iteration


def test_pause_or_resume_lets_the_next_change_go_on_by_itself(paused):
    paused.drag(pose(0.2))
    assert paused.store.activity is Activity.REFINING
    paused.settle()
    assert paused.store.activity is Activity.SETTLED


def test_pause_or_resume_is_not_woken_by_a_name(paused):
    paused.parts.rename_handle(0, "neck")
    assert paused.store.activity is Activity.PAUSED
    paused.store.pause_or_resume()
    paused.settle()
    assert paused.store.state.document.handles[0].name == "neck"


def test_undo_leaves_a_paused_shape(paused):
    paused.gestures.undo()
    assert paused.store.activity is Activity.IDLE
    paused.gestures.redo()
    paused.settle()
    assert paused.store.state.frame.settled


def test_pause_or_resume_pauses_nothing_where_nothing_is_solved(session):
    session.settle()
    before = session.store.activity
    session.store.pause_or_resume()
    assert session.store.activity is before
