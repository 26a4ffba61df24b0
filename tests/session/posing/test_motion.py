"""Motions that are typed: what they do to the pose, and that each is one step of undo."""

import numpy as np
import pytest
from driven_session import BENT, Driven, bar
from meshes import box, rotation
from motions import EVERY, IN_WORDS, in_words

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE, transform
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.posing.mirror_partner import mirror_plane
from apd_viewer.session.posing.motion import MOTIONS, AmountKind
from apd_viewer.session.posing.motion_path import MotionStep, motion_paths
from apd_viewer.session.posing.motion_text import motion_steps
from apd_viewer.session.quantities.units import Unit

AXES = {"X": [1, 0, 0], "Y": [0, 1, 0], "Z": [0, 0, 1]}
# For each kind of amount one to begin with, and a total.
AMOUNTS = {
    AmountKind.ANGLE: ("300deg", "-250deg"),
    AmountKind.LENGTH: ("0.2", "1.5"),
    AmountKind.LENGTH_OR_PERCENT: ("0.2", "40%"),
    AmountKind.FACTOR: ("80%", "1.25"),
    AmountKind.NUMBER: ("-0.4", "0.3"),
}
PICKED = np.array([[0.1, 0.3, 0.2], [1.1, 2.0, 0.4]])


def centres(session: Driven) -> tuple[np.ndarray, np.ndarray]:
    document = session.store.state.document
    base = document.initial_positions[document.labels == 0].mean(axis=0)
    gripped = document.initial_positions[document.labels == 2].mean(axis=0)
    return base, transform(document.handles[0].pose, gripped[None])[0]


def by(session: Driven) -> np.ndarray:
    """What the last motion did after the pose that was there before."""
    before = session.gestures.history.undo_states[-1].document.handles[0].pose
    return session.store.state.document.handles[0].pose @ np.linalg.inv(before)


@pytest.fixture
def oblique(empty):
    """A session with a bar whose line from base to handle is along no axis."""
    V, F = box(2, 2, 6)
    empty.show_now(Mesh(V + V[:, 2:] * [0.2, 0.1, 0.0], F))
    empty.paint_ends()
    return empty


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
    names = bent.store.state.document.mesh.named_lengths
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
    bent.settings.change(stiffness=0.01)
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
    assert bent.gestures.history.next_undo_name == "Reset handle"
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
    assert bent.gestures.history.next_undo_name == name


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


@pytest.mark.parametrize("name", EVERY)
def test_move_by_reaches_a_total_from_wherever_the_handle_is(oblique, name):
    motion = MOTIONS[name]
    first, total = AMOUNTS[motion.kind.amount]
    oblique.handles.move_by(motion, total, 0, PICKED)
    there = oblique.store.state.document.handles[0]
    oblique.gestures.undo()
    oblique.handles.move_by(motion, first, 0, PICKED)
    oblique.handles.move_by(motion, total, 0, PICKED, is_total=True)
    handle = oblique.store.state.document.handles[0]
    np.testing.assert_allclose(handle.pose, there.pose, atol=1e-9)
    np.testing.assert_allclose(handle.rotation, there.rotation, atol=1e-9)


@pytest.mark.parametrize("name", EVERY)
def test_move_by_leads_where_the_same_motion_does_in_words(oblique, name):
    state, motion = oblique.store.state, MOTIONS[name]
    oblique.handles.move_by(motion, motion.kind.example, 0, PICKED)
    pose = oblique.store.state.document.handles[0].pose
    assert np.abs(pose - np.eye(4)).max() > 0.01
    assert oblique.gestures.history.next_undo_name.startswith(f"{motion.title} ")
    if name in IN_WORDS:
        path = motion_paths(state.document, motion_steps(state.document, in_words(name), Unit.NONE))[0]
        np.testing.assert_allclose(path.pose_at(1.0), pose, atol=1e-12)
        assert path.has_motion
        assert path.has_stretch == motion.kind.stretches


@pytest.mark.parametrize("name", EVERY)
def test_symmetric_motion_stretches_just_where_the_motion_does(oblique, name):
    """What is symmetric of a stretch is kept, and none is made of turns and moves."""
    motion = MOTIONS[name]
    oblique.handles.move_by(motion, motion.kind.example, 0, PICKED)
    document, (_, pivot) = oblique.store.state.document, centres(oblique)
    pose = document.handles[0].pose
    for axis in range(3):
        kept = mirror_plane(document.mesh, axis).symmetric_motion(pose, pivot)
        for each in (pose, kept):
            strain = each[:3, :3].T @ each[:3, :3] - np.eye(3)
            assert (np.abs(strain).max() > 1e-3) == motion.kind.stretches


@pytest.mark.parametrize("letter", "XYZ")
def test_move_by_shears_along_an_axis_by_the_height_over_the_base(oblique, letter):
    (base, handle), axis, X = centres(oblique), np.array(AXES[letter]), oblique.store.state.document.mesh.V
    oblique.handles.move_by(MOTIONS[f"SHEAR_{letter}"], "0.3", 0)
    rise = np.where(axis, 0.0, handle - base)
    height = (X - base) @ rise / np.linalg.norm(rise)
    motion = by(oblique)
    np.testing.assert_allclose(transform(motion, X) - X, 0.3 * np.outer(height, axis), atol=1e-12)
    assert np.linalg.det(motion[:3, :3]) == pytest.approx(1.0, abs=1e-12)


def test_move_by_shears_along_no_line_from_the_base_to_the_handle(session):
    with pytest.raises(InputError, match="no height"):
        session.handles.move_by(MOTIONS["SHEAR_Z"], "0.3", 0)


def test_intermediate_documents_lead_to_the_end_and_only_there_by_a_stretch(oblique):
    document = oblique.store.state.document
    for motion in MOTIONS.values():
        step = MotionStep(0, motion, (0.3,), PICKED)
        *way, end = (each.handles[0].pose for each in step.intermediate_documents(document))
        np.testing.assert_allclose(end, step.pose_at(document, 1.0), atol=1e-12)
        assert bool(way) is not motion.kind.stretches
        if way:
            np.testing.assert_array_equal(way[0], np.eye(4))


def test_move_by_pushes_along_no_line_where_base_and_handle_have_one_centre():
    mesh = bar()
    z = mesh.V[:, 2]
    middle = 0.5 * (z.min() + z.max())
    labels = np.where(np.isin(z, (z.min(), z.max())), BASE, np.where(z == middle, HANDLE, FREE))
    document = initial_state(mesh, labels.astype(np.uint8)).document
    with pytest.raises(InputError, match="same centre"):
        MotionStep(0, MOTIONS["PUSH"], (1.0,)).end_document(document)
