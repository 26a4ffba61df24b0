"""Signals while a kernel is compiled or runs, and within other blocks, are handled after it."""

import signal
import sys
import threading

import numba
import numpy as np
import pytest
from meshes import sphere

from apd_viewer.geometry.contact.pair_search import PairSearch
from apd_viewer.geometry.contact.patches import Patches
from apd_viewer.geometry.linalg.threads import cores_for
from apd_viewer.geometry.mesh.operators import cotangents, face_areas
from apd_viewer.geometry.signals import deferred_signals
from apd_viewer.geometry.signals.deferred_signals import DEFERRED_SIGNALS

pytestmark = pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="timers of Unix")


class StoppedError(Exception):
    """What a program's own handler raises."""


CALLED = []


def stop(number, frame):
    CALLED.append(number)
    raise StoppedError(number)


@pytest.fixture(autouse=True)
def handlers():
    before = {number: signal.signal(number, stop) for number in (signal.SIGALRM, signal.SIGINT)}
    yield
    signal.setitimer(signal.ITIMER_REAL, 0.0)
    for number, handler in before.items():
        signal.signal(number, handler)


def raised_by(number):
    """True if the signal is handled at once, by the program's own handler."""
    try:
        signal.raise_signal(number)
    except StoppedError:
        return signal.getsignal(number) is stop
    return False


def test_late_signals_call_handlers_at_the_end_once_each_and_restore_them():
    with pytest.raises(StoppedError), DEFERRED_SIGNALS, cores_for(10):  # noqa: PT012
        CALLED.clear()
        for number in (signal.SIGINT, signal.SIGALRM, signal.SIGINT):
            signal.raise_signal(number)
        assert CALLED == []
    assert sorted(CALLED) == [signal.SIGINT, signal.SIGALRM]
    assert raised_by(signal.SIGINT)
    assert raised_by(signal.SIGALRM)


def test_late_signals_leave_another_thread_alone():
    seen = []

    def look():
        with DEFERRED_SIGNALS:
            seen.append(signal.getsignal(signal.SIGINT))

    thread = threading.Thread(target=look)
    thread.start()
    thread.join()
    assert seen == [stop]


def interrupted_at(step):
    """Whether the block was gone through, with a signal before the given instruction of the context."""
    left, done = [step], []

    def trace(frame, event, _):
        if frame.f_code.co_filename != deferred_signals.__file__:
            return None
        frame.f_trace_opcodes = True
        if event == "opcode":
            left[0] -= 1
            if left[0] == 0:
                signal.raise_signal(signal.SIGINT)
        return trace

    sys.settrace(trace)
    try:
        with DEFERRED_SIGNALS:
            done.append(True)
    except StoppedError:
        return True, left[0] > 0
    finally:
        sys.settrace(None)
    return False, left[0] > 0


def test_late_signals_raise_a_signal_at_any_instruction_and_leave_all_in_order():
    for step in range(1, 5_000):
        stopped, beyond = interrupted_at(step)
        if beyond:
            break
        assert stopped, step
        with pytest.raises(StoppedError), DEFERRED_SIGNALS:  # whatever was left is put in order
            signal.raise_signal(signal.SIGALRM)
        assert raised_by(signal.SIGINT), step
        assert raised_by(signal.SIGALRM), step
    assert 50 < step < 4_999


def test_kernel_signals_run_no_python_between_a_kernel_and_its_result():
    V, F = sphere(2)
    seen = set()

    def profile(frame, event, _):
        if event == "call" and "numba" in frame.f_code.co_filename:
            seen.add(frame.f_code.co_name)

    for profiled in (None, profile):  # compiled before
        sys.setprofile(profiled)
        try:
            results = face_areas(V, F), cotangents(V, F)
        finally:
            sys.setprofile(None)
    assert seen == set(), "delete the compiled kernels of an older version"
    assert all(type(result) is np.ndarray for result in results)


def test_kernel_signals_let_out_of_a_contact_kernel_what_a_handler_raises():
    V, F = sphere(3)
    V, E = V * [1.0, 1.0, 0.05], np.unique(np.sort(F[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)), axis=0)
    patches = Patches(V, F, E)
    search = PairSearch(V, F, E, patches, np.zeros((0, len(V)), np.int64), 0.05)
    between = patches.near_pairs(patches.boxes(V), 0.1)[0]
    beyond = np.full(len(between), 0.01)
    expected, rng = search.near_pairs(V, between, beyond)[0], np.random.default_rng(1)
    for _ in range(100):
        with pytest.raises(StoppedError):  # noqa: PT012
            signal.setitimer(signal.ITIMER_REAL, rng.uniform(1e-4, 0.01))
            while True:
                search.near_pairs(V, between, beyond)
    found = search.near_pairs(V, between, beyond)[0]
    assert all(np.array_equal(*columns) for columns in zip(found, expected, strict=True))


def test_kernel_signals_let_a_kernel_be_compiled_to_its_end():
    @numba.njit
    def kernel(n):
        return np.arange(n).sum() + np.ones(n).sum()

    with pytest.raises(StoppedError):  # noqa: PT012
        signal.setitimer(signal.ITIMER_REAL, 0.02)
        kernel(4)
    assert len(kernel.signatures) == 1
    assert kernel(4) == 10.0
