"""The readings along a gesture: what begins them, what is in them, and that they stay small."""

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from driven_session import Driven, pose
from meshes import box

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import HANDLE
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.trace import MOST_SAMPLES, TRACE_COLUMNS, Trace

REST = initial_state(Mesh(*box(1, 1, 2)))


class Clock:
    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


@pytest.fixture
def clock():
    return Clock()


def moved(k):
    """The document as it is asked for at the ``k``-th place of a handle."""
    P = np.eye(4)
    P[0, 3] = 0.01 * k
    return REST.document.with_pose(0, P)


def frame(iteration=1, total=1, **what):
    return replace(REST.frame, iteration=iteration, total=total, **what)


def test_trace_leads_from_the_state_before_to_the_latest_frame(clock):
    trace = Trace(clock)
    trace.begin(REST)
    trace.begin_with_next_frame(REST.document, REST)
    clock.now += 1.0
    changes = {"local_change": 0.5, "largest_edge_strain": -0.25, "mean_edge_strain": 0.125}
    trace.add_frame(moved(1), frame(2, 2, area=7.5, area_error=-0.25, volume=None, energy=3.0, **changes))
    assert [trace[name].tolist() for name in ("seconds", "iteration")] == [[0.0, 1.0], [0.0, 2.0]]
    assert trace["area"].tolist() == [REST.frame.area, 7.5]
    assert trace["area_error"].tolist() == [0.0, -0.25]
    assert trace["energy"].tolist() == [0.0, 3.0]
    for name, change in changes.items():
        assert trace[name].tolist() == [0.0, change]
    assert trace["volume"][0] == REST.frame.volume
    assert np.isnan(trace["volume"][1])
    assert trace.rows.shape == (2, len(TRACE_COLUMNS))
    assert not trace.rows.flags.writeable


def test_trace_takes_the_miss_against_what_is_asked_for(clock):
    trace = Trace(clock)
    trace.begin(REST)
    trace.add_frame(REST.document.with_settings(area=80.0), frame(1, 1, area_error=-0.1))
    trace.add_frame(REST.document.with_settings(area=80.0, method="arap"), frame(2, 2, area_error=-0.1))
    assert trace["area_miss"][1:].tolist() == pytest.approx([0.9 / 0.8 - 1.0, 0.1])


def test_trace_counts_iterations_that_nobody_saw_too(clock):
    trace = Trace(clock)
    trace.begin(REST)
    for k, (iteration, total) in enumerate([(3, 3), (2, 9), (40, 47), (1, 1)]):
        trace.add_frame(moved(k), frame(iteration, total))
    # The last frame is of another solver.
    assert trace["iteration"].tolist() == [0, 3, 9, 47, 48]


def test_trace_expect_leaves_answers_to_the_old_question_in_the_old_trace(clock):
    trace, first, second = Trace(clock), moved(1), moved(2)
    trace.begin(REST)
    trace.add_frame(first, frame(1, 1))
    clock.now += 1.0
    trace.begin_with_next_frame(first, REST.updated(frame=frame(area=5.0)))
    trace.add_frame(first, frame(2, 2))
    assert len(trace) == 3
    trace.add_frame(second, frame(1, 3))
    assert len(trace) == 2
    assert trace["area"][0] == 5.0


def test_released_at_is_told_from_the_beginning_of_its_own_gesture(clock):
    trace = Trace(clock)
    trace.begin(REST)
    trace.begin_with_next_frame(REST.document, REST)
    clock.now += 2.0
    trace.mark_release()  # before the first frame has come
    assert trace.released_at is None
    trace.add_frame(moved(1), frame())
    assert trace.released_at == 2.0
    trace.begin_with_next_frame(moved(1), REST)
    trace.mark_release()  # of a stroke, which nothing answers
    assert trace.released_at == 2.0
    trace.begin(REST)
    assert trace.released_at is None


def test_trace_takes_no_more_memory_for_eleven_thousand_frames_than_for_three_thousand(clock):
    trace = Trace(clock)
    trace.begin(REST)
    documents = moved(1), moved(2)
    # Python keeps up to 2,000 freed tuples of one length for later: they are no growth of the trace.
    tracemalloc.start()
    try:
        sizes = []
        for k in range(11_000):
            clock.now += 0.01
            trace.add_frame(documents[k % 2], frame(1, k + 1, area=float(k)))
            if k in (3_000, 10_999):
                sizes.append(tracemalloc.get_traced_memory()[0])
    finally:
        tracemalloc.stop()
    assert sizes[1] - sizes[0] < 0.05 * trace.rows.nbytes
    assert MOST_SAMPLES / 2 <= len(trace) <= MOST_SAMPLES
    seconds = trace["seconds"]
    assert (seconds[0], trace["area"][-1], trace["iteration"][-1]) == (0.0, 10_999.0, 11_000.0)
    steps = np.diff(seconds[:-1])
    assert steps.min() > 0.9 * steps.max(), "what is left out is left out evenly"


def test_trace_has_the_latest_frame_at_any_time(clock):
    trace = Trace(clock)
    trace.begin(REST)
    for k in range(3 * MOST_SAMPLES):
        trace.add_frame(moved(1), frame(k + 1, k + 1, area=float(k)))
        assert trace["area"][-1] == k
        assert trace["area"][0] == REST.frame.area


# With the real worker


@pytest.fixture
def session():
    session = Driven()
    session.show_now(Mesh(*box(2, 2, 6)))
    session.paint_ends()
    session.settle()
    yield session
    session.close()


def drag(session, *poses):
    session.gestures.begin()
    for each in poses:
        session.handles.drag(each)
        session.listen(0.02)
    session.gestures.end("Move handle")
    session.settle()


def check_leads_to_the_screen(trace, frame):
    assert trace["area"][-1] == frame.area
    assert trace["volume"][-1] == frame.volume
    assert trace["energy"][-1] == frame.energy
    assert trace["iteration"][-1] >= frame.iteration
    assert (np.diff(trace["seconds"]) >= 0.0).all()
    assert (np.diff(trace["iteration"]) > 0).all()


def test_trace_holds_one_drag_and_the_next_one_begins_where_it_ended(session):
    trace, rest = session.store.trace, session.store.state.frame
    assert len(trace) == 1
    drag(session, *(pose(0.1 * k) for k in range(1, 8)))
    check_leads_to_the_screen(trace, session.store.state.frame)
    assert (len(trace) > 2, trace["area"][0], trace["energy"][0]) == (True, rest.area, 0.0)
    assert trace.released_at >= 7 * 0.02
    before = session.store.state.frame
    drag(session, pose(0.9))
    check_leads_to_the_screen(trace, session.store.state.frame)
    assert trace["volume"][0] == before.volume
    every = {frame.volume for _, state in session.changes for frame in (state.frame,)}
    assert set(trace["volume"].tolist()) <= every, "a trace holds what was shown, and nothing else"


def test_trace_begins_anew_with_undo_another_method_and_another_mesh(session):
    trace = session.store.trace
    drag(session, pose(0.6))
    before = session.store.state.frame
    session.settings.change(method="arap")
    session.settle()
    assert trace["volume"][0] == before.volume
    assert trace.released_at is None
    check_leads_to_the_screen(trace, session.store.state.frame)
    session.gestures.undo()
    session.settle()
    assert trace["volume"][0] == before.volume
    assert trace["iteration"][0] == 0
    session.gestures.undo()
    session.settle()
    assert trace["energy"].tolist() == [0.0], "it is at rest again"
    session.show_now(Mesh(*box(1, 1, 3)))
    session.settle()
    assert trace["volume"].tolist() == [3.0]


def test_trace_is_left_alone_by_paint(session):
    drag(session, pose(0.6))
    rows = session.store.trace.rows
    session.stroke(np.array([len(session.U) // 2]), HANDLE)
    session.settle()
    np.testing.assert_array_equal(session.store.trace.rows, rows)


def test_trace_takes_steps_that_are_one_for_undo_as_one(session):
    before = session.store.state.frame
    for k in range(1, 4):
        session.handles.set_pose(pose(shift=(0.05 * k, 0.0, 0.0)), 0, "Nudge handle", is_repeat=True)
        session.settle()
    assert session.store.trace["volume"][0] == before.volume
    check_leads_to_the_screen(session.store.trace, session.store.state.frame)
    session.handles.set_pose(pose(shift=(0.3, 0.0, 0.0)), 0, "Move along X")
    session.settle()
    assert session.store.trace["volume"][0] != before.volume
