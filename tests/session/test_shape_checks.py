"""Shapes at rest are checked, in a process that nobody waits for; what moves is forgotten."""

import os
import signal
import sys
import threading
import time

import forked
import meshes
import numpy as np
import pytest

from apd_viewer.geometry.analysis.hull_readings import hull_readings
from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.processes import shape_checker
from apd_viewer.session.processes.shape_checker import ShapeChecker, ShapeQuery
from apd_viewer.session.session import Session
from apd_viewer.session.state_store import Listener

LONG = 30.0
SIGKILL = getattr(signal, "SIGKILL", signal.SIGTERM)


@pytest.fixture(autouse=True)
def at_once(monkeypatch):
    monkeypatch.setattr(shape_checker, "FIRST_PAUSE", 0.0)
    monkeypatch.setattr(shape_checker, "NEXT_PAUSE", 0.0)


@pytest.fixture(autouse=True)
def processes(monkeypatch):
    """The processes of the checkers, which have nothing to import."""
    started = []

    class Noted(forked.Quick):
        def __init__(self, title, script):
            super().__init__(title, script)
            self.sent = 0
            started.append(self)

        def send_messages(self, *messages):
            self.sent += 1
            return super().send_messages(*messages)

    forked.prepare()
    monkeypatch.setattr(shape_checker, "ChildProcess", Noted)
    return started


@pytest.fixture
def woken():
    return threading.Event()


@pytest.fixture
def checker_(woken):
    checker_ = ShapeChecker(woken.set)
    yield checker_
    checker_.close()


def taken(checker_, woken):
    assert woken.wait(LONG)
    woken.clear()
    return checker_.take()


def two_spheres(apart):
    V, F = meshes.sphere(2)
    return ShapeQuery(np.vstack([V, V + [apart, 0.1, 0.2]]), np.vstack([F, F + len(V)]))


def test_shape_checker_says_what_is_found_here_too(checker_, woken):
    for apart in (1.0, 3.0):
        shape = two_spheres(apart)
        checker_.ask(shape)
        asked, found = taken(checker_, woken)
        assert asked is shape
        assert np.array_equal(found.crossing, crossings(shape.U, shape.F))
        assert (len(found.crossing) > 0) == (apart < 2)
        assert found.packed_box == hull_readings(shape.U).box
        assert checker_.take() is None


def test_shape_checker_lets_the_newest_shape_win_and_does_not_tell_what_is_forgotten(checker_, woken):
    checker_.ask(two_spheres(1.0))
    checker_.cancel()
    for apart in (1.1, 1.2):
        checker_.ask(two_spheres(apart))
    last = two_spheres(1.3)
    checker_.ask(last)
    assert taken(checker_, woken)[0] is last


def test_shape_checker_ends_its_process_when_the_shape_has_moved_on(checker_, woken, processes):
    checker_.ask(two_spheres(1.0))
    taken(checker_, woken)
    (process,) = processes
    pid = process.pid
    V, F = meshes.sphere(6)
    checker_.ask(ShapeQuery(V + 0.3 * np.random.default_rng(0).normal(size=V.shape), F))  # takes for ever
    end = time.monotonic() + LONG
    while process.sent < 2:
        assert time.monotonic() < end
        time.sleep(0.001)
    checker_.cancel()
    while process.pid == pid:
        assert time.monotonic() < end
        time.sleep(0.001)
    shape = two_spheres(1.0)
    checker_.ask(shape)
    assert taken(checker_, woken)[0] is shape


def test_shape_checker_answers_a_question_that_came_just_after_an_answer(
    checker_, woken, processes, monkeypatch
):
    """Its process is killed for the newer one when it has nothing left to do for the older one."""
    checker_.ask(two_spheres(1.0))
    taken(checker_, woken)
    (process,), received = processes, []

    def receive():
        received.append(type(process).receive_message(process))
        if len(received) == 3:  # all of an answer
            checker_.ask(newer)
        return received[-1]

    monkeypatch.setattr(process, "receive_message", receive)
    newer = two_spheres(1.1)
    checker_.ask(two_spheres(1.2))
    asked, found = taken(checker_, woken)
    assert asked is newer
    assert len(found.crossing)


@pytest.mark.skipif(sys.platform == "win32", reason="there are no such signals")
def test_shape_checker_knows_nothing_of_a_shape_whose_process_dies(checker_, woken, processes):
    checker_.ask(two_spheres(1.0))
    taken(checker_, woken)
    os.kill(processes[0].pid, SIGKILL)
    checker_.ask(two_spheres(1.0))
    _, found = taken(checker_, woken)
    assert found.crossing is None
    assert np.isnan(found.packed_box)
    checker_.ask(two_spheres(1.0))
    assert len(taken(checker_, woken)[1].crossing)


def test_shape_checker_knows_nothing_where_there_can_be_no_process(checker_, woken, monkeypatch):
    def refused(*_):
        raise OSError("no more processes")

    monkeypatch.setattr(forked.Quick, "start", refused)
    checker_.ask(two_spheres(1.0))
    assert taken(checker_, woken)[1].crossing is None


def test_shape_checker_can_be_closed_at_any_time(woken, processes):
    others = set(threading.enumerate())
    for pause in (0.0, 0.05, 0.6):
        checker_ = ShapeChecker(woken.set)
        checker_.ask(two_spheres(1.0))
        time.sleep(pause)
        checker_.close()
        assert processes[-1].pid is None
        assert set(threading.enumerate()) <= others


@pytest.fixture
def session():
    told = []
    nothing = dict.fromkeys(("wake", "status_changed"), lambda: None)
    session = Session(
        Listener(
            **nothing,
            changed=lambda *_: None,
            message_sent=print,
            failed=pytest.fail,
            measurements_changed=lambda: told.append(
                (session.shape_checks.is_checking, session.shape_checks.shape_check)
            ),
        )
    )
    session.said = told
    yield session
    session.close()


def passing(state):
    """The state with contact off, so that walls pass through each other."""
    return state.updated(state.document.with_settings(contact=False))


def known(session):
    end = time.monotonic() + LONG
    assert session.wait_idle(LONG)
    while session.shape_checks.shape_check is None:
        assert time.monotonic() < end
        session.receive_results()
        time.sleep(0.002)
    return session.shape_checks.shape_check


def test_shape_checks_look_at_every_shape_that_has_settled_and_none_that_moves(session):
    V, F = meshes.tube(16, 24, height=4.0)
    V, F = meshes.soup(V, F)
    labels = np.full(len(V), FREE, dtype=np.uint8)
    labels[V[:, 2] < 0.5] = BASE
    labels[V[:, 2] > 3.5] = HANDLE
    mesh = Mesh(V, F)
    session.files.open_result("tube", lambda: passing(initial_state(mesh, labels)))
    first = known(session)
    assert first is session.shape_checks.rest_check
    assert len(first.crossing) == 0
    assert session.said[0] == (True, None)
    session.gestures.begin()
    assert session.shape_checks.shape_check is first, "nothing has moved"
    pose = np.eye(4)
    pose[:3, 3] = 0.7, 0.0, -6.0  # through the base
    session.handles.drag(pose)
    session.wait_idle(LONG)
    assert session.shape_checks.shape_check is None
    assert not session.shape_checks.is_checking, "the gesture is not over"
    session.gestures.end("Move handle")
    assert session.shape_checks.is_checking
    crossed = known(session)
    U = session.store.state.frame.U
    assert np.array_equal(crossed.crossing, crossings(U, mesh.joined_F))
    assert len(crossed.crossing) > 10
    assert crossed.packed_box == pytest.approx(hull_readings(U).box, rel=1e-9)
    assert session.shape_checks.rest_check is first
    session.gestures.undo()
    assert session.shape_checks.shape_check is first, "it is known already"
    assert not session.shape_checks.is_checking


def test_shape_checks_go_on_during_a_stroke_that_moves_nothing(session, monkeypatch):
    asked = []
    ask = ShapeChecker.ask
    monkeypatch.setattr(
        ShapeChecker, "ask", lambda checker, query: asked.append(query) or ask(checker, query)
    )
    monkeypatch.setattr(shape_checker, "FIRST_PAUSE", 0.5)
    mesh = Mesh(*meshes.tube(16, 24, height=4.0))
    session.files.open_result("tube", lambda: initial_state(mesh))
    assert session.wait_idle(LONG)
    for label, end in ((BASE, mesh.V[:, 2] < 0.5), (HANDLE, mesh.V[:, 2] > 3.5)):
        assert session.shape_checks.is_checking
        session.gestures.begin()
        session.painting.paint(np.flatnonzero(end), label)
        assert session.shape_checks.is_checking, "nothing has moved"
        session.painting.end_stroke("Paint")
    assert len(known(session).crossing) == 0
    assert len(asked) == 1, "one process has checked it"
