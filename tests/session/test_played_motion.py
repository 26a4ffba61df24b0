"""Typed motions of handles in steps: each at rest on the timeline, the last one as if it was made at once."""

import numpy as np
import pytest
from driven_session import BENT, pose

from apd_viewer.errors import InputError
from apd_viewer.session.posing.motion import MOTIONS

pytestmark = pytest.mark.usefixtures("processes")


def play(session, name, text, count):
    """Play a typed motion of the handle; the states of the timeline."""
    step = session.handles.plan_motion(MOTIONS[name], text, 0)
    session.handles.play_motion(step, count, session.player)
    session.until(lambda: not session.player.is_playing)
    return [step.state for step in session.player.timeline.steps]


def test_played_motion_has_a_shape_at_rest_for_each_equal_step(session):
    before = session.store.state
    states = play(session, "TURN_Y", "60deg", 4)
    assert states[0] is before
    angles = [np.degrees(np.linalg.norm(state.document.handles[0].rotation)) for state in states]
    assert angles == pytest.approx([0.0, 15.0, 30.0, 45.0, 60.0])
    assert all(state.frame.settled for state in states)
    assert session.gestures.history.undo_names[-1] == "Rotate about y +60° (Handle 1)"
    session.gestures.undo()
    assert session.store.state is before
    session.handles.move_by(MOTIONS["TURN_Y"], "60deg", 0)
    session.settle()
    at_once = session.store.state
    assert np.array_equal(at_once.document.handles[0].pose, states[-1].document.handles[0].pose)
    np.testing.assert_allclose(session.U, states[-1].frame.U, atol=1e-4)


def test_played_motion_scales_by_equal_factors_and_keeps_whole_turns(session):
    factors = [
        np.cbrt(np.linalg.det(state.document.handles[0].pose[:3, :3]))
        for state in play(session, "SCALE", "1.44", 2)
    ]
    assert factors == pytest.approx([1.0, 1.2, 1.44])
    session.gestures.undo()
    session.player.clear()
    states = play(session, "TWIST", "270deg", 3)
    turned = [np.degrees(np.linalg.norm(state.document.handles[0].rotation)) for state in states]
    assert turned == pytest.approx([0.0, 90.0, 180.0, 270.0])


def test_played_motion_goes_on_by_hand_on_the_timeline(session):
    states = play(session, "MOVE_X", "0.2", 2)
    session.drag(BENT)
    session.until(lambda: len(session.player.timeline.steps) == len(states) + 1)
    assert session.player.timeline.steps[-1].state is session.store.state
    session.player.show_step(1)
    session.player.accept_shown_step()
    session.drag(pose(0.1))
    session.until(lambda: len(session.player.timeline.steps) == len(states) + 3)
    begins = [step.begins_run for step in session.player.timeline.steps]
    assert begins == [True, False, False, False, True, False]


def test_played_motion_needs_paint_and_a_possible_motion(session):
    step = session.handles.plan_motion(MOTIONS["TWIST"], f"{101 * 360}deg", 0)
    with pytest.raises(InputError, match="at most 100 turns"):
        session.handles.play_motion(step, 2, session.player)
    session.painting.clear_all()
    session.handles.play_motion(step, 2, session.player)
    assert session.failed[-1] == session.store.state.document.paint_problem
    assert not session.player.is_playing
