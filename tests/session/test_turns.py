"""Turns beyond half: by hand, typed, repeated, undone, saved, replayed and swept."""

import numpy as np
import pytest
from driven_session import Driven
from meshes import tube

from apd_viewer.cases.case import case_of, case_steps
from apd_viewer.commands.replay_command import replay_session
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.geometry.pose.transforms import twist
from apd_viewer.presentation import readings
from apd_viewer.session.model.view import View
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.storage.session_file import open_session, save_session


@pytest.fixture(params=["tube", pytest.param("bottle", marks=pytest.mark.night)])
def wall(empty: Driven, request) -> Driven:
    """A tube or the sample bottle, painted; without contact, in which turns of the bottle take minutes."""
    if request.param == "tube":
        empty.show_now(Mesh(*tube(12, 16)))
        empty.paint_ends()
    else:
        empty.files.open_sample("bottle")
        empty.until(lambda: empty.jobs.current is None and empty.store.state is not None)
    empty.settings.set_contact(False)
    empty.settle()
    return empty


def twisted(session: Driven, degrees: float) -> np.ndarray:
    """Pose of the handle after a twist from its initial position, as the ring makes it."""
    document = session.store.state.document
    base, handle = (
        document.initial_positions[document.labels == code].mean(axis=0) for code in (BASE, HANDLE)
    )
    return twist(base, handle, np.deg2rad(degrees))


def reading(session: Driven) -> str:
    return readings.motion(session.store.state, 0, Unit.NONE).split(" ")[-1]


def diagonal(session: Driven) -> float:
    return float(np.linalg.norm(np.ptp(session.store.state.document.mesh.V, axis=0)))


def test_handle_editor_turned_by_hand_typed_and_repeated_end_in_the_same_shape_and_reading(wall, tmp_path):
    at_rest = wall.store.state
    wall.drag(*(twisted(wall, angle) for angle in range(5, 401, 5)))
    assert wall.wait_idle(120)
    assert reading(wall) == "+400.0°"
    by_hand = wall.U
    wall.gestures.undo()
    assert wall.store.state is at_rest

    wall.handles.move_by(MOTIONS["TWIST"], "400deg", 0)
    assert wall.wait_idle(120)
    assert reading(wall) == "+400.0°"
    typed = wall.U
    assert np.abs(typed - by_hand).max() <= 1e-6 * diagonal(wall)

    path = tmp_path / "wound.apd"
    save_session(path, wall.store.state, View(), embed=True)
    opened, _ = open_session(path)
    assert np.rad2deg(np.linalg.norm(opened.document.handles[0].rotation)) == pytest.approx(400.0)
    assert np.array_equal(replay_session(path)[1].U, typed)
    again = replay_session(path, from_rest=True)[1].U
    assert np.abs(again - typed).max() <= 1e-6 * diagonal(wall)

    wall.gestures.undo()
    assert wall.store.state is at_rest
    for angle in ("160", "160", "80"):
        wall.handles.move_by(MOTIONS["TWIST"], angle, 0)
    assert wall.wait_idle(120)
    assert reading(wall) == "+400.0°"
    assert np.abs(wall.U - typed).max() <= 1e-3 * diagonal(wall), "other digits, other wrinkles"


@pytest.mark.parametrize(
    ("steps", "total"), [((120, 60, 60), "+240.0°"), ((-200, -111.2), "−311.2°"), ((400, -400), "rest")]
)
def test_readings_give_the_total_its_sign(session, steps, total):
    for degrees in steps:
        session.handles.move_by(MOTIONS["TWIST"], f"{degrees}deg", 0)
    assert reading(session) == total


def test_move_by_a_turn_and_its_opposite_leaves_the_rest_shape(session):
    session.settings.set_contact(False)
    rest = session.store.state.document.mesh.V
    session.handles.move_by(MOTIONS["TWIST"], "300", 0)
    session.settle()
    session.handles.move_by(MOTIONS["TWIST"], "-300", 0)
    session.settle()
    assert not session.store.state.document.has_half_turn
    np.testing.assert_allclose(session.U, rest, atol=1e-3)


def test_handle_editor_reset_forgets_the_turns(session):
    session.handles.move_by(MOTIONS["TWIST"], "1 turn", 0)
    assert reading(session) == "+360.0°"
    assert session.gestures.history.undo_names[-1] == "Twist +360° (Handle 1)"
    session.handles.reset_handle(0)
    assert reading(session) == "rest"
    assert session.store.state.document.handles[0].waypoints == ()


def test_walk_arrives_as_well_when_something_else_is_asked_in_its_middle(session):
    session.settings.set_contact(False)
    session.handles.move_by(MOTIONS["TWIST"], "400", 0)
    session.settings.change(stiffness=1e-3)
    session.settle()
    state = session.store.state
    held = state.document.constraints()
    np.testing.assert_allclose(session.U[held.fixed], held.targets, atol=1e-12)
    assert state.frame.converged


def test_case_steps_goes_around_twice(session):
    session.settings.set_contact(False)
    session.handles.move_by(MOTIONS["TWIST"], "720", 0)
    case = case_of(session.store.state.document.with_settings(method="exact"), 16, iterations=20)
    assert case.abscissa == "degrees"
    steps = list(case_steps(case))
    assert [step.degrees for step in steps] == pytest.approx(np.linspace(0, 720, 17))
    held = case.document.mesh.V[case.document.labels == HANDLE]
    for step in (steps[8], steps[16]):
        np.testing.assert_allclose(step.frame.U[case.document.labels == HANDLE], held, atol=1e-9)


@pytest.mark.parametrize("contact", [True, False])
def test_move_by_tells_of_walls_that_pass_unless_kept_apart(wall, contact):
    wall.settings.set_contact(contact)
    wall.settle()
    wall.handles.move_by(MOTIONS["TWIST"], "200deg", 0)
    assert any("unwind" in text for text in wall.told) is not contact


def test_case_steps_of_half_a_turn_has_its_way(session):
    session.handles.move_by(MOTIONS["TWIST"], "-180", 0)
    assert reading(session) == "−180.0°"
    document = session.store.state.document.with_settings(method="arap")
    steps = list(case_steps(case_of(document, 2, iterations=5)))
    assert steps[1].degrees == pytest.approx(90.0)


def test_move_by_refuses_more_turns_than_anyone_means(session):
    before = session.store.state
    with pytest.raises(Exception, match="at most 100 turns"):
        session.handles.move_by(MOTIONS["TWIST"], "101 turn", 0)
    assert session.store.state is before
