"""Motions that are typed: what they do to the pose, and that each is one step of undo."""

import numpy as np
import pytest
from driven_session import BENT, Driven, bar
from meshes import rotation

from apd_viewer.errors import InputError
from apd_viewer.geometry.pose.constraints import transform
from apd_viewer.session.posing.motion import MOTIONS, AmountKind
from apd_viewer.session.posing.motion_path import MotionStep
from apd_viewer.session.quantities.units import Unit

AXES = {"X": [1, 0, 0], "Y": [0, 1, 0], "Z": [0, 0, 1]}
FIRST = {AmountKind.ANGLE: "300deg", AmountKind.FACTOR: "80%"}


def centres(session: Driven) -> tuple[np.ndarray, np.ndarray]:
    document = session.store.state.document
    base = document.grip[document.labels == 0].mean(axis=0)
    gripped = document.grip[document.labels == 2].mean(axis=0)
    return base, transform(document.handles[0].pose, gripped[None])[0]


def by(session: Driven) -> np.ndarray:
    """What the last motion did after the pose that was there before."""
    before = session.gestures.history.undo_states[-1].document.handles[0].pose
    return session.store.state.document.handles[0].pose @ np.linalg.inv(before)


@pytest.fixture
def bent(session):
    session.drag(BENT)
    return session


@pytest.mark.parametrize("letter", "XYZ")
def test_move_by_moves_along_an_axis_by_the_length(bent, letter):
    bent.handles.move_by(MOTIONS[f"MOVE_{letter}"], "0.15L + 0.1", 0)
    expected = np.eye(4)
    expected[:3, 3] = (0.15 * max(bent.store.state.inspection.size) + 0.1) * np.array(AXES[letter])
    np.testing.assert_allclose(by(bent), expected, atol=1e-12)


@pytest.mark.parametrize("letter", "XYZ")
def test_move_by_turns_about_the_centre_and_bends_about_that_of_the_base_by_an_angle(bent, letter):
    for kind, which in (("TURN", 1), ("BEND", 0)):
        fixed = centres(bent)[which]
        bent.handles.move_by(MOTIONS[f"{kind}_{letter}"], "30deg", 0)
        motion = by(bent)
        np.testing.assert_allclose(motion[:3, :3], rotation(AXES[letter], np.pi / 6), atol=1e-12)
        np.testing.assert_allclose(transform(motion, fixed[None])[0], fixed, atol=1e-12)


def test_move_by_twists_about_the_line_between_the_centres(bent):
    base, handle = centres(bent)
    bent.handles.move_by(MOTIONS["TWIST"], "1/6 turn", 0)
    motion = by(bent)
    for point in (base, handle, 2 * handle - base):
        np.testing.assert_allclose(transform(motion, point[None])[0], point, atol=1e-11)
    assert np.trace(motion[:3, :3]) == pytest.approx(1 + 2 * np.cos(np.pi / 3), rel=1e-12)


def test_move_by_scales_about_the_centre_by_a_factor(bent):
    _, handle = centres(bent)
    bent.handles.move_by(MOTIONS["SCALE"], "80%", 0)
    np.testing.assert_allclose(by(bent)[:3, :3], 0.8 * np.eye(3), atol=1e-12)
    np.testing.assert_allclose(centres(bent)[1], handle, atol=1e-12)


def test_move_by_is_one_step_and_the_shape_follows(bent):
    before, steps = bent.store.state, len(bent.gestures.history.undo_names)
    bent.handles.move_by(MOTIONS["TWIST"], "20", 0)
    assert bent.gestures.history.undo_names[steps:] == ["Twist +20° (Handle 1)"]
    bent.settle()
    held = bent.store.state.document.constraints()
    np.testing.assert_allclose(bent.U[held.fixed], held.targets, rtol=0, atol=1e-12)
    bent.gestures.undo()
    assert bent.store.state is before


@pytest.mark.parametrize("text", ["", "60mm", "L", "1/0", "sixty"])
def test_move_by_refuses_what_is_no_angle_in_a_sentence_and_nothing_moves(bent, text):
    before = bent.store.state.document
    with pytest.raises(InputError, match=r"\.$"):
        bent.handles.move_by(MOTIONS["TWIST"], text, 0)
    assert bent.store.state.document is before


def test_plan_motion_converts_a_length_with_a_unit_to_that_of_the_mesh(bent):
    bent.store.unit = Unit.CENTIMETRE
    assert bent.handles.plan_motion(MOTIONS["MOVE_X"], "25mm", 0).amounts == pytest.approx([2.5])
    names = bent.store.state.named_lengths
    assert names["L"] == max(names["X"], names["Y"], names["Z"])
    assert names["D"] == pytest.approx(np.linalg.norm([names[side] for side in "XYZ"]), rel=1e-12)


def test_end_document_says_what_to_paint_without_a_base_or_a_handle(empty):
    empty.show_now(bar())
    with pytest.raises(InputError, match="paint it first"):
        MotionStep(0, MOTIONS["TWIST"], (1.0,)).end_document(empty.store.state.document)


def test_handle_editor_pose_makes_one_step_of_presses_that_follow_each_other(bent):
    steps = len(bent.gestures.history.undo_names)
    for _ in range(5):
        pose = bent.store.state.document.handles[0].pose.copy()
        pose[0, 3] += 0.01
        bent.handles.set_pose(pose, 0, "Nudge handle", is_repeat=True)
    assert len(bent.gestures.history.undo_names) == steps + 1
    shifted = bent.store.state.document
    bent.gestures.undo()
    assert len(bent.gestures.history.undo_names) == steps
    bent.gestures.redo()
    assert bent.store.state.document is shifted
    bent.settings.set_stiffness(0.01)
    pose[0, 3] += 0.01
    bent.handles.set_pose(pose, 0, "Nudge handle", is_repeat=True)
    assert bent.gestures.history.undo_names[steps:] == ["Nudge handle", "Change stiffness", "Nudge handle"]


def test_handle_editor_pose_makes_a_press_after_an_undo_a_step_of_its_own(bent):
    pose = bent.store.state.document.handles[0].pose.copy()
    for shift in (0.01, 0.02):
        pose[0, 3] += shift
        bent.handles.set_pose(pose, 0, "Nudge handle", is_repeat=True)
    bent.gestures.undo()
    before = bent.store.state
    bent.handles.set_pose(pose, 0, "Nudge handle", is_repeat=True)
    bent.gestures.undo()
    assert bent.store.state is before


def test_handle_editor_reset_puts_one_handle_back_and_the_paint_stays(bent):
    labels = bent.store.state.document.labels
    bent.handles.reset_handle(0)
    assert not bent.store.state.document.is_posed
    assert bent.store.state.document.labels is labels
    assert bent.gestures.history.next_undo == "Reset handle"
    steps = len(bent.gestures.history.undo_names)
    bent.handles.reset_handle(0)
    assert len(bent.gestures.history.undo_names) == steps, "it is back already"


@pytest.mark.parametrize(
    ("motion", "text", "name"),
    [
        ("MOVE_X", "-1/4", "Move along x −0.25\u00a0cm (Cap)"),
        ("MOVE_Z", "5mm", "Move along z +0.5\u00a0cm (Cap)"),
        ("TURN_Y", "-1/6 turn", "Rotate about y −60° (Cap)"),
        ("SCALE", "120%", "Scale ×1.2 (Cap)"),
    ],
)
def test_move_by_names_the_amount_and_the_handle_in_its_step(bent, motion, text, name):
    bent.store.unit = Unit.CENTIMETRE
    bent.parts.rename_handle(0, "Cap")
    bent.handles.move_by(MOTIONS[motion], text, 0)
    assert bent.gestures.history.next_undo == name


def test_go_to_step_leads_to_the_very_states_that_were_there(bent):
    states = [bent.store.state]
    start = len(bent.gestures.history.undo_names)
    for angle in (5, 10, 15):
        bent.handles.move_by(MOTIONS["TWIST"], f"{angle}", 0)
        bent.settle()
        states.append(bent.store.state)
    for steps in (1, 3, 0, 2, 2, 3, 0):
        bent.gestures.go_to_step(start + steps)
        assert bent.store.state is states[steps]
        names = [f"Twist +{angle}° (Handle 1)" for angle in (5, 10, 15)]
        assert bent.gestures.history.undo_names[start:] == names[:steps]
        assert bent.gestures.history.redo_names == names[steps:]


@pytest.mark.parametrize(
    ("motion", "total"),
    [
        ("TWIST", "30deg"),
        ("TURN_Y", "-250deg"),
        ("MOVE_Z", "1.5"),
        ("PUSH", "40%"),
        ("SCALE", "1.25"),
        ("BEND_X", "20deg"),
    ],
)
def test_move_by_reaches_a_total_from_wherever_the_handle_is(session, motion, total):
    session.handles.move_by(MOTIONS[motion], total, 0)
    there = session.store.state.document.handles[0]
    session.gestures.undo()
    session.handles.move_by(MOTIONS[motion], FIRST.get(MOTIONS[motion].kind.amount, "0.2"), 0)
    session.handles.move_by(MOTIONS[motion], total, 0, is_total=True)
    handle = session.store.state.document.handles[0]
    np.testing.assert_allclose(handle.pose, there.pose, atol=1e-9)
    np.testing.assert_allclose(handle.rotation, there.rotation, atol=1e-9)
