"""A solver that does not answer is said in the window, with a button that restarts it."""

import os
import signal
from pathlib import Path

import pytest
from driving import LEFT, idle, work_off
from process_tree import text_of, tree_of

from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.processes import solver_process

MAIN = "solver_main import main"  # in what a process of the solver runs
SOON = 15_000  # ms; it is said after 5 s, short ones here

pytestmark = [
    pytest.mark.usefixtures("process"),
    pytest.mark.skipif(not Path("/proc").is_dir(), reason="only Linux lists processes so"),
]


def solvers():
    """Numbers of the processes that solve; the nursery of other tests, which imports the same, is none."""
    found = tree_of(os.getpid())[1:]
    return [number for number in found if MAIN in text_of(Path(f"/proc/{number}/cmdline"))]


@pytest.fixture
def bottle(new_bottle):
    """A window of each test's own: its solver is kept from answering."""
    return new_bottle


@pytest.mark.night
def test_notice_says_a_stopped_solver_until_it_is_restarted(qtbot, bottle, monkeypatch):
    store, notice, button = bottle.session.store, bottle.notice, bottle.status.pause
    bottle.session.handles.move_by(MOTIONS["TWIST"], "5", 0)
    idle(qtbot, bottle)
    (stopped,) = solvers()
    os.kill(stopped, signal.SIGSTOP)
    monkeypatch.setattr(solver_process, "TICK", 0.2)
    bottle.session.handles.move_by(MOTIONS["TWIST"], "20", 0)
    before = store.state.frame.U
    qtbot.waitUntil(lambda: bool(notice.text), timeout=SOON)
    assert "has not answered" in notice.text
    assert button.isVisible()
    work_off()
    assert "Restart" in button.text()
    qtbot.mouseClick(button, LEFT)
    qtbot.waitUntil(lambda: not notice.text, timeout=SOON)
    idle(qtbot, bottle)
    assert store.state.frame.U is not before
    assert not notice.text
    assert not button.isVisible()
    assert stopped not in solvers()
    assert len(solvers()) == 1
