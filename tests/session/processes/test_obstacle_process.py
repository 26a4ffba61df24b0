"""Obstacles in the solver's process: moved, undone, painted beside, and gone on with after it was killed."""

import os
import signal

import numpy as np
import pytest
from meshes import ends, tube

from apd_viewer.geometry.contact.obstacle_pairs import clearance
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE
from apd_viewer.session.state_store import Activity

pytestmark = pytest.mark.usefixtures("processes")
SIGKILL = getattr(signal, "SIGKILL", signal.SIGTERM)
X = np.eye(3)[0]


@pytest.fixture
def plates(empty):
    """A tube that nothing holds, with a plate on each side."""
    empty.show_now(Mesh(*tube(12, 12)))
    empty.settings.change(stiffness=0.001)
    empty.obstacles.add_plates(X)
    empty.settle()
    return empty


def push(session, way):
    """Move the second plate towards the first, and wait until the shape has settled."""
    session.obstacles.move(1, -way * X)
    session.settle()
    return session.store.state.frame


def check_clear(session):
    state = session.store.state
    solids = state.document.active_obstacles
    assert len(solids) == len(state.frame.shifts) == 2
    for solid, shift in zip(solids, state.frame.shifts, strict=True):
        assert clearance(solid, shift, state.frame.U, state.document.mesh.F) > 0.0


def test_obstacles_move_presses_what_nothing_holds_and_undo_takes_it_back(plates):
    frame = push(plates, 0.3)
    assert plates.store.activity is Activity.SETTLED
    assert np.allclose(frame.shifts, [0.0 * X, -0.3 * X])
    assert frame.loads[1, 0] > 0.5
    check_clear(plates)
    farther = push(plates, 0.2)
    assert farther.loads[1, 0] > frame.loads[1, 0]
    plates.gestures.undo()
    plates.settle()
    again = plates.store.state.frame
    assert np.allclose(again.shifts, frame.shifts)
    assert again.energy == pytest.approx(frame.energy, rel=1e-3)
    plates.gestures.redo()
    plates.settle()
    check_clear(plates)
    assert plates.store.state.frame.loads[1, 0] == pytest.approx(farther.loads[1, 0], rel=0.02)
    assert plates.failed == []


def test_solver_worker_goes_on_with_plates_where_they_were_after_its_process_is_killed(plates, processes):
    before = push(plates, 0.3)
    os.kill(processes[-1].pid, SIGKILL)
    plates.until(lambda: len(plates.told) == 1)
    after = push(plates, 0.02)
    check_clear(plates)
    assert after.share_reached == 1.0
    assert np.abs(after.U - before.U).max() < 0.1, "it did not begin anew"
    assert after.loads[1, 0] > before.loads[1, 0]


def test_obstacles_leave_a_base_painted_between_pressed_plates_where_it_is(plates):
    before = push(plates, 0.3)
    low, _ = ends(plates.store.state.document.mesh.V)
    plates.stroke(low, BASE)
    plates.settle()
    after = push(plates, 0.02)
    check_clear(plates)
    assert np.abs(after.U[low] - before.U[low]).max() <= 1e-12
    assert plates.failed == []


def test_set_contact_leaves_paint_missing_when_off_and_nothing_when_on_again(plates):
    push(plates, 0.2)
    plates.settings.set_contact(False)
    assert "base" in plates.store.state.document.paint_problem
    plates.settings.set_contact(True)
    plates.settle()
    assert plates.store.state.document.paint_problem is None
    check_clear(plates)
    assert plates.failed == []
