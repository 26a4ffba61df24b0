"""The worker alone: what it answers to requests that are whole values."""

import pickle
import threading
import time
import weakref
from dataclasses import replace

import numpy as np
import pytest
from driven_session import BENT, LONG, document, pose
from meshes import box

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import HANDLE
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import targets_of
from apd_viewer.session.model.handles_and_regions import Handle, NamedRegion
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.processes import array_pipe, solver_worker as worker_module
from apd_viewer.session.processes.child_process import ChildProcess
from apd_viewer.session.processes.request_and_reply import Reply, Request
from apd_viewer.session.processes.shared_memory import SharedArraysReader
from apd_viewer.session.processes.solver_process import SolverProcess
from apd_viewer.session.processes.solver_worker import SolverWorker


class Remembering(SolverWorker):
    """A worker that looks at every reply and keeps it, also those that are overtaken in the mailbox."""

    def __init__(self) -> None:
        self.replies: list[Reply] = []
        self.awake = threading.Event()
        super().__init__(self.awake.set)

    def answers(self, request: Request) -> list[Reply]:
        """Every reply to ``request``, up to the last."""
        first = len(self.replies)
        self.put_request(request)
        end = time.monotonic() + LONG
        while not (self.replies[first:] and self.replies[-1].finished):
            assert time.monotonic() < end
            time.sleep(0.001)
        return self.replies[first:]


def remembered(request: Request) -> list[Reply]:
    worker = Remembering()
    try:
        return worker.answers(request)
    finally:
        worker.close()


def eventually(happened, seconds: float = LONG) -> None:
    end = time.monotonic() + seconds
    while not happened():
        assert time.monotonic() < end
        time.sleep(0.001)


@pytest.fixture(autouse=True)
def replies_are_kept(monkeypatch):
    """By the worker that publishes them."""

    def child(publish, *others):
        def kept(reply, looked):
            publish.__self__.replies.append(reply)
            looked()
            publish(reply, looked)

        return SolverProcess(kept, *others)

    monkeypatch.setattr(worker_module, "SolverProcess", child)


@pytest.fixture
def worker():
    worker = Remembering()
    yield worker
    worker.close()


def request(method: str = "paper", at: np.ndarray = BENT, generation: int = 1) -> Request:
    asked = document(method, at)
    return Request(asked, generation, asked.mesh.V, iterate=True)


def whole(method: str) -> Document:
    """A document that says something of everything."""
    said = document(method)
    z = said.mesh.V[:, 2]
    said = said.with_label(np.flatnonzero((z == 6.0) & (said.mesh.V[:, 0] == 0.0)), HANDLE + 1)
    said = said.with_handle(1, Handle("Handle 2", pose(0.5))).with_region(0, NamedRegion("Waist", 98.0))
    said = said.with_region_number(np.flatnonzero((z >= 2) & (z <= 4)), 1)
    return said.with_settings(stiffness=0.01, area=101.0, hold_area=True, volume=99.0)


@pytest.mark.parametrize(
    "method",
    ["local", *(pytest.param(method, marks=pytest.mark.night) for method in ("arap", "paper", "exact"))],
)
def test_solver_worker_gets_the_same_frames_bit_for_bit_from_its_process(process, method):
    """As a solver that is asked directly, whatever was published and whatever was not."""
    asked = whole(method)
    held = asked.constraints()
    solver = Deformation(
        asked.mesh.V,
        asked.mesh.F,
        held.fixed,
        method=method,
        handle=held.handles,
        stiffness=asked.settings.stiffness,
        contact=asked.settings.uses_contact,
        **targets_of(asked)._asdict(),
    )
    solver.aim(held.targets, asked.mesh.V)
    frames = {1: solver.step()}
    while not solver.settled:
        frame = solver.step()
        frames[frame.iteration] = frame
    replies = remembered(Request(asked, 1, asked.mesh.V, iterate=True))
    assert replies[-1].frame.iteration == len(frames)
    for reply in replies:
        a, b = reply.frame, frames[reply.frame.iteration]
        assert np.array_equal(a.U, b.U)
        nothing = {"U": None, "loads": None, "shifts": None}
        assert len(a.loads) == len(a.shifts) == 0
        assert replace(a, **nothing).__dict__ == replace(b, **nothing).__dict__


def test_reply_survives_pickling(worker):
    reply = worker.answers(request())[-1]
    again = pickle.loads(pickle.dumps(reply))
    assert np.array_equal(again.frame.U, reply.frame.U)
    assert again.frame.converged
    assert (again.finished, again.seconds) == (True, reply.seconds)
    assert np.array_equal(again.request.document.labels, reply.request.document.labels)
    assert np.array_equal(again.request.document.mesh.F, reply.request.document.mesh.F)


def test_solver_worker_take_gives_the_last_reply(worker):
    replies = worker.answers(request())
    assert worker.awake.wait(LONG)
    end = time.monotonic() + LONG
    while (taken := worker.take_reply()) is not replies[-1]:
        assert time.monotonic() < end
    assert taken.finished
    assert worker.take_reply() is None


def test_solver_worker_counts_iterations_on_and_finishes_only_the_last_reply(worker):
    replies = worker.answers(request("arap"))
    iterations = [reply.frame.iteration for reply in replies]
    assert iterations == sorted(set(iterations))
    assert iterations[0] == 1
    assert [reply.finished for reply in replies] == [False] * (len(replies) - 1) + [True]
    assert all(not reply.frame.U.flags.writeable for reply in replies)


def test_solver_worker_pauses_between_frames_but_not_before_the_first_or_last(worker):
    often = worker.answers(request("arap"))
    rarely = worker.answers(replace(request("arap", generation=2), frame_pause=1e6))
    assert len(often) > len(rarely) == 2
    assert rarely[0].frame.iteration == 1
    assert np.array_equal(rarely[-1].frame.U, often[-1].frame.U)


def test_solver_worker_goes_on_from_where_it_is_in_the_same_generation(worker):
    asked = request("arap")
    last = worker.answers(asked)[-1].frame
    near = asked.document.with_pose(0, pose(0.6001, (0.5, 0.0, 0.2)))
    first = worker.answers(Request(near, 1, asked.U, iterate=True))[0].frame
    assert np.abs(first.U - last.U).max() < 1e-2


def test_solver_worker_starts_another_generation_from_the_shape_of_the_request(worker):
    """The worker that was elsewhere answers as one that never was: nothing is left of its past."""
    asked = request("arap")
    fresh = {reply.frame.iteration: reply.frame for reply in remembered(asked)}
    elsewhere = asked.document.with_pose(0, pose(-1.0))
    worker.answers(Request(elsewhere, 1, fresh[max(fresh)].U, iterate=True))
    again = {reply.frame.iteration: reply.frame for reply in worker.answers(replace(asked, generation=2))}
    assert max(again) == max(fresh)
    assert all(np.array_equal(again[k].U, fresh[k].U) for k in again.keys() & fresh.keys())


def test_solver_worker_gives_no_reply_to_a_request_not_to_iterate_or_one_it_cannot_answer(worker):
    asked = request()
    worker.put_request(replace(asked, iterate=False))
    time.sleep(0.05)
    unpainted = initial_state(asked.document.mesh).document
    worker.put_request(Request(unpainted, 2, asked.U, iterate=True))
    time.sleep(0.05)
    assert worker.replies == []
    assert worker.answers(asked)[-1].frame.converged


def test_solver_worker_answers_a_refused_document_with_its_sentence(worker):
    reply = worker.answers(request("sculpt"))[-1]
    assert "Unknown method 'sculpt'" in reply.failure
    assert reply.frame is None
    assert worker.answers(request())[-1].frame.converged


def test_solver_worker_lets_go_the_solver_of_a_mesh_that_is_gone(worker, monkeypatch):
    solvers = []
    aim = Deformation.aim

    def noted(self, *args):
        solvers.append(weakref.ref(self))
        aim(self, *args)

    monkeypatch.setattr(Deformation, "aim", noted)
    worker.answers(request())
    assert solvers[0]() is not None
    unpainted = initial_state(Mesh(*box(1, 1, 1)))
    worker.put_request(Request(unpainted.document, 2, unpainted.frame.U, iterate=False))
    eventually(lambda: solvers[0]() is None)


def test_solver_worker_answers_a_refused_target_with_its_sentence_and_meets_the_next(worker):
    asked = request("exact")
    worker.answers(asked)
    wrong = asked.document.with_settings(area=-5.0)
    reply = worker.answers(Request(wrong, 1, asked.U, iterate=True))[-1]
    assert "percentage" in reply.failure
    right = asked.document.with_settings(area=105.0)
    frame = worker.answers(Request(right, 1, asked.U, iterate=True))[-1].frame
    assert abs(frame.area_error - 0.05) < 1e-9


@pytest.mark.parametrize("method", ["exact", "local"])
def test_solver_worker_ends_with_targets_that_come_later_where_it_would_with_earlier_ones(worker, method):
    """Told to a solver that is at work, or to a new one: the same shape."""
    asked = whole(method)
    plain = asked.with_settings(area=100.0, volume=None)
    worker.answers(Request(plain, 1, asked.mesh.V, iterate=True))
    later = worker.answers(Request(asked, 1, asked.mesh.V, iterate=True))[-1].frame
    first = remembered(Request(asked, 1, asked.mesh.V, iterate=True))[-1].frame
    assert later.converged
    assert first.converged
    assert np.allclose(later.regions, first.regions, rtol=1e-9)
    assert np.abs(later.U - first.U).max() < 2e-2


def test_solver_process_keeps_what_was_sent_until_its_process_has_ended(monkeypatch):
    """It may be ended while it reads: what lies in shared memory stays until then."""
    reading, read = threading.Event(), []

    def read_late(name):
        reading.set()
        eventually(lambda: process.is_dismissed)
        time.sleep(0.1)
        read.append(SharedArraysReader(name))
        return read[0]

    monkeypatch.setattr(array_pipe, "SharedArraysReader", read_late)
    monkeypatch.setattr(array_pipe, "LEAST_SHARED_BYTES", 1)
    process = SolverProcess(*[lambda *_: None] * 5)
    send_messages = ChildProcess.send_messages

    def send_and_end(child, *messages):
        sent = send_messages(child, *messages)
        reading.wait(LONG)
        process.dismiss()
        eventually(lambda: not process.is_alive)
        return sent

    monkeypatch.setattr(ChildProcess, "send_messages", send_and_end)
    assert not process.send_request(request(), ())
    process.join()
    assert len(read) == 1
