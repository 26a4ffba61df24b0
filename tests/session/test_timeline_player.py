"""Motions played in steps by the solver's process: pressed as by the command, gone back to, and stopped."""

from dataclasses import replace

import numpy as np
import pytest
from meshes import sphere, tube

from apd_viewer.errors import InputError
from apd_viewer.geometry.contact.mesh_contact import contact_thickness
from apd_viewer.geometry.mesh.arrays import diagonal, frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.geometry.solver.pressed_mesh import press
from apd_viewer.presentation.plate_readings import rest_verdict
from apd_viewer.session.model import timeline
from apd_viewer.session.model.named_obstacle import ObstacleKind
from apd_viewer.session.model.obstacle_pair import obstacle_pair
from apd_viewer.session.obstacle_editor import Fingers
from apd_viewer.session.state_store import Activity

pytestmark = pytest.mark.usefixtures("processes")
X = np.eye(3)[0]
STIFFNESS, STEPS, TO = 0.001, 3, 1.7


@pytest.fixture
def plates(empty):
    """A tube that nothing holds between two plates that touch it."""
    empty.show_now(Mesh(*tube(12, 12)))
    empty.obstacles.add_press_plates(X)
    empty.player.begin_run()
    empty.settle()
    return empty


def play(session, to=TO, steps=STEPS):
    """Press until it is done; the readings of the plates at each step."""
    state = session.store.state
    session.player.play("Press", obstacle_pair(state.document).press_documents(state, to, steps))
    session.until(lambda: not session.player.is_playing)
    return readings(session)


def readings(session):
    states = [step.state for step in session.player.timeline.steps]
    return [obstacle_pair(state.document).reading(state) for state in states]


@pytest.fixture
def fingers(empty):
    """A ball of radius 1 between two fingers of radius 0.3, held at its lowest vertices."""
    ball = Mesh(*sphere(3))
    empty.show_now(ball)
    held = np.flatnonzero(ball.V[:, 1] < -0.9)
    empty.obstacles.add_press_plates(X, None, Fingers(0.3, held))
    empty.player.begin_run()
    empty.settle()
    return empty


def test_timeline_player_squeezes_between_fingers_that_touch_from_both_sides(fingers):
    document = fingers.store.state.document
    left, right = document.obstacles
    gap = contact_thickness(diagonal(document.mesh.V), document.settings.thickness)
    for finger, side in ((left, -1.0), (right, 1.0)):
        assert finger.place == pytest.approx([side * (1.3 + gap), 0.0, 0.0], abs=0.01)
        assert np.linalg.norm(document.mesh.V - finger.place, axis=1).min() == pytest.approx(0.3 + gap)
    held = document.labels == BASE
    assert held.any()
    assert not (document.labels >= HANDLE).any()
    found = play(fingers, to=1.6)
    assert found[0].distance == pytest.approx(2.0 + 2.0 * gap, abs=0.02)
    assert found[-1].distance == pytest.approx(1.6)
    loads = [each.load for each in found]
    assert loads == sorted(loads)
    assert loads[-1] > 0.0
    for each in found[1:]:
        assert each.load_low == pytest.approx(each.load_high, rel=0.02), "the ball is symmetric"
    U = fingers.U
    np.testing.assert_allclose(U[held], document.mesh.V[held], atol=1e-12)
    for finger in fingers.store.state.document.obstacles:
        assert np.linalg.norm(U - finger.centre, axis=1).min() > 0.3
    fingers.obstacles.add_press_plates(X)
    assert [each.kind for each in fingers.store.state.document.obstacles] == 2 * [ObstacleKind.PLATE]


def test_rest_verdict_says_where_nothing_touches_the_shape(plates):
    play(plates)
    state = plates.store.state
    assert rest_verdict(state) == ("At rest.", True)
    loose = replace(state, frame=replace(state.frame, loads=np.zeros_like(state.frame.loads)))
    assert rest_verdict(loose) == ("At rest; nothing touches it here.", True)


def test_timeline_player_presses_as_the_command_does(plates):
    state = plates.store.state
    told = press(state.document.mesh.V, state.document.mesh.F, X, TO, STEPS, stiffness=STIFFNESS)
    found = play(plates)
    assert [one.distance for one in found] == pytest.approx([step.distance for step in told.steps])
    assert [one.load for one in found][1:] == pytest.approx([step.load_low for step in told.steps[1:]], 5e-3)
    assert all(step.state.frame.settled for step in plates.player.timeline.steps)
    assert plates.store.activity is Activity.SETTLED
    assert [step.begins_run for step in plates.player.timeline.steps] == [True, False, False, False]
    assert plates.gestures.history.undo_names[-2:] == ["Put plates on both sides", "Press"]


@pytest.mark.night
def test_timeline_player_keeps_the_crushed_shape_as_the_plates_open_again(plates):
    play(plates)
    crushed, player = plates.store.state, plates.player
    pair = obstacle_pair(crushed.document)
    found = play(plates, pair.first_distance(crushed.document))
    assert player.timeline.steps[STEPS].state is crushed
    assert [step.begins_run for step in player.timeline.steps].count(True) == 1, "one run, there and back"
    assert abs(found[-1].load) < 1e-6 * found[STEPS].load, "it has sprung back"


def test_timeline_player_shows_any_step_and_makes_it_current(plates):
    play(plates)
    player, last = plates.player, plates.store.state
    steps = [step.state for step in player.timeline.steps]
    for k in (2, 0, 1):
        player.show_step(k)
        assert plates.store.state is steps[k]
        assert player.shown_step == k
    player.accept_shown_step()
    plates.settle()
    assert plates.store.state is steps[1], "it is at rest as it was"
    assert plates.gestures.history.undo_names[-1] == "Press", "the last shape is still on the timeline"
    player.show_step(STEPS)
    player.accept_shown_step()
    assert plates.store.state is last
    again = play(plates, 1.2, 1)
    assert again[-1].load > again[STEPS].load, "and the solver goes on from what is shown"


def test_timeline_player_takes_back_a_look_that_is_not_ended(plates):
    play(plates)
    last = plates.store.state
    plates.player.show_step(1)
    plates.gestures.cancel()
    assert plates.store.state is last
    plates.player.accept_shown_step()
    assert plates.store.state is last


def test_timeline_player_lets_undo_return_to_a_shape_that_is_not_on_the_timeline(plates):
    play(plates)
    plates.settings.change(stiffness=0.01)
    plates.settle()
    other = plates.store.state
    plates.player.show_step(1)
    plates.player.accept_shown_step()
    assert plates.store.state is plates.player.timeline.steps[1].state
    plates.gestures.undo()
    assert plates.store.state is other


def test_timeline_player_measures_later_regions_on_earlier_steps(plates):
    play(plates)
    before = plates.player.timeline.steps[1].state
    plates.parts.add_region()
    plates.gestures.begin()
    plates.painting.paint_region(np.arange(40), 1)
    plates.painting.end_stroke("Paint")
    member = plates.store.state.document.member
    undo = plates.gestures.history.undo_names
    plates.player.show_step(1)
    plates.player.accept_shown_step()
    state = plates.store.state
    assert state.document.member is member
    assert state.frame.U is before.frame.U
    assert state.frame.regions == state.document.region_areas(before.frame.U)
    assert plates.gestures.history.undo_names == undo


@pytest.mark.night
def test_timeline_player_goes_on_where_a_wall_gives_way_once_it_has_come_to_rest(empty):
    tall = Mesh(*tube(16, 12))
    empty.show_now(tall)
    empty.obstacles.add_press_plates(np.eye(3)[2])
    to = 0.3 * np.ptp(tall.V[:, 2])
    last = play(empty, to, 1)[-1]
    assert last.distance == pytest.approx(to)
    asked = {id(new.document) for _, new in empty.changes if new.document.is_posed}
    assert len(asked) > 1, "contact stopped the plates on the way, or this tests nothing"
    assert empty.told[1:] == []


def test_timeline_player_stops_after_its_present_step(plates):
    state = plates.store.state
    plates.player.play("Press", obstacle_pair(state.document).press_documents(state, TO, 50))
    plates.until(lambda: plates.player.done == 2)
    plates.store.pause_or_resume()
    assert plates.player.is_paused
    plates.player.stop()
    plates.until(lambda: not plates.player.is_playing)
    assert (plates.player.done, plates.player.count) == (3, 3)
    assert len(plates.player.timeline.steps) == 4


def test_timeline_player_ends_where_something_else_changes_the_document(plates):
    before = plates.store.state
    plates.player.play("Press", obstacle_pair(before.document).press_documents(before, TO, 50))
    plates.until(lambda: plates.player.done == 1)
    plates.gestures.undo()
    assert not plates.player.is_playing
    assert plates.store.state is before
    assert len(plates.player.timeline.steps) == 2, "what was solved is there"


def test_timeline_player_goes_back_in_the_middle_of_a_motion(plates):
    before = plates.store.state
    plates.player.play("Press", obstacle_pair(before.document).press_documents(before, TO, 50))
    plates.until(lambda: plates.player.done == 2)
    plates.player.show_step(1)
    assert not plates.player.is_playing
    plates.listen(0.2)
    assert plates.store.state is plates.player.timeline.steps[1].state, "no frame of the motion comes"
    plates.player.accept_shown_step()
    plates.settle()
    assert plates.player.shown_step == 1


@pytest.mark.night
def test_timeline_player_records_plates_moved_by_hand(plates):
    plates.obstacles.move(1, -0.2 * X)
    plates.until(lambda: len(plates.player.timeline.steps) == 2)
    plates.obstacles.move(1, -0.2 * X)
    plates.until(lambda: len(plates.player.timeline.steps) == 3)
    first, second, third = readings(plates)
    assert first.distance - second.distance == pytest.approx(0.2)
    assert third.load > second.load > first.load
    plates.player.show_step(1)
    plates.player.accept_shown_step()
    plates.obstacles.move(0, 0.1 * X)
    plates.until(lambda: len(plates.player.timeline.steps) == 5)
    assert [step.begins_run for step in plates.player.timeline.steps] == [True, False, False, True, False]


def test_timeline_player_forgets_steps_of_another_mesh(plates):
    play(plates, steps=1)
    assert plates.player.timeline.belongs_to(plates.store.state.document)
    plates.show_now(Mesh(*tube(8, 8)))
    assert not plates.player.timeline.belongs_to(plates.store.state.document)
    assert plates.player.shown_step is None
    plates.player.begin_run()
    assert len(plates.player.timeline.steps) == 1


def test_obstacle_pair_refuses_distances_that_plates_cannot_come_to(plates):
    state = plates.store.state
    pair = obstacle_pair(state.document)
    for distance in (0.0, 1.01 * pair.first_distance(state.document)):
        with pytest.raises(InputError, match="enter a smaller distance"):
            pair.press_documents(state, distance, 3)
    with pytest.raises(InputError, match="already"):
        pair.press_documents(state, pair.distance(state), 3)
    plates.obstacles.remove(0)
    assert obstacle_pair(plates.store.state.document) is None


def test_timeline_player_shows_each_step_of_a_run_that_begins_at_an_earlier_one(plates):
    """The first step of the second run has the shape of a step of the first."""
    play(plates)
    player = plates.player
    player.show_step(1)
    player.accept_shown_step()
    plates.settle()
    play(plates, to=1.6, steps=2)
    count = len(player.timeline.steps)
    assert player.timeline.run_of(count - 1) == range(STEPS + 1, STEPS + 4)
    for k in range(count):
        player.show_step(k)
        assert player.shown_step == k
        player.accept_shown_step()
        assert player.shown_step == k
    again, first = player.timeline.steps[STEPS + 1], player.timeline.steps[1]
    assert again.has_shape_of(first.state)
    assert player.timeline.index_of_recorded(again.state) == STEPS + 1


def test_timeline_player_stays_at_a_step_as_older_ones_are_dropped(plates, monkeypatch):
    play(plates)
    player, kept = plates.player, plates.player.timeline.steps
    player.show_step(2)
    player.accept_shown_step()
    player.shows_wall = True
    shown = plates.store.state
    by_wall = shown.updated(shown.document.with_settings(method="wall", wall_thickness=0.01))
    answer = by_wall.updated(frame=replace(shown.frame, U=frozen(1.0 * shown.frame.U), settled=True))
    monkeypatch.setattr(timeline, "MOST_BYTES", (len(kept) - 1) * shown.frame.U.nbytes)
    player.add_wall_result(2, answer)
    assert player.timeline.dropped == 2
    assert player.shown_step == 0
    assert plates.store.state.frame.U is answer.frame.U
    player.show_step(1)
    player.add_wall_result(0, answer)  # of a step that is dropped with it
