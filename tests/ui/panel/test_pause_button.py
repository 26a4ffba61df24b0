"""The solver is stopped and let go on by the status bar, and by Space in the view."""

import pytest
from driving import LEFT, idle, rest
from PySide6.QtCore import Qt

from apd_viewer.geometry.solver.convergence import Convergence
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.state_store import Activity


@pytest.fixture
def solving(qtbot, sample):
    """The sample itself on its way to a twisted shape, for longer than a test takes."""
    sample.session.settings.change(convergence=Convergence(energy_tolerance=1e-15))
    sample.session.handles.move_by(MOTIONS["TWIST"], "45", 0)
    return sample


def test_pause_button_stops_the_solver_and_lets_it_go_on(qtbot, solving):
    pause, store = solving.status.pause, solving.session.store
    assert (pause.isVisible(), pause.text()) == (True, "Pause")
    qtbot.mouseClick(pause, LEFT)
    assert store.activity is Activity.PAUSED
    assert pause.text() == "Continue"
    assert solving.panel.area.activity.text() == "paused"
    # A frame may be on its way. Many would come in this time, and it would not rest.
    rest(qtbot, lambda: store.state)
    state = store.state
    qtbot.mouseClick(pause, LEFT)
    assert store.activity is Activity.REFINING
    qtbot.waitUntil(lambda: store.state is not state, timeout=60_000)
    solving.actions_.undo.trigger()
    idle(qtbot, solving)
    assert not pause.isVisible()


def test_pause_or_resume_is_done_by_space_in_the_view(qtbot, solving):
    solving.shell.activateWindow()
    qtbot.waitUntil(solving.shell.isActiveWindow)
    view = solving.canvas.viewport
    view.setFocus()
    qtbot.keyClick(view, Qt.Key.Key_Space)
    assert solving.session.store.activity is Activity.PAUSED
    qtbot.keyClick(view, Qt.Key.Key_Space)
    assert solving.session.store.activity is Activity.REFINING


def test_pause_or_resume_leaves_space_on_a_button_to_that_button(qtbot, solving):
    keep = solving.panel.poses.add
    keep.setFocus()
    before = len(solving.session.store.state.document.poses)
    qtbot.keyClick(keep, Qt.Key.Key_Space)
    assert len(solving.session.store.state.document.poses) == before + 1
    assert solving.session.store.activity is not Activity.PAUSED
