"""Timelines in session files: every step comes back bit for bit, and what is damaged is refused."""

import json
import zipfile

import numpy as np
import pytest
from driven_session import VIEW, Driven, check_equal
from meshes import box, tube

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.obstacle_pair import obstacle_pair
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.storage import timeline_json
from apd_viewer.session.storage.session_file import open_session, open_session_file, save_session

pytestmark = pytest.mark.usefixtures("processes")


def played(session, count=3):
    """A bar that was twisted in steps; the states of its timeline."""
    step = session.handles.plan_motion(MOTIONS["TWIST"], "60deg", 0)
    session.handles.play_motion(step, count, session.player)
    session.until(lambda: not session.player.is_playing)
    return [step.state for step in session.player.timeline.steps]


def saved(session, path):
    """The session in a file."""
    session.files.save(path, VIEW, embed=True)
    session.settle()
    return path


@pytest.fixture
def reopened(tmp_path):
    """Factory of other sessions with a file open."""
    sessions = []

    def reopen(path):
        sessions.append(Driven())
        sessions[-1].files.open(path)
        sessions[-1].settle()
        return sessions[-1]

    yield reopen
    for session in sessions:
        session.close()


def test_saved_timeline_comes_back_to_the_bit(session, reopened, tmp_path):
    states = played(session)
    session.player.show_step(1)
    session.player.accept_shown_step()
    path = saved(session, tmp_path / "a.apd")
    again = reopened(path)
    steps = again.player.timeline.steps
    assert [step.begins_run for step in steps] == [True, False, False, False]
    for step, state in zip(steps, states, strict=True):
        check_equal(step.state, state)
    assert again.player.shown_step == 1
    assert again.store.state is steps[1].state
    assert not again.saved_work.is_unsaved
    again.player.show_step(3)
    again.player.accept_shown_step()
    assert np.array_equal(again.U, states[3].frame.U)
    assert again.gestures.history.undo_names == [], "the other step is on the timeline"


@pytest.mark.night
def test_saved_timeline_of_a_press_keeps_its_loads_and_goes_on(empty, reopened, tmp_path):
    empty.show_now(Mesh(*box(2, 2, 2)))
    empty.obstacles.add_press_plates(np.eye(3)[0])
    empty.player.begin_run()
    state = empty.store.state
    empty.player.play("Press", obstacle_pair(state.document).press_documents(state, 1.9, 2))
    empty.until(lambda: not empty.player.is_playing)
    readings = [
        obstacle_pair(step.state.document).reading(step.state) for step in empty.player.timeline.steps
    ]
    again = reopened(saved(empty, tmp_path / "a.apd"))
    steps = again.player.timeline.steps
    assert [obstacle_pair(step.state.document).reading(step.state) for step in steps] == readings
    again.settings.change(stiffness=0.02)
    again.settle()
    assert again.player.timeline.steps is steps, "no plate was moved"
    again.obstacles.move(1, -0.05 * np.eye(3)[0])
    again.until(lambda: len(again.player.timeline.steps) > len(steps))


WALL = {"method": "wall", "wall_thickness": 0.02, "poisson": 0.38}


@pytest.fixture
def walled(empty):
    """A tube pressed in two steps, and its wall solved at each."""
    empty.show_now(Mesh(*tube(8, 8)))
    empty.obstacles.add_press_plates(np.eye(3)[0])
    empty.player.begin_run()
    state = empty.store.state
    empty.player.play("Press", obstacle_pair(state.document).press_documents(state, 1.6, 2))
    empty.until(lambda: not empty.player.is_playing)
    empty.wall_run.begin(2, WALL)
    empty.until(lambda: not empty.wall_run.is_running)
    return empty


@pytest.mark.parametrize(("k", "shows_wall"), [(2, True), (1, False)])
def test_saved_timeline_opens_on_the_shape_of_the_wall_that_was_shown(
    walled, reopened, tmp_path, shows_wall, k
):
    player = walled.player
    player.choose_wall_results(shows_wall)
    player.show_step(k)
    player.accept_shown_step()
    shown = walled.store.state
    assert shown.document.settings.traits.is_wall is shows_wall
    path = saved(walled, tmp_path / "a.apd")
    again = reopened(path)
    check_equal(again.store.state, shown)
    assert (again.player.shown_step, again.player.shows_wall) == (k, shows_wall)
    for step, other in zip(player.timeline.steps, again.player.timeline.steps, strict=True):
        check_equal(other.state, step.state)
        check_equal(other.wall_result, step.wall_result)
    assert again.player.timeline.steps_without_wall_result(0, WALL) == [], "nothing is solved again"
    again.player.choose_wall_results(not shows_wall)
    assert again.store.state is not shown
    assert again.player.shown_step == k
    check_equal(open_session(path)[0], shown)


def test_saved_timeline_of_sessions_before_wall_results_were_kept_opens_on_the_wall(
    walled, reopened, tmp_path
):
    """Such a session has the shape of the wall, and names the step of the press as the one shown."""
    walled.player.choose_wall_results(True)
    shown = walled.store.state
    path = saved(walled, tmp_path / "a.apd")

    def as_before(said, members):
        said["shown"] = said.pop("shown_wall")
        for row in said["steps"]:
            row.pop("wall")
        del said["wall_documents"]

    changed(path, as_before)
    again = reopened(path)
    check_equal(again.store.state, shown)
    assert again.player.timeline.steps[2].wall_result is again.store.state
    assert [step.wall_result is None for step in again.player.timeline.steps] == [True, True, False]
    assert again.player.shows_wall


def test_saved_timeline_says_nothing_new_to_programs_without_wall_results(walled, tmp_path):
    """They show the step ``shown`` instead of the shape of the session."""
    walled.player.choose_wall_results(True)
    with zipfile.ZipFile(saved(walled, tmp_path / "a.apd")) as archive:
        timeline = json.loads(archive.read("session.json"))["timeline"]
    assert timeline["shown"] is None
    assert max(row["document"] for row in timeline["steps"]) < len(timeline["documents"])


def test_saved_timeline_counts_the_shapes_of_the_wall_among_its_bytes(
    walled, reopened, tmp_path, monkeypatch
):
    monkeypatch.setattr(timeline_json, "MOST_BYTES", 8 * walled.U.nbytes)
    path = saved(walled, tmp_path / "a.apd")
    assert walled.told[-1].endswith("It leaves out the first step of the timeline.")
    steps = reopened(path).player.timeline.steps
    for step, other in zip(walled.player.timeline.steps[1:], steps, strict=True):
        assert np.array_equal(other.wall_result.frame.U, step.wall_result.frame.U)


def test_saved_timeline_has_the_regions_of_the_session_on_every_step(session, reopened, tmp_path):
    played(session, 2)
    session.parts.add_region()
    session.gestures.begin()
    session.painting.paint_region(np.arange(30), 1)
    session.painting.end_stroke("Paint")
    again = reopened(saved(session, tmp_path / "a.apd"))
    member = again.store.state.document.member
    assert member.any()
    assert again.player.shown_step == 2
    again.player.show_step(0)
    assert again.store.state.document.member is member
    assert again.store.state.frame.regions == again.store.state.document.region_areas(again.U)


def test_saved_timeline_is_left_out_by_those_that_ask_for_the_shape_alone(session, tmp_path):
    """As programs without a timeline do, which ignore it."""
    states = played(session, 2)
    path = saved(session, tmp_path / "a.apd")
    state, _ = open_session(path)
    assert np.array_equal(state.frame.U, states[-1].frame.U)
    save_session(tmp_path / "b.apd", session.store.state, VIEW, embed=True)
    assert not open_session_file(tmp_path / "b.apd").timeline.steps


def test_saved_timeline_is_bounded_and_of_one_rest_shape(session, reopened, tmp_path, monkeypatch):
    states = played(session, 5)
    monkeypatch.setattr(timeline_json, "MOST_BYTES", 2 * 3 * session.U.nbytes)
    path = saved(session, tmp_path / "a.apd")
    assert session.told[-1].endswith("It leaves out 3 steps of the timeline.")
    timeline = reopened(path).player.timeline
    steps = timeline.steps
    assert timeline.dropped == 3
    assert [step.state.frame.U.tolist() for step in steps] == [each.frame.U.tolist() for each in states[3:]]
    session.shapes.bake()
    session.settle()
    again = reopened(saved(session, tmp_path / "b.apd"))
    assert not again.player.timeline.steps, "all steps are of the rest shape before"
    session.player.begin_run()
    again = reopened(saved(session, tmp_path / "c.apd"))
    assert not again.player.timeline.steps, "nothing has come of it yet"


def changed(path, change):
    """A session with another timeline in its file."""
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    said = json.loads(members["session.json"])
    change(said["timeline"], members)
    members["session.json"] = json.dumps(said).encode()
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)


@pytest.mark.parametrize(
    "change",
    [
        lambda said, _: said.update(shown=99),
        lambda said, _: said.update(dropped=-1),
        lambda said, _: said["steps"][1].update(document=9),
        lambda said, _: said["steps"][1].update(shape="labels"),
        lambda said, _: said["steps"][1].update(shape="../a"),
        lambda said, _: said["steps"][1].pop("frame"),
        lambda said, _: said["documents"][1].update(labels="shape"),
        lambda said, _: said["documents"][1].pop("handles"),
        lambda said, _: said.update(shown=None, shown_wall=99),
        lambda said, _: said["steps"][1].update(wall={"document": 0, "shape": "shape"}),
        lambda said, _: said["steps"][1].update(wall=said["steps"][1] | {"document": 99}),
        lambda said, members: members.pop(f"{said['steps'][1]['shape']}.npy"),
        lambda said, members: members.update({f"{said['steps'][1]['shape']}.npy": b"x"}),
    ],
)
def test_saved_timeline_that_is_damaged_is_refused(session, tmp_path, change):
    played(session, 2)
    path = saved(session, tmp_path / "a.apd")
    changed(path, change)
    with pytest.raises(InputError, match="is not a valid session"):
        open_session_file(path)
    assert open_session(path)[0].document.is_posed, "the shape alone is there"
