"""A factor in a process of its own: right, replaced when it dies, and ended when nobody needs it."""

import os
import signal
import sys
import time

import forked
import numpy as np
import pytest
from scipy.sparse import csr_array, diags_array

from apd_viewer.geometry.linalg.linear_solver import LinearSolver
from apd_viewer.session.processes import remote_factor
from apd_viewer.session.processes.child_process import ChildProcess
from apd_viewer.session.processes.remote_factor import RemoteFactor

N = 500
A = csr_array(diags_array([-np.ones(N - 1), np.full(N, 2.5), -np.ones(N - 1)], offsets=[-1, 0, 1]))
B = np.random.default_rng(0).normal(size=(N, 3))
V = np.column_stack([np.arange(N), np.zeros((N, 2))])
SIGKILL = getattr(signal, "SIGKILL", signal.SIGTERM)


def far(matrix=A):
    return RemoteFactor(lambda: matrix, V)


@pytest.fixture(autouse=True)
def processes(monkeypatch):
    """The processes of the factors, which have nothing to import."""
    started = []

    def noted(*how):
        started.append(forked.Quick(*how))
        return started[-1]

    forked.prepare()
    monkeypatch.setattr(remote_factor, "ChildProcess", noted)
    return started


@pytest.fixture
def factor():
    factor = far()
    yield factor
    factor.close()


def wait_for(factor, seconds=20.0):
    end = time.monotonic() + seconds
    while not factor.ready:
        assert time.monotonic() < end
        time.sleep(0.005)


def kill(processes):
    """Kill the process of the only factor, which answers no more from then on."""
    os.kill(processes[-1].pid, SIGKILL)


def test_remote_factor_solves_as_one_that_is_near_does(factor):
    expected = LinearSolver(A).solve(B)
    for k in range(3):
        assert np.array_equal(factor.solve(k * B), LinearSolver(A).solve(k * B))
    assert np.abs(A @ expected - B).max() < 1e-12
    assert np.array_equal(factor.solve_refined(B), LinearSolver(A).solve_refined(B))
    solution = factor.solve(B)
    solution += 1.0  # it is the caller's own


def test_remote_factor_says_when_it_is_there(factor):
    assert factor.seconds == 0.0
    wait_for(factor)
    took = factor.seconds
    assert took > 0.0
    time.sleep(0.01)
    assert factor.seconds == took
    assert factor.is_in_other_process
    assert not LinearSolver(A).is_in_other_process
    assert LinearSolver(A).ready


def test_remote_factor_says_that_a_matrix_cannot_be_factored():
    factor = far(csr_array(-A))
    try:
        wait_for(factor)
        with pytest.raises(ValueError, match=r"\w"):
            factor.solve(B)
    finally:
        factor.close()


def test_remote_factor_that_dies_is_replaced(factor, processes):
    expected = factor.solve(B)
    for _ in range(5):
        kill(processes)
        assert np.array_equal(factor.solve(B), expected)


def test_remote_factor_that_dies_while_it_factors_is_replaced(factor, processes):
    factor.begin()
    kill(processes)
    wait_for(factor)
    assert np.array_equal(factor.solve(B), LinearSolver(A).solve(B))


def test_remote_factor_that_always_dies_is_given_up(monkeypatch):
    monkeypatch.setattr(
        remote_factor, "ChildProcess", lambda title, _: ChildProcess(title, "raise SystemExit(3)")
    )
    factor = far()
    wait_for(factor)
    with pytest.raises(MemoryError, match="3 times"):
        factor.solve(B)
    factor.close()


def test_remote_factor_says_that_it_cannot_be_started(monkeypatch):
    monkeypatch.setattr(remote_factor, "ChildProcess", ChildProcess)
    monkeypatch.setattr(sys, "executable", "/no/such/python")
    with pytest.raises(OSError, match="such"):
        far().begin()


def test_remote_factor_close_does_not_wait_for_the_factor(monkeypatch, tmp_path):
    begun = tmp_path / "begun"
    slow = f"""
        import time
        from pathlib import Path
        from apd_viewer.geometry.linalg.linear_solver import LinearSolver
        LinearSolver.from_rows = lambda *_: (Path({str(begun)!r}).touch(), time.sleep(60))
    """
    monkeypatch.setattr(remote_factor, "ChildProcess", forked.altered(slow))
    factor = far()
    factor.begin()
    end = time.monotonic() + 20.0
    while not begun.exists():
        assert time.monotonic() < end
        time.sleep(0.005)
    started = time.monotonic()
    factor.close()
    assert time.monotonic() - started < 1.0
    factor.close()
