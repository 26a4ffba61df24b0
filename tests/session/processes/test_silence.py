"""A solver that does not answer is said, with what to do; one that computes for long is left alone."""

import os
import signal
import sys
import time

import forked
import numpy as np
import pytest
from driven_session import pose
from new_threads import new_threads

from apd_viewer.session.processes import solver_process
from apd_viewer.session.processes.solver_process import SilenceWatch
from apd_viewer.session.state_store import Activity

SOON = 12.0  # s; it is told after 5
TWISTED = 0.4
TICK = 0.3  # s, that count as one of silence

stoppable = pytest.mark.skipif(not hasattr(signal, "SIGSTOP"), reason="processes cannot be stopped here")


def stop(session, processes):
    """Stop the solver in the middle of a drag."""
    session.gestures.begin()
    session.handles.drag(pose(0.1))
    before = session.U
    session.until(lambda: session.U is not before)
    os.kill(processes[-1].pid, signal.SIGSTOP)
    session.handles.drag(pose(TWISTED))
    session.gestures.end("Move handle")


@stoppable
def test_store_says_that_a_solver_is_stopped_until_it_goes_on(processes, session, monkeypatch):
    session.settle()
    stop(session, processes)
    monkeypatch.setattr(solver_process, "TICK", TICK)
    began = time.monotonic()
    session.until(lambda: session.store.silence_text, SOON)
    assert time.monotonic() - began > 3 * TICK
    assert "restart" in session.store.silence_text
    assert session.told == [session.store.silence_text]
    os.kill(processes[-1].pid, signal.SIGCONT)
    session.until(lambda: not session.store.silence_text, SOON)
    session.settle()
    assert len(processes) == 1
    assert session.failed == []


@pytest.mark.night  # by day the window restarts one
@stoppable
def test_store_has_a_stopped_solver_restarted(processes, session):
    session.settle()
    session.gestures.begin()
    session.handles.drag(pose(TWISTED))
    session.gestures.end("Move handle")
    session.settle()
    reached = session.U
    session.gestures.undo()
    session.settle()
    stop(session, processes)
    session.until(lambda: session.store.silence_text, SOON)
    session.store.restart_solver()
    session.until(lambda: not session.store.silence_text, SOON)
    session.settle()
    assert len(processes) == 2
    assert session.store.activity is Activity.SETTLED
    assert np.abs(session.U - reached).max() < 1e-3
    assert session.failed == []


HANGS = """
import threading, time
from apd_viewer.geometry.solver.deformation import Deformation
real, calls = Deformation.iterate, []
def iterate(self):
    real(self)
    calls.append(None)
    until = time.monotonic() + 6.5
    while len(calls) == 1 and time.monotonic() < until:
        pass
    if len(calls) == 2:
        threading.Event().wait()
Deformation.iterate = iterate
"""


@pytest.fixture
def hanging(processes, monkeypatch):
    """The solver computes for long in its first iteration, and waits for ever in its second."""
    monkeypatch.setattr(solver_process, "ChildProcess", forked.altered(HANGS))


@pytest.mark.night  # 7 s of computing; by day the watch itself is tried, which waits for a second
def test_silence_watch_takes_no_long_iteration_for_one_that_hangs(hanging, session):
    session.gestures.begin()
    session.handles.drag(pose(TWISTED))
    before = session.U
    session.until(lambda: session.U is not before)
    assert session.told == [], "it computed for longer than it may be silent"
    session.until(lambda: session.store.silence_text, SOON)
    session.gestures.cancel()


@pytest.fixture
def heard():
    """What a watch tells that waits for a second, and the watch, whose thread is the newest."""
    told = []
    watch = SilenceWatch(told.append, 1)
    yield told, watch
    watch.close()


@pytest.fixture
def short_seconds(monkeypatch):
    """Of silence; one test has them as they are."""
    monkeypatch.setattr(solver_process, "TICK", TICK)


def wait(happened, seconds=5.0):
    end = time.monotonic() + seconds
    while not happened() and time.monotonic() < end:
        time.sleep(0.01)
    assert happened()


def test_silence_watch_tells_silence_once_and_so_its_end(heard):
    told, watch = heard
    watch.expect_answer(1, 1)
    wait(lambda: told)
    watch.note_message()
    watch.note_message()
    began = time.monotonic()
    assert (told[0] > 0, told[1:]) == (True, [0])
    wait(lambda: len(told) == 3)
    assert told[2] <= time.monotonic() - began + 0.5, "seconds that nothing was heard for"
    watch.close()
    assert told[3:] == [0]


@pytest.mark.usefixtures("short_seconds")
def test_silence_watch_misses_nothing_where_nothing_is_awaited(heard):
    told, watch = heard
    watch.expect_answer(1, 1)
    watch.expect_answer(2, 1)
    watch.note_message(answer=2)
    watch.note_message(answer=1)  # of an order that was overtaken
    time.sleep(2.5 * TICK)
    assert told == []


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads the clock of another thread")
@pytest.mark.usefixtures("short_seconds")
def test_silence_watch_rests_while_nothing_is_awaited(heard):
    _, watch = heard
    watch.expect_answer(1, 1)
    watch.note_message(answer=1)
    (thread,) = new_threads("silence")
    clock = time.pthread_getcpuclockid(thread.ident)

    def rests(seconds):
        before = time.clock_gettime(clock)
        time.sleep(seconds)
        return time.clock_gettime(clock) == before

    wait(lambda: rests(0.05))
    assert rests(1.5 * TICK)
