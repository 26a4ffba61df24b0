"""A surface at rest that is guided again: what is shown meanwhile, and what comes of it."""

import numpy as np
import pytest
from meshes import rotation, tube

from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.restarts import Restarts

V, F = tube(48, 72, height=4.0)
REST = RestMesh(V, F)
Z = V[:, 2]
FIXED = np.flatnonzero((Z.min() + 0.4 > Z) | (Z.max() - 0.4 < Z))
HANDLE = Z[FIXED] > Z.mean()


def turned(angle):
    targets = V[FIXED].copy()
    targets[HANDLE] = targets[HANDLE] @ rotation([0, 0, 1], angle).T
    return targets


def to_the_end(solver, most=3000):
    """Frames of all iterations, and whether each hides a try."""
    frames, hidden = [], []
    while not solver.settled:
        frames.append(solver.step())
        hidden.append(solver.solver.progress.is_iterate_hidden)
        assert len(frames) < most
    return frames, np.array(hidden)


def shown_while_it_tries(angle):
    """A solver in the midst of a try, and the shape that is shown."""
    solver = Deformation(V, F, FIXED, rest=REST)
    solver.aim(turned(angle))
    while not solver.solver.progress.is_iterate_hidden:
        solver.iterate()
    shown = solver.frame().U
    for _ in range(5):
        solver.iterate()
    return solver, shown


@pytest.mark.parametrize("method", ["arap", "exact"])
def test_restarts_show_a_try_once_it_is_better_and_never_before(method):
    solver = Deformation(V, F, FIXED, method=method, rest=REST)
    assert isinstance(solver.solver, Restarts)
    targets = turned(2.0)
    solver.aim(targets)
    frames, hidden = to_the_end(solver)
    assert hidden.any()
    first = int(np.argmax(hidden))
    rested = REST.energy(frames[first].U)
    for k, frame in enumerate(frames):
        assert np.array_equal(frame.U[FIXED], targets)
        assert method == "arap" or k == 0 or abs(frame.area_error) <= 1e-9
        if k > first and hidden[k] and hidden[k - 1]:
            assert frame.U.tobytes() == frames[k - 1].U.tobytes()
        if hidden[k] or k == len(frames) - 1:
            assert REST.energy(frame.U) <= rested * (1 + 1e-12)
    assert frames[-1].converged
    gaps = [frame.gap for frame in frames]
    assert gaps[0] is None  # it follows the coarse surface
    assert gaps[first] == 0.0
    assert 1e3 < min(gap for gap in gaps[:first] if gap is not None) < 1e4  # it only leads, so far
    assert 0.0 < gaps[-1] <= 1.0
    assert not hidden[-1]


def test_restarts_end_a_try_when_the_hand_moves_on():
    solver, shown = shown_while_it_tries(1.0)
    assert solver.frame().U.tobytes() == shown.tobytes()
    solver.aim(turned(1.1))
    assert not solver.solver.progress.is_iterate_hidden
    frame = solver.step()
    assert np.array_equal(frame.U[FIXED], turned(1.1))
    assert abs(frame.area_error) <= 1e-9


def test_restarts_let_the_hand_move_on_from_the_shape_that_is_shown():
    """Not from where the try has got to: the shape must not leap under the hand."""
    solver, shown = shown_while_it_tries(2.0)
    solver.aim(turned(2.0))
    assert np.abs(solver.step().U - shown).max() <= 1e-2 * REST.diagonal


def test_restarts_end_no_try_without_a_hessian_before_it_gains_too_little(monkeypatch):
    """A try of "exact" goes on while ten steps gain a ten-thousandth, whatever the coarse one does."""
    solver = Deformation(V, F, FIXED, rest=REST)
    solver.aim(turned(2.0))
    inner, asked = solver.solver.inner, set()
    monkeypatch.setattr(inner, "has_stalled", lambda tolerance: asked.add(tolerance) or False)
    while not solver.solver.progress.is_iterate_hidden:
        solver.iterate()
    for _ in range(30):
        solver.iterate()
    assert asked == {1e-4}
