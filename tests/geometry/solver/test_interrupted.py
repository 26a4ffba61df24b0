"""A deformation that is interrupted goes on with the same bits."""

import signal

import numpy as np
import pytest
from meshes import sphere

from apd_viewer import Deformation

pytestmark = pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="timers of Unix")


def pressed():
    """A lens whose upper wall is pressed onto the lower one."""
    V, F = sphere(3)
    V = V * [1.0, 1.0, 0.2]
    top = np.flatnonzero(V[:, 2] > 0.17)
    fixed = np.r_[np.flatnonzero((V[:, 2] < 0.0) & (np.hypot(V[:, 0], V[:, 1]) > 0.8)), top]
    solver = Deformation(V, F, fixed, handle=top, contact=True, thickness=0.1)
    solver.aim(V[fixed] - np.outer(np.isin(fixed, top), [0.0, 0.0, 0.5]))
    return solver


@pytest.fixture
def timer():
    def interrupt(*_):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, interrupt)
    yield lambda seconds: signal.setitimer(signal.ITIMER_REAL, seconds)
    signal.setitimer(signal.ITIMER_REAL, 0.0)
    signal.signal(signal.SIGALRM, before)


def test_deformation_iterate_is_interrupted_only_between_two_iterations(timer):
    rng, most = np.random.default_rng(1), 30
    expected, solver, interrupted = pressed(), pressed(), 0
    for _ in range(most):
        expected.iterate()
    assert expected.frame().contact.pairs > 0
    done = 0
    while done < most:
        try:
            timer(rng.uniform(1e-4, 0.02))
            while done < most:
                solver.iterate()
                done = solver.frame().iteration
            timer(0.0)
        except KeyboardInterrupt:
            interrupted += 1
        done = solver.frame().iteration
    assert interrupted > 10
    assert done == most
    assert np.array_equal(solver.frame().U, expected.frame().U)
