"""Methods one after another on one document: each comes to what it comes to alone, from the rest shape."""

import threading
import time
from dataclasses import replace

import numpy as np
import pytest
from driven_session import BENT, LONG, document

import apd_viewer
from apd_viewer.cases.comparison import Comparison
from apd_viewer.geometry.energy import elastic_surface
from apd_viewer.geometry.pose.constraints import FREE
from apd_viewer.geometry.solver.convergence import Convergence
from apd_viewer.geometry.solver.methods import COMPARED_METHODS, METHODS
from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind
from apd_viewer.session.processes import solver_process


@pytest.fixture
def begun():
    """Begins comparisons, and closes them at last."""
    made = []

    def begin(asked, methods=COMPARED_METHODS):
        awake = threading.Event()
        comparison = Comparison(asked, awake.set)
        made.append(comparison)
        comparison.set_methods(methods)
        return comparison

    yield begin
    for comparison in made:
        comparison.stop()


@pytest.fixture
def cold(compiled, monkeypatch):
    """Nothing is compiled or loaded beforehand: here nobody compares how long it takes."""
    monkeypatch.setattr("apd_viewer.session.processes.request_solver.warm_up", lambda: None)


def until(comparison, happened):
    end = time.monotonic() + LONG
    while not happened():
        assert time.monotonic() < end
        comparison.receive_reply()
        time.sleep(0.001)


def finish(comparison):
    until(comparison, lambda: comparison.current_method is None)


def test_comparison_brings_each_method_to_what_it_comes_to_alone(begun, cold):
    asked = document(at=BENT).with_settings(stiffness=0.02, area=102.0)
    comparison = begun(asked)
    finish(comparison)
    assert list(comparison.outcomes) == list(COMPARED_METHODS)
    held, mesh = asked.constraints(), asked.mesh
    for method, outcome in comparison.outcomes.items():
        alone = apd_viewer.deform(
            mesh.V,
            mesh.F,
            held.fixed,
            held.targets,
            method,
            handle=held.handles,
            stiffness=0.02,
            area=102.0 if method in ("paper", "exact") else None,
        )
        frame = outcome.frame
        assert outcome.is_finished
        np.testing.assert_allclose(frame.U, alone.U, atol=1e-9)
        assert frame.iteration == alone.iterations
        assert frame.converged == alone.converged
        for name in ("area", "area_error", "volume", "handle_drift", "local_change"):
            assert getattr(frame, name) == pytest.approx(getattr(alone, name), abs=1e-9), name
        # Of "local" the frame tells the energy of its material, which is another one.
        assert outcome.cost.energy == pytest.approx(alone.energy, rel=1e-9)
        assert 0.0 < outcome.cost.seconds < LONG


def test_comparison_says_that_a_method_without_contact_meets_no_obstacles(begun, cold):
    left = NamedObstacle("left", ObstacleKind.PLATE, np.array([-0.1, 0.0, 0.0]), np.array([1.0, 0.0, 0.0]))
    plates = (replace(left, shift=np.array([0.3, 0.0, 0.0])),)
    bare = replace(document(), labels=np.full_like(document().labels, FREE), obstacles=plates)
    comparison = begun(bare.with_settings(contact=True), ("paper", "sr-arap"))
    finish(comparison)
    for method, outcome in comparison.outcomes.items():
        assert outcome.failure == METHODS[method].obstacle_problem != ""
    assert METHODS["exact"].obstacle_problem == ""
    bare = begun(replace(bare, obstacles=()), ("paper",))
    finish(bare)
    assert "no base" in bare.outcomes["paper"].failure


def test_comparison_does_not_depend_on_where_the_shape_was_led_before(begun, cold):
    asked = document(at=BENT)
    comparisons = [begun(asked, ("exact",)), begun(asked.with_settings(method="local"), ("local", "exact"))]
    for comparison in comparisons:
        finish(comparison)
    first, second = (comparison.outcomes["exact"].frame.U for comparison in comparisons)
    np.testing.assert_array_equal(first, second)


def endless(monkeypatch):
    """Let no method settle."""
    monkeypatch.setattr(
        "apd_viewer.geometry.solver.deformation.Deformation.settled", property(lambda _: False)
    )
    never = property(lambda _: Convergence(most_iterations=10**9), lambda *_: None)
    monkeypatch.setattr("apd_viewer.geometry.solver.deformation.Deformation.convergence", never)


def test_comparison_lets_what_is_not_wanted_any_more_give_way(begun, cold, monkeypatch):
    endless(monkeypatch)
    comparison = begun(document(at=BENT), ("arap", "exact"))
    until(comparison, lambda: comparison.outcomes["arap"].frame is not None)
    assert comparison.queued_methods == ("exact",)
    comparison.set_methods(("exact", "local"))
    assert list(comparison.outcomes) == ["exact"]
    until(comparison, lambda: comparison.outcomes["exact"].frame is not None)
    assert comparison.current_method == "exact"


def test_comparison_stopped_in_the_middle_keeps_what_has_come_and_leaves_no_process(
    begun, process, monkeypatch
):
    started = []
    start = solver_process.start_solver_process

    def starting():
        started.append(start())
        return started[-1]

    monkeypatch.setattr(solver_process, "start_solver_process", starting)
    threads = threading.active_count()
    comparison = begun(document(at=BENT), ("arap", "paper", "exact"))
    until(comparison, lambda: comparison.outcomes["arap"].frame is not None)
    assert len(started) == 1
    comparison.stop()
    assert all(one.pid is None for one in started)
    assert threading.active_count() == threads
    assert comparison.current_method is None
    assert comparison.queued_methods == ()
    assert comparison.outcomes["arap"].frame is not None


def test_comparison_ends_its_process_with_the_last_method(begun, cold):
    threads = threading.active_count()
    comparison = begun(document(at=BENT), ("arap",))
    finish(comparison)
    assert threading.active_count() == threads
    comparison.set_methods(("arap", "paper"))
    assert comparison.current_method == "paper"
    assert comparison.outcomes["arap"].is_finished
    finish(comparison)
    assert comparison.outcomes["paper"].is_finished
    assert threading.active_count() == threads


def test_comparison_says_why_a_method_fails_and_the_others_go_on(begun, cold, monkeypatch, capfd):
    real, calls = elastic_surface.LinearSolver, []

    def failing_once(A, V):
        calls.append(A)
        if len(calls) == 1:
            raise MemoryError
        return real(A, V)

    monkeypatch.setattr(elastic_surface, "LinearSolver", failing_once)
    comparison = begun(document(at=BENT), ("arap", "exact"))
    finish(comparison)
    arap, exact = comparison.outcomes["arap"], comparison.outcomes["exact"]
    assert arap.failure.startswith("Not enough memory")
    assert arap.frame is None
    assert exact.failure is None
    assert exact.frame.converged
