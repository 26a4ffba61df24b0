"""Sessions that are closed when their test ends."""

import threading
import time

import forked
import pytest
from driven_session import Driven, bar

from apd_viewer.geometry.energy import elastic_surface
from apd_viewer.geometry.linalg import linear_solver
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.session.processes import solver_process


class Counter:
    def __init__(self) -> None:
        self.count = 0


@pytest.fixture
def empty():
    """A session in which nothing is open, closed afterwards, and its thread with it."""
    others = set(threading.enumerate())
    session = Driven()
    yield session
    session.close()
    assert set(threading.enumerate()) <= others


@pytest.fixture
def session(empty):
    """A session with a bar, its lower end base and its upper end handle."""
    empty.show_now(bar())
    empty.paint_ends()
    return empty


@pytest.fixture
def processes(process, monkeypatch):
    """The solver is a process, which has nothing to import; all that were started, the newest last."""
    start, started = solver_process.start_solver_process, []

    def noted():
        started.append(start())
        return started[-1]

    forked.prepare()
    monkeypatch.setattr(solver_process, "ChildProcess", forked.Quick)
    monkeypatch.setattr(solver_process, "start_solver_process", noted)
    return started


@pytest.fixture
def slow(monkeypatch):
    """Every iteration takes 10 ms longer, so that whatever is done meets one under way."""
    real = Deformation.iterate

    def iterate(self):
        time.sleep(0.01)
        real(self)

    monkeypatch.setattr(Deformation, "iterate", iterate)


@pytest.fixture
def factored(monkeypatch):
    """Counts factorizations."""
    counter = Counter()

    class Counting(linear_solver.LinearSolver):
        def __init__(self, A, V) -> None:
            counter.count += 1
            super().__init__(A, V)

    monkeypatch.setattr(elastic_surface, "LinearSolver", Counting)
    return counter
