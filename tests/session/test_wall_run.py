"""The method Wall behind a motion in steps: as the press by that method, stopped, gone on with and ended."""

from dataclasses import replace

import numpy as np
import pytest
from meshes import sphere, tube

from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.geometry.energy.wall_map import wall_map_of
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.solver.convergence import Convergence
from apd_viewer.geometry.solver.pressed_mesh import press
from apd_viewer.session import wall_run
from apd_viewer.session.model.obstacle_pair import obstacle_pair
from apd_viewer.session.model.state import shape_frame
from apd_viewer.session.processes.request_and_reply import Reply

pytestmark = pytest.mark.usefixtures("processes")
X = np.eye(3)[0]
STEPS, TO = 3, 1.4
WALL = {"method": "wall", "wall_thickness": 0.02, "poisson": 0.38}


@pytest.fixture
def pressed(empty):
    """A tube that two plates have pressed in steps by the method Exact."""
    return press_in_view(empty, tube(12, 12), TO, STEPS)


def press_in_view(session, mesh, to, count):
    """The session with a mesh that was pressed along x."""
    session.show_now(Mesh(*mesh))
    session.obstacles.add_press_plates(X)
    session.player.begin_run()
    session.settle()
    go(session, to, count)
    return session


def go(session, to, steps):
    """Move the plates in steps until it is done."""
    state = session.store.state
    session.player.play("Press", obstacle_pair(state.document).press_documents(state, to, steps))
    session.until(lambda: not session.player.is_playing)


def solve(session, k=-1, wall=WALL):
    """Solve the wall of the run of a step until it is done."""
    session.wall_run.begin(k % len(steps(session)), wall)
    session.until(lambda: not session.wall_run.is_running)


def steps(session):
    return session.player.timeline.steps


def answers(session):
    return [step.wall_result for step in steps(session)]


def readings(states):
    return [obstacle_pair(state.document).reading(state) for state in states]


@pytest.mark.parametrize("most", [pytest.param(0.06, marks=pytest.mark.night), 0.09])
def test_wall_run_presses_as_the_command_does_by_the_method_wall(empty, most):
    """Of one thickness, and of one that grows along an axis.

    A flat ball stays where it is between the plates. A round one of triangles rolls until its width is least,
    and rounding, which differs between processors, decides to which of several places.
    """
    V, F = sphere(2)
    ball = V * [0.6, 1.0, 1.0], F
    thickness = wall_map_of(np.interp(ball[0][:, 0], [-0.6, 0.6], [0.06, most]), *ball)
    press_in_view(empty, ball, 1.1, 2)
    shown, undo = empty.store.state, empty.gestures.history.undo_names
    first = [step.state for step in steps(empty)]
    wall = WALL | {"wall_thickness": thickness, "convergence": Convergence(energy_tolerance=1e-10)}
    solve(empty, wall=wall)
    told = press(*ball, X, 1.1, 2, **wall).steps
    found = readings(answers(empty))
    assert [one.distance for one in found] == pytest.approx([step.distance for step in told])
    assert [one.load for one in found] == pytest.approx([step.load_low for step in told], 1e-4, 1e-9)
    volumes = [answer.frame.volume for answer in answers(empty)]
    assert volumes == pytest.approx([step.volume for step in told], 1e-6)
    assert [step.state for step in steps(empty)] == first, "the first answers stay"
    assert empty.store.state is shown
    assert empty.gestures.history.undo_names == undo


def test_wall_run_shows_its_shapes_on_the_timeline_without_a_step_of_undo(pressed):
    solve(pressed)
    player, undo = pressed.player, pressed.gestures.history.undo_names
    player.choose_wall_results(True)
    assert pressed.store.state is answers(pressed)[STEPS]
    player.show_step(1)
    player.accept_shown_step()
    assert (pressed.store.state, player.shown_step) == (answers(pressed)[1], 1)
    pressed.listen(0.1)
    assert pressed.store.state is answers(pressed)[1], "it is at rest as it was"
    player.choose_wall_results(False)
    assert pressed.store.state is steps(pressed)[1].state
    assert pressed.gestures.history.undo_names == undo
    player.choose_wall_results(True)
    pressed.gestures.undo()
    assert (player.shown_step, player.shows_wall) == (0, False), "undo has gone back to before the press"


@pytest.mark.night
def test_wall_run_displays_its_answer_where_it_was_chosen_before_it_came(pressed):
    player, run, undo = pressed.player, pressed.wall_run, pressed.gestures.history.undo_names
    first = pressed.store.state
    run.begin(STEPS, WALL)
    player.choose_wall_results(True)
    assert pressed.store.state is first, "the wall is not solved there"
    pressed.until(lambda: run.done == STEPS - 1)
    assert (pressed.store.state, player.shows_wall) == (first, True)
    pressed.until(lambda: not run.is_running)
    assert (pressed.store.state, player.shows_wall) == (answers(pressed)[STEPS], True)
    assert pressed.gestures.history.undo_names == undo
    pressed.show_now(Mesh(*tube(8, 8)))
    pressed.player.begin_run()
    assert not player.shows_wall, "of the other mesh no wall is known"


@pytest.mark.night
def test_wall_run_displays_its_answer_once_the_slider_is_let_go(pressed):
    player = pressed.player
    player.choose_wall_results(True)
    player.show_step(2)
    solve(pressed)
    assert pressed.store.state is steps(pressed)[2].state, "it is in the hand"
    player.accept_shown_step()
    assert (pressed.store.state, player.shows_wall) == (answers(pressed)[2], True)


@pytest.mark.night
def test_wall_run_does_not_solve_in_the_view_what_does_not_come_to_rest(pressed):
    shown = pressed.store.state
    pressed.player.choose_wall_results(True)
    solve(pressed, wall=WALL | {"convergence": Convergence(most_iterations=1)})
    assert pressed.store.state is shown
    assert pressed.player.shows_wall


def test_wall_run_that_is_stopped_keeps_what_has_come_and_goes_on_from_there(pressed):
    run, told = pressed.wall_run, list(pressed.told)
    run.begin(STEPS, WALL)
    pressed.until(lambda: run.done == 1)
    assert run.count == STEPS
    run.stop()
    assert pressed.told == told
    known = answers(pressed)
    assert [each is None for each in known] == [False, False, True, True]
    pressed.listen(0.2)
    assert answers(pressed) == known, "nothing comes any more"
    solve(pressed)
    assert answers(pressed)[:2] == known[:2]
    mesh = pressed.store.state.document.mesh
    last = press(mesh.V, mesh.F, X, TO, STEPS, **WALL).steps[-1]
    assert readings(answers(pressed))[-1].load == pytest.approx(last.load_low, 0.02)


@pytest.mark.night
def test_wall_run_follows_the_plates_as_they_open_and_into_another_run(pressed):
    solve(pressed)
    go(pressed, obstacle_pair(pressed.store.state.document).first_distance(pressed.store.state.document), 2)
    solve(pressed)
    loads = [one.load for one in readings(answers(pressed))]
    assert abs(loads[-1]) < 1e-6 * loads[STEPS], "it has sprung back"
    pressed.player.show_step(1)
    pressed.player.accept_shown_step()
    go(pressed, 1.6, 1)
    assert [step.begins_run for step in steps(pressed)[-2:]] == [True, False]
    assert answers(pressed)[-2] is answers(pressed)[1], "the run begins with what is known"
    before = answers(pressed)[:-1]
    solve(pressed)
    assert answers(pressed)[:-1] == before
    assert answers(pressed)[-1].frame.settled


def test_wall_run_marks_what_does_not_come_to_rest(pressed):
    few = WALL | {"convergence": Convergence(most_iterations=1)}
    solve(pressed, wall=few)
    assert [each.frame.settled for each in answers(pressed)[1:]] == [False] * STEPS
    assert all(step.state.frame.settled for step in steps(pressed))
    timeline = pressed.player.timeline
    assert timeline.steps_without_wall_result(0, few) == []
    assert timeline.steps_without_wall_result(0, WALL) == [0, 1, 2, 3], "of another wall nothing is known"


def test_wall_run_ends_with_its_mesh_and_with_its_steps(pressed):
    run = pressed.wall_run
    run.begin(STEPS, WALL)
    pressed.until(lambda: run.done == 1)
    pressed.show_now(Mesh(*tube(8, 8)))
    assert not run.is_running
    assert "Another mesh is open: the wall is solved no further." in pressed.told
    pressed.gestures.undo()
    run.begin(STEPS, WALL)
    pressed.player.clear()
    pressed.receive_results()
    assert not run.is_running


def test_wall_run_tells_why_a_wall_cannot_be_solved(pressed):
    solve(pressed, wall=WALL | {"wall_thickness": 10.0})
    assert pressed.failed[-1].startswith("A wall is thin")
    assert answers(pressed)[1:] == [None] * STEPS


@pytest.mark.night
def test_wall_run_waits_while_a_motion_is_played_and_takes_its_steps_up(pressed, processes):
    run = pressed.wall_run
    run.begin(STEPS, WALL)
    pressed.until(lambda: run.done == 1)
    go(pressed, 1.2, 2)
    assert run.done <= 2, "one may have come just before"
    run.begin(len(steps(pressed)) - 1, WALL)
    assert len(processes) == 2, "the solver of the view, and one of the wall"
    assert run.count == STEPS + 2
    pressed.until(lambda: not run.is_running)
    assert all(each.frame.settled for each in answers(pressed))


class Stopping:
    """A solver at rest at once, that contact stops half way so many times."""

    def __init__(self, times):
        self.times, self.asked = times, []

    def __call__(self, _wake):
        return self

    def put_request(self, request):
        self.asked.append(request)

    def take_reply(self):
        request = self.asked[-1]
        shifts = np.array([each.shift for each in request.document.obstacles])
        is_stopped = self.times > 0 and not np.array_equal(shifts, request.shifts)
        if is_stopped:
            self.times, shifts = self.times - 1, 0.5 * (shifts + request.shifts)
        share = 0.5 if is_stopped else 1.0
        frame = shape_frame(request.document.mesh, inspect(request.document.mesh), request.U)
        return Reply(request, replace(frame, shifts=shifts, share_reached=share), finished=True)

    def close(self):
        pass


@pytest.mark.parametrize("times", [2, pytest.param(1000, marks=pytest.mark.night)])
def test_wall_run_goes_on_where_contact_stopped_it_until_it_gets_no_farther(pressed, monkeypatch, times):
    solver = Stopping(times)
    monkeypatch.setattr(wall_run, "SolverWorker", solver)
    solve(pressed)
    shares = [answer and answer.frame.share_reached for answer in answers(pressed)]
    told = "Contact lets the wall come no farther." in pressed.told
    if times == 2:
        assert (shares, told) == ([1.0] * 4, False)
        assert len(solver.asked) == STEPS + 2 * times, "to rest where it was stopped, and on from there"
    else:
        assert (shares, told) == ([1.0, 0.5, None, None], True)
