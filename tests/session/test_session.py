"""The user's verbs, answered by the real worker; the owner's thread is the test's."""

import time
from collections.abc import Callable

import numpy as np
import pytest
from driven_session import BENT, Driven, bar, pose, ready, solver_threads
from meshes import box, ends

from apd_viewer.geometry.energy import elastic_surface
from apd_viewer.geometry.linalg import linear_solver
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.geometry.solver.convergence import Convergence
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.session.model.history import History
from apd_viewer.session.shape_checks import ShapeChecks
from apd_viewer.session.state_store import Activity

# Undo and redo


def test_undo_and_redo_bring_back_the_very_objects(session):
    before = session.store.state
    session.drag(pose(0.2), pose(0.4), BENT)
    session.settle()
    after = session.store.state
    copy = after.frame.U.copy()
    session.gestures.undo()
    assert session.store.state is before
    session.gestures.redo()
    assert session.store.state is after
    assert np.array_equal(session.U, copy)
    session.listen(0.03)
    assert session.store.state is after


def _gestures(session: Driven, tmp_path) -> dict[str, Callable[[], None]]:
    return {
        "Paint": lambda: session.stroke(np.arange(3, 9), FREE),
        "Rotate about y −1.146° (Handle 1)": lambda: session.drag(*(pose(k / 50) for k in range(30))),
        "Reset all handles": session.shapes.restore,
        "Change method": lambda: session.settings.change(method="arap"),
        "Change tolerance": lambda: session.settings.change(tolerance=0.01),
        "Change convergence": lambda: session.settings.change(convergence=Convergence(500, 1e-9)),
        "Open mesh": lambda: session.show_now(bar()),
    }


@pytest.mark.parametrize(
    "name",
    [
        "Paint",
        "Rotate about y −1.146° (Handle 1)",
        "Reset all handles",
        "Change method",
        "Change tolerance",
        "Change convergence",
        "Open mesh",
    ],
)
def test_gestures_are_one_entry_each_and_undone_exactly(session, tmp_path, name):
    session.drag(BENT)
    session.settle()
    before = session.store.state
    _gestures(session, tmp_path)[name]()
    session.settle()
    after = session.store.state
    assert session.gestures.history.next_undo_name == name
    session.gestures.undo()
    assert session.store.state is before
    assert session.gestures.history.next_redo_name == name
    session.gestures.redo()
    assert session.store.state is after


def test_gestures_forget_with_a_new_one_what_could_be_redone(session):
    session.drag(BENT)
    session.gestures.undo()
    assert session.gestures.history.next_redo_name == "Rotate about y +34.38° (Handle 1)"
    session.settings.change(tolerance=0.02)
    assert session.gestures.history.next_redo_name is None


@pytest.mark.parametrize("kind", ["stroke", "drag"])
def test_gestures_cancel_leaves_no_trace(session, kind):
    session.drag(pose(0.1))
    session.settle()
    session.gestures.undo()
    before, undo, redo = (
        session.store.state,
        session.gestures.history.next_undo_name,
        session.gestures.history.next_redo_name,
    )
    session.gestures.begin()
    if kind == "stroke":
        session.painting.paint(np.arange(20), HANDLE)
    else:
        session.handles.drag(BENT)
        session.until(lambda: session.store.state.frame is not before.frame)
    session.gestures.cancel()
    assert session.store.state is before
    assert (session.gestures.history.next_undo_name, session.gestures.history.next_redo_name) == (undo, redo)
    session.listen(0.03)
    assert session.store.state is before


def test_gestures_end_leaves_no_entry_of_an_empty_gesture(session):
    undo = session.gestures.history.next_undo_name, session.store.state.document
    session.gestures.begin()
    session.gestures.end("Move handle")
    session.gestures.begin()
    session.painting.end_stroke("Paint")
    session.gestures.cancel()
    assert (session.gestures.history.next_undo_name, session.store.state.document) == undo


def test_paint_that_changes_nothing_leaves_the_document(session):
    document, undo = session.store.state.document, session.gestures.history.next_undo_name
    session.stroke(np.flatnonzero(document.labels == BASE), BASE)
    assert session.gestures.history.next_undo_name == undo
    assert session.store.state.document is document


def test_paint_that_replaces_a_part_by_itself_is_no_step(session):
    before, undo = session.store.state.document, session.gestures.history.next_undo_name
    ids = np.flatnonzero(before.labels == BASE)
    session.gestures.begin()
    session.painting.paint(ids, FREE)
    session.painting.paint(ids, BASE)
    session.painting.end_stroke("Paint base")
    assert session.store.state.document is before
    assert session.gestures.history.next_undo_name == undo


def test_paint_region_that_replaces_a_region_by_itself_is_no_step_and_it_is_still_kept(session):
    ids = np.flatnonzero(session.store.state.document.labels == FREE)
    session.gestures.begin()
    session.painting.paint_region(ids, 1)
    session.painting.end_stroke("Paint region")
    session.settings.set_region_area(0, 103.0)
    session.drag(BENT)
    session.settle()
    before, steps = session.store.state.document, len(session.gestures.history.undo_names)
    session.gestures.begin()
    session.painting.paint_region(ids, 0)
    session.settle()  # as it is without what was asked
    session.painting.paint_region(ids, 1)
    session.painting.end_stroke("Paint region")
    assert session.store.state.document is before
    assert len(session.gestures.history.undo_names) == steps
    session.settle()
    assert session.store.state.frame.regions[0] == pytest.approx(1.03 * before.rest_areas[0], rel=1e-6)


def test_handle_editor_drag_settles_when_it_ends_while_a_stroke_without_effect_is_painted(session):
    ready(session)
    session.drag(BENT)
    session.gestures.begin()
    session.painting.paint(np.flatnonzero(session.store.state.document.labels == BASE), BASE)
    session.until(lambda: session.store.state.frame.converged and session.store.state.frame.iteration)
    session.painting.end_stroke("Paint")
    assert session.wait_idle(1.0)


def test_history_forgets_old_states_by_their_bytes_but_one_stays(session):
    session.gestures.history = History(most_bytes=1)
    for angle in (0.1, 0.2, 0.3):
        session.drag(pose(angle))
    session.settle()
    session.gestures.undo()
    assert session.gestures.history.next_undo_name is None
    assert np.array_equal(session.store.state.document.handles[0].pose, pose(0.2))


@pytest.mark.parametrize("kind", ["stroke", "drag"])
def test_undo_within_a_gesture_cancels_it_first(session, kind):
    session.drag(pose(0.1))
    session.settle()
    previous = session.store.state
    session.settings.change(tolerance=0.5)
    session.settle()
    session.gestures.begin()
    if kind == "stroke":
        session.painting.paint(np.arange(20), HANDLE)
    else:
        session.handles.drag(BENT)
    session.gestures.undo()
    assert session.store.state is previous
    session.gestures.end("Move handle")
    session.painting.end_stroke("Paint")
    assert session.store.state is previous
    assert session.gestures.history.next_redo_name == "Change tolerance"


def test_paint_adds_nothing_to_a_stroke_that_undo_has_ended_unless_it_can_be_undone(session):
    session.gestures.begin()
    session.painting.paint(np.arange(8), BASE)
    session.gestures.undo()
    document = session.store.state.document
    session.painting.paint(np.arange(20), BASE)
    session.painting.end_stroke("Paint")
    assert session.store.state.document is document or session.gestures.history.next_redo_name is None


def test_redo_goes_on_with_what_was_undone_before_it_had_settled(session, slow):
    session.drag(BENT)
    session.until(lambda: session.store.state.frame.iteration >= 2)
    unfinished = session.store.state
    assert not unfinished.frame.converged
    session.gestures.undo()
    assert session.store.activity is Activity.IDLE
    session.gestures.redo()
    assert session.store.state is unfinished
    assert session.store.activity is Activity.REFINING
    session.settle()
    assert session.store.activity is Activity.SETTLED
    assert session.store.state.document is unfinished.document
    assert session.store.state.frame.converged


def test_undo_to_a_shape_that_had_not_settled_goes_on(session):
    session.drag(BENT)
    session.until(lambda: session.store.state.frame.iteration >= 1)
    document = session.store.state.document
    session.drag(pose(-0.6))
    session.gestures.undo()
    assert session.store.state.document is document
    session.settle()
    assert session.store.state.document is document
    assert session.store.state.frame.converged


@pytest.mark.parametrize("detour", ["undo and redo", "cancel", "setting"])
def test_handle_editor_drag_without_a_frame_yet_reaches_its_pose_after_a_detour(session, slow, detour):
    session.settings.change(method="arap")
    ready(session)
    session.drag(BENT if detour != "setting" else np.eye(4))
    if detour == "undo and redo":
        session.gestures.undo()
        session.gestures.redo()
    elif detour == "cancel":
        session.gestures.begin()
        session.gestures.cancel()
    else:
        session.settings.change(tolerance=0.5)
    session.settle()
    held = session.store.state.document.constraints()
    assert np.allclose(session.U[held.fixed], held.targets, rtol=0, atol=1e-12)


@pytest.mark.parametrize("detour", ["undo and redo", "cancel"])
def test_gestures_leave_a_shape_at_rest_after_a_stroke_at_rest(session, slow, detour):
    session.drag(BENT)
    session.until(lambda: session.store.state.frame.iteration)
    session.stroke(np.flatnonzero(session.store.state.document.mesh.V[:, 2] == 1.0), BASE)
    U = session.U
    if detour == "undo and redo":
        session.gestures.undo()
        session.gestures.redo()
    else:
        session.gestures.begin()
        session.gestures.cancel()
    session.listen(0.05)
    assert session.U is U


def test_undo_and_redo_with_nothing_to_do_are_no_error(empty):
    empty.show_now(bar())
    state = empty.store.state
    empty.gestures.undo()
    empty.gestures.redo()
    assert empty.store.state is state


@pytest.mark.parametrize("name", ["Change tolerance", "Change method", "Reset all handles"])
def test_undo_goes_back_in_time_whatever_was_done_within_a_drag(session, tmp_path, name):
    ready(session)
    session.gestures.begin()
    before = session.store.state
    session.handles.drag(BENT)
    session.until(lambda: session.store.state.frame.iteration)
    _gestures(session, tmp_path)[name]()
    session.gestures.end("Move handle")
    poses = [session.store.state.document.handles[0].pose]
    while session.store.state.document is not before.document and session.gestures.history.next_undo_name:
        session.gestures.undo()
        poses.append(session.store.state.document.handles[0].pose)
    # After the state before the drag comes nothing that was made in it.
    session.gestures.undo()
    assert not np.array_equal(session.store.state.document.handles[0].pose, BENT)


def test_settings_changed_within_a_stroke_do_not_let_the_painted_vertices_leap(session):
    session.settings.change(method="arap")
    session.drag(BENT)
    session.settle()
    middle = np.flatnonzero(session.store.state.document.mesh.V[:, 2] == 4.0)
    U = session.U[middle]
    session.gestures.begin()
    session.painting.paint(middle, BASE)
    session.settings.change(tolerance=0.5)
    session.listen(0.1)
    assert np.abs(session.U[middle] - U).max() < 1e-3


def test_files_open_mesh_within_a_gesture_can_be_undone_to_a_whole_state(session):
    session.drag(BENT)
    session.settle()
    before = session.store.state
    session.gestures.begin()
    session.painting.paint(np.flatnonzero(session.store.state.document.mesh.V[:, 2] == 4.0), BASE)
    session.show_now(bar())
    session.gestures.undo()
    assert session.store.state is before


# Factorizations


def test_handle_editor_drag_never_factors(session, factored):
    ready(session)
    factored.count = 0
    session.gestures.begin()
    for k in range(50):
        session.handles.drag(pose(k / 60))
        session.listen(0.003)
    session.gestures.end("Move handle")
    session.settle()
    assert factored.count == 0


def test_request_solver_factors_once_after_a_stroke_before_the_first_drag(empty, factored):
    empty.show_now(bar())
    empty.paint_ends()
    empty.until(lambda: factored.count == 1)
    empty.drag(*(pose(k / 60) for k in range(50)))
    empty.settle()
    assert factored.count == 1


def test_request_solver_gets_to_know_a_mesh_while_it_is_painted(empty, monkeypatch):
    known = []
    monkeypatch.setattr("apd_viewer.session.processes.request_solver.compute_decimations", known.append)
    empty.show_now(bar())
    assert empty.store.state.document.paint_problem
    empty.until(lambda: known)
    assert np.array_equal(known[0].V, empty.store.state.document.mesh.V)
    empty.stroke(np.arange(2), BASE)
    empty.listen(0.1)
    assert len({id(rest) for rest in known}) == 1, "once for all strokes"


def test_is_preparing_lasts_until_the_first_shape(empty):
    empty.show_now(bar())
    empty.paint_ends()
    assert not empty.store.is_preparing, "nobody waits for it yet"
    empty.gestures.begin()
    empty.handles.drag(pose(0.1))
    assert empty.store.is_preparing
    empty.until(lambda: not empty.store.is_preparing)
    assert empty.store.state.frame.iteration >= 1
    empty.handles.drag(pose(0.2))
    assert not empty.store.is_preparing
    empty.gestures.end("Move handle")
    empty.settle()
    empty.settings.change(method="arap")
    assert empty.store.is_preparing, "another method is factored for"
    empty.settle()
    assert not empty.store.is_preparing


def test_request_solver_does_not_factor_for_settings_undo_and_reset(session, factored):
    ready(session)
    factored.count = 0
    session.settings.change(tolerance=0.01)
    session.settle()
    session.drag(BENT)
    session.settle()
    session.gestures.undo()
    session.gestures.redo()
    session.shapes.restore()
    session.drag(BENT)
    session.settle()
    assert factored.count == 0


@pytest.mark.parametrize("what", ["labels", "method", "mesh"])
def test_request_solver_factors_for_other_labels_another_method_and_another_mesh(session, factored, what):
    ready(session)
    factored.count = 0
    if what == "labels":
        session.stroke(np.flatnonzero(session.store.state.document.mesh.V[:, 2] == 1.0), BASE)
    elif what == "method":
        session.settings.change(method="arap")
    else:
        session.show_now(bar())
        session.paint_ends()
    ready(session)
    assert factored.count == 1


# The newest request wins


def test_request_solver_aims_at_few_of_a_burst_of_poses_and_the_last_one_settles(session, slow, monkeypatch):
    session.settings.change(method="arap")
    ready(session)
    aimed = []
    real = Deformation.aim
    monkeypatch.setattr(Deformation, "aim", lambda self, *args: (aimed.append(args[0]), real(self, *args))[1])
    session.drag(*(pose(k / 400, (k / 200, 0.0, 0.0)) for k in range(200)))
    session.settle()
    assert len(aimed) < 60
    held = session.store.state.document.constraints()
    assert np.array_equal(aimed[-1], held.targets)
    assert np.allclose(session.U[held.fixed], held.targets, rtol=0, atol=1e-12)
    assert session.store.activity is Activity.SETTLED


def test_listener_is_told_of_a_change_once(monkeypatch):
    followed = []
    monkeypatch.setattr(ShapeChecks, "follow_state", lambda _: followed.append("state"))
    session = Driven()
    session.show_now(bar())
    session.paint_ends()
    ready(session)
    session.gestures.begin()
    for angle in (0.1, 0.2):
        del followed[:], session.changes[:]
        session.handles.drag(pose(angle))
        assert len(followed) == len(session.changes) == 1, "of an event of the mouse"
        del followed[:], session.changes[:]
        session.until(lambda: session.changes)
        assert len(followed) == len(session.changes) == 1, "of a reply"
    session.close()


def test_store_shows_frames_while_poses_arrive_faster_than_a_step(session, slow):
    ready(session)
    shown = len(session.changes)
    session.gestures.begin()
    frames = set()
    end = time.monotonic() + 0.4
    while time.monotonic() < end:
        session.handles.drag(pose(0.3 * (end - time.monotonic())))
        session.receive_results()
        frames.add(id(session.store.state.frame))
        time.sleep(0.001)
    session.gestures.end("Move handle")
    session.settle()
    assert len(frames) > 10
    assert len(session.changes) > shown


def test_store_shows_frames_while_poses_arrive_faster_than_they_can_be_aimed_at(session, monkeypatch):
    ready(session)
    real = Deformation.aim

    def aim(self, *args):
        time.sleep(0.01)
        real(self, *args)

    monkeypatch.setattr(Deformation, "aim", aim)
    session.gestures.begin()
    first, frames = session.store.state.frame, set()
    end = time.monotonic() + 0.5
    while time.monotonic() < end:
        session.handles.drag(pose(0.3 * (end - time.monotonic())))
        session.receive_results()
        frames.add(session.store.state.frame)
        time.sleep(0.001)
    session.gestures.cancel()
    assert len(frames - {first}) >= 12


def test_listener_is_woken_by_the_worker_once_for_what_it_has_not_taken(session):
    ready(session)
    session.woken.clear()
    session.gestures.begin()
    session.handles.drag(BENT)
    time.sleep(0.1)
    assert session.woken == ["answers"]
    session.settle()
    session.gestures.end("Move handle")


# Frames of the time before a jump


def _jumps(session: Driven) -> dict[str, Callable[[], None]]:
    def stroke() -> None:
        session.gestures.end("Move handle")
        document = session.store.state.document
        ring = np.flatnonzero(document.mesh.V[:, 2] == 3.0)
        session.stroke(ring, FREE if document.labels[ring[0]] == BASE else BASE)

    return {
        "undo": lambda: (session.gestures.end("Move handle"), session.gestures.undo()),
        "cancel": session.gestures.cancel,
        "reset": lambda: (session.gestures.end("Move handle"), session.shapes.restore()),
        "stroke": stroke,
    }


@pytest.mark.parametrize("jump", ["undo", "cancel", "reset", "stroke"])
def test_jump_to_is_followed_by_no_frame_from_before_it(session, slow, jump):
    session.settings.change(method="arap")
    for k in range(8):
        session.gestures.begin()
        session.handles.drag(pose(0.3, (1.0, 0.0, 0.0)))
        count = len(session.changes)
        session.until(lambda count=count: len(session.changes) > count)
        session.handles.drag(pose(0.5, (2.0, 0.0, 0.0)))
        session.listen(0.004 * (k % 4))
        _jumps(session)[jump]()
        state, changes = session.store.state, len(session.changes)
        session.listen(0.04)
        assert session.store.state is state
        assert len(session.changes) == changes
        session.shapes.restore()


def test_jump_to_an_unsettled_shape_shows_its_own_frames_only(session, slow):
    session.settings.change(method="arap")
    session.drag(pose(0.4, (-1.0, 0.0, 0.0)))
    session.until(lambda: session.store.state.frame.iteration)
    session.gestures.begin()
    session.handles.drag(pose(0.5, (2.0, 0.0, 0.0)))
    session.until(lambda: session.handle_at[0] > 2.5)
    changes = len(session.changes)
    session.gestures.undo()
    session.gestures.undo()
    session.gestures.redo()
    session.settle()
    document = session.store.state.document
    for _, state in session.changes[changes + 1 :]:
        x = state.frame.U[document.labels == HANDLE].mean(axis=0)[0]
        assert x < 1.0 + 1e-9, "a frame of the undone pose was shown"


def test_store_never_gets_frames_of_an_older_mesh(session, slow):
    small = Mesh(*box(1, 1, 3))
    for mesh in (small, bar(), small, bar()):
        session.drag(pose(0.5))
        session.until(lambda: session.store.state.frame.iteration)
        session.show_now(mesh)
        session.listen(0.03)
        assert session.U is mesh.V
        session.paint_ends()
    assert all(state.frame.U.shape == state.document.mesh.V.shape for _, state in session.changes)


def test_store_does_not_take_the_end_of_an_older_pose_for_the_end_of_this_one(session, slow):
    """The frame lay there unread when the handle was moved on."""
    session.settings.change(method="arap")
    session.until(solver_threads)
    session.drag(pose(0.02))
    (thread,) = solver_threads()
    clock = time.pthread_getcpuclockid(thread.ident)
    before = -1.0
    while time.clock_gettime(clock) - before > 1e-4:
        before = time.clock_gettime(clock)
        time.sleep(0.05)
    session.drag(BENT)
    session.receive_results()
    assert session.store.state.frame.iteration
    assert not session.store.state.frame.settled
    session.gestures.undo()
    session.gestures.redo()
    session.settle()
    held = session.store.state.document.constraints()
    assert np.allclose(session.U[held.fixed], held.targets, rtol=0, atol=1e-12)


# PaintEditor after a drag


@pytest.mark.parametrize("method", ["arap", "paper"])
@pytest.mark.parametrize("settled", [True, False])
def test_paint_after_a_drag_moves_nothing(session, method, settled):
    session.settings.change(method=method)
    session.drag(pose(0.9, (1.0, 0.0, 0.5)))
    session.until(lambda: session.store.state.frame.iteration >= 3)
    if settled:
        session.settle()
    grey = np.flatnonzero(session.store.state.document.mesh.V[:, 2] == 1.0)
    session.gestures.begin()
    session.painting.paint(grey, BASE)
    U = session.U
    session.painting.end_stroke("Paint")
    session.listen(0.05)
    assert session.U is U
    assert session.store.state.document.initial_positions is U
    assert np.array_equal(session.store.state.document.handles[0].pose, np.eye(4))
    assert session.store.state.frame.handle_drift == 0.0
    assert session.store.activity is Activity.IDLE


@pytest.mark.parametrize(("method", "most"), [("arap", 1e-3), ("paper", 1e-2)])
def test_handle_editor_drag_does_not_leap_when_it_is_the_first_after_painting(session, method, most):
    """paper: its area may still close by the tolerance, which shows as 5e-4 of the bar's length."""
    session.settings.change(method=method)
    session.drag(pose(0.9, (1.0, 0.0, 0.5)))
    session.settle()
    session.stroke(np.flatnonzero(session.store.state.document.mesh.V[:, 2] == 1.0), BASE)
    U, changes = session.U, len(session.changes)
    session.drag(pose(1e-4))
    session.settle()
    moved = [np.abs(state.frame.U - U).max() for _, state in session.changes[changes:]]
    assert max(moved) < most
    base = session.store.state.document.labels == BASE
    assert np.array_equal(session.U[base], U[base])


# Failures


@pytest.mark.parametrize(
    ("error", "said"),
    [(ValueError("not positive definite"), "not positive definite"), (MemoryError(), "Not enough memory")],
)
def test_store_tells_of_a_failing_solver_and_the_session_lives_on(session, monkeypatch, caplog, error, said):
    session.drag(BENT)
    session.settle()
    before = session.store.state
    real, calls = linear_solver.LinearSolver, []

    def failing_once(A, V):
        calls.append(A)
        if len(calls) == 1:
            raise type(error)(*error.args)  # one that does not outlive the test, and the solver with it
        return real(A, V)

    monkeypatch.setattr(elastic_surface, "LinearSolver", failing_once)
    session.settings.change(method="arap")
    session.until(lambda: session.failed)
    assert len(session.failed) == 1
    assert said in session.failed[0]
    assert session.failed[0].endswith(".")
    assert session.store.activity is Activity.UNREACHED
    assert type(error).__name__ in caplog.text
    assert session.U is before.frame.U
    session.drag(pose(0.2))
    session.settle()
    assert session.store.activity is Activity.SETTLED
    session.gestures.undo()
    session.gestures.undo()
    assert session.store.state is before
    assert len(session.failed) == 1


def test_store_names_an_error_that_says_nothing(session, monkeypatch, capfd):
    def failing(_):
        raise RuntimeError

    monkeypatch.setattr(Deformation, "iterate", failing)
    session.drag(BENT)
    session.until(lambda: session.failed)
    assert "RuntimeError" in session.failed[0]


def test_store_tells_of_a_failure_while_making_ready(empty, monkeypatch, capfd):
    def failing(*_):
        raise MemoryError

    monkeypatch.setattr(elastic_surface, "LinearSolver", failing)
    empty.show_now(bar())
    empty.paint_ends()
    empty.until(lambda: empty.failed)
    monkeypatch.undo()
    state = empty.store.state
    empty.drag(BENT)
    empty.settle()
    assert empty.store.activity is Activity.SETTLED
    empty.gestures.undo()
    assert empty.store.state is state


def test_handle_editor_drag_to_a_pose_that_is_not_finite_is_told_and_can_be_undone(session):
    before = session.store.state
    session.drag(np.full((4, 4), np.nan))
    session.until(lambda: session.failed)
    session.settle()
    session.gestures.undo()
    assert session.store.state is before
    session.drag(BENT)
    session.settle()
    assert session.store.activity is Activity.SETTLED


def test_listener_may_undo_when_told_of_a_failure(session, capfd, monkeypatch):
    before = session.store.state

    def failing(*_):
        raise ValueError("broken")

    session.on_failed = session.gestures.undo
    monkeypatch.setattr(Deformation, "iterate", failing)
    session.drag(BENT)
    session.until(lambda: session.failed)
    monkeypatch.undo()
    assert session.store.state is before
    session.drag(BENT)
    session.settle()
    assert session.store.activity is Activity.SETTLED


def test_listener_may_receive_when_told_of_a_change(session):
    session.on_changed = session.receive_results
    session.drag(*(pose(k / 50) for k in range(40)))
    session.settle()
    assert session.store.activity is Activity.SETTLED


# What the worker is doing


def test_activity_is_idle_after_opening_and_painting_refining_on_drag_settled_in_the_end(empty, slow):
    empty.show_now(bar())
    assert empty.store.activity is Activity.IDLE
    empty.paint_ends()
    assert empty.store.activity is Activity.IDLE
    empty.gestures.begin()
    empty.handles.drag(BENT)
    assert empty.store.activity is Activity.REFINING
    empty.gestures.end("Move handle")
    empty.settle()
    assert empty.store.activity is Activity.SETTLED
    state = empty.store.state
    assert state.frame.converged
    assert abs(state.frame.area_error) <= state.document.settings.tolerance
    assert empty.store.seconds_per_iteration > 0.0


def test_set_tolerance_keeps_the_area_to_the_tolerance_that_is_set(session):
    session.drag(pose(0.9, (1.0, 0.0, 0.5)))
    for tolerance in (0.05, 1e-2, 1e-4):
        session.settings.change(tolerance=tolerance)
        session.settle()
        assert session.store.activity is Activity.SETTLED
        assert abs(session.store.state.frame.area_error) <= tolerance


def test_activity_is_unreached_after_a_run_that_never_settles(session, monkeypatch):
    monkeypatch.setattr(Deformation, "settled", False)
    session.settings.change(convergence=Convergence(most_iterations=30))
    session.drag(BENT)
    session.settle()
    assert session.store.activity is Activity.UNREACHED
    assert session.store.state.frame.iteration == 30


@pytest.mark.parametrize("painted", [(), (BASE,), (HANDLE,)])
def test_handle_editor_drag_moves_nothing_without_base_or_handle(empty, painted):
    empty.show_now(bar())
    ids = dict(zip((BASE, HANDLE), ends(empty.store.state.document.mesh.V), strict=True))
    for label in painted:
        empty.stroke(ids[label], label)
    empty.drag(pose(0.1), BENT)
    assert empty.store.activity is Activity.IDLE
    empty.listen(0.02)
    assert empty.store.activity is Activity.IDLE
    assert empty.U is empty.store.state.document.mesh.V
    assert empty.failed == []


def test_handle_editor_drag_moves_nothing_where_everything_is_held(session):
    session.stroke(np.arange(len(session.U)), BASE)
    session.stroke(ends(session.store.state.document.mesh.V)[1], HANDLE)
    session.drag(BENT)
    session.settle()
    assert session.store.activity is Activity.IDLE
    assert session.failed == []


def test_solver_worker_sleeps_when_it_has_settled(session):
    session.drag(BENT)
    session.settle()
    (thread,) = solver_threads()
    clock = time.pthread_getcpuclockid(thread.ident)
    time.sleep(0.01)
    burned, woken = time.clock_gettime(clock), len(session.woken)
    time.sleep(0.25)
    assert time.clock_gettime(clock) - burned < 0.005
    assert len(session.woken) == woken


def test_session_verbs_without_a_mesh_say_so(empty):
    for verb in (
        empty.gestures.begin,
        empty.gestures.undo,
        empty.shapes.restore,
        lambda: empty.settings.change(method="arap"),
    ):
        with pytest.raises(RuntimeError, match="no mesh is open"):
            verb()


def test_handle_editor_drag_copies_the_pose_and_what_is_kept_is_read_only(session):
    mine = BENT.copy()
    session.drag(mine)
    mine[:] = 0.0
    assert np.array_equal(session.store.state.document.handles[0].pose, BENT)
    session.settle()
    document = session.store.state.document
    for array in (document.labels, document.initial_positions, document.handles[0].pose, session.U):
        assert not array.flags.writeable
    session.gestures.undo()
    assert not session.store.state.document.handles[0].pose.flags.writeable


def test_shape_editor_restore_brings_back_the_rest_shape_and_keeps_the_paint(session):
    labels = session.store.state.document.labels
    session.drag(BENT)
    session.settle()
    session.stroke(np.flatnonzero(session.store.state.document.mesh.V[:, 2] == 1.0), BASE)
    kept = session.store.state.document.labels
    assert kept is not labels
    session.shapes.restore()
    state = session.store.state
    assert state.frame.U is state.document.mesh.V
    assert state.document.initial_positions is state.document.mesh.V
    assert state.document.labels is kept
    assert (state.frame.area_error, state.frame.handle_drift) == (0.0, 0.0)
    undo = session.gestures.history.next_undo_name
    session.gestures.undo()
    session.gestures.redo()
    session.shapes.restore()
    assert session.gestures.history.next_undo_name == undo, "a second reset has nothing to do"


def test_set_tolerance_refuses_one_that_cannot_be_met(session):
    ready(session)
    session.settings.change(tolerance=-1.0)
    session.until(lambda: session.failed, seconds=2.0)


def test_settings_made_in_the_middle_of_a_stroke_outlive_it_when_it_paints_nothing(session):
    session.gestures.begin()
    session.settings.change(volume=95.0)
    session.painting.end_stroke("Paint")
    assert session.store.state.document.settings.volume == 95.0
    session.gestures.undo()
    assert session.store.state.document.settings.volume is None
