"""Motions in words: what they say, where they lead, and what is no motion."""

import pickle
import time

import numpy as np
import pytest
from meshes import box, ends, rotation
from motions import IN_WORDS, in_words

from apd_viewer.cases.case import case_of
from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.posing.motion_path import MotionStep, document_along_paths, motion_paths
from apd_viewer.session.posing.motion_text import motion_steps, parse_motion
from apd_viewer.session.quantities.units import Unit


@pytest.fixture(scope="module")
def state():
    """A bar along z in millimetres, its base below, one handle on top and one in the middle."""
    V, F = box(2, 2, 6)
    labels = np.ones(len(V), dtype=np.uint8)
    base, handle = ends(V)
    labels[base], labels[handle], labels[V[:, 2] == 3] = 0, 2, 3
    return initial_state(Mesh(V, F), labels)


def paths(state, text):
    for step in parse_motion(text):
        step.parse_amounts(Unit.MILLIMETRE)
    return motion_paths(state.document, motion_steps(state.document, text, Unit.MILLIMETRE))


def turned(axis, degrees, about):
    pose = np.eye(4)
    pose[:3, :3] = rotation(axis, np.radians(degrees))
    pose[:3, 3] = about - pose[:3, :3] @ about
    return pose


TOP, BOTTOM, MIDDLE = np.array([1.0, 1, 6]), np.array([1.0, 1, 0]), np.array([1.0, 1, 3])
POSES = {
    "twist 120deg": turned([0, 0, 1], 120, TOP),
    "twist 400": turned([0, 0, 1], 40, TOP),
    "bend 20deg": turned([1, 0, 0], 20, BOTTOM),
    "bend 20deg about y": turned([0, 1, 0], 20, BOTTOM),
    "turn 0.25 turn about x": turned([1, 0, 0], 90, TOP),
    "push 30%": [0, 0, -1.8],
    "push 2mm": [0, 0, -2],
    "push 0.5 X": [0, 0, -1],
    "move 0 0.2cm -1": [0, 2, -1],
    "shear 0.3 along x": np.array([[1, 0, 0.3, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]),
    "scale 1.5": np.diag([1.5, 1.5, 1.5, 1]),
}


@pytest.mark.parametrize("text", POSES)
def test_motion_paths_end_where_the_words_say(text, state):
    wanted = np.asarray(POSES[text], dtype=float)
    if wanted.shape == (3,):
        wanted = np.block([[np.eye(3), wanted[:, None]], [np.zeros((1, 3)), 1.0]])
    elif text.startswith("scale"):
        wanted[:3, 3] = TOP - 1.5 * TOP
    path, other = paths(state, text)
    np.testing.assert_allclose(path.pose_at(1.0), wanted, atol=1e-12)
    np.testing.assert_array_equal(path.pose_at(0.0), np.eye(4))
    assert not other.has_motion


def test_motion_paths_let_all_amounts_grow_together(state):
    whole, half = (paths(state, text)[0] for text in ("twist 300deg; push 40%", "twist 150deg; push 20%"))
    np.testing.assert_allclose(whole.pose_at(0.5), half.pose_at(1.0), atol=1e-12)
    assert np.degrees(whole.angle) == pytest.approx(300)


def test_motion_paths_follow_steps_in_turn_for_the_handles_that_they_name(state):
    top, middle = paths(state, "turn 90 about x; move 0 0 1; Handle 2: push 1; scale 2")
    pose = turned([1, 0, 0], 90, TOP)
    pose[2, 3] += 1
    np.testing.assert_allclose(top.pose_at(1.0), pose, atol=1e-12)
    np.testing.assert_allclose(middle.pose_at(1.0) @ [*MIDDLE, 1], [1, 1, 2, 1], atol=1e-12)


@pytest.mark.parametrize("degrees", [40, 400, -1000])
def test_motion_paths_twist_as_the_window_and_the_sweep_do(degrees, state):
    document = state.document
    step = MotionStep(0, MOTIONS["TWIST"], (np.radians(degrees),))
    pose = step.end_document(document).handles[0].pose
    path = paths(state, f"twist {degrees}")[0]
    np.testing.assert_allclose(path.pose_at(1.0), pose, atol=1e-12)
    swept = case_of(document, 3, motion=[step]).paths[0]
    assert all(np.array_equal(path.pose_at(part), swept.pose_at(part)) for part in (0.3, 1.0))
    posed = document_along_paths(document, paths(state, f"twist {degrees}"))
    assert np.degrees(posed.handles[0].rotation) == pytest.approx([0, 0, degrees], abs=1e-6)


def test_document_along_paths_makes_no_way_shorter_for_turns_of_opposite_signs(state):
    """The sum of their angles is none, and the way leads through none of the poses between."""
    motion = "turn 200deg about x; turn -200deg about y"
    posed = document_along_paths(state.document, paths(state, motion)).handles[0]
    assert posed.waypoints
    np.testing.assert_allclose(posed.pose, paths(state, motion)[0].pose_at(1.0), atol=1e-12)


def test_parse_motion_reads_steps_that_write_their_words_in_one_way():
    first, second = (
        parse_motion(text) for text in ("Twist  120deg ;; push 30%", "handle 1: twist 120deg; push 30%")
    )
    assert first == second
    assert parse_motion("; ".join(step.text for step in first)) == first


@pytest.mark.parametrize("name", IN_WORDS)
def test_parse_motion_reads_every_motion_as_it_is_written(name):
    steps = parse_motion(in_words(name))
    assert [step.motion.kind for step in steps] == [MOTIONS[name].kind]
    assert steps[0].motion.kind.has_all_axes or steps[0].motion == MOTIONS[name]
    loud = in_words(name).replace(steps[0].motion.kind.word, steps[0].motion.kind.word.upper())
    assert parse_motion(steps[0].text) == parse_motion(loud) == steps


WRONG = {
    "": "is empty",
    "wring 30": "“wring” is not a motion",
    "twist": "Nothing was entered",
    "twist 30mm": "not allowed here",
    "twist fast": "unknown",
    "twist 30 about x": "has no axis",
    "turn 30": "needs an axis",
    "turn 30 about w": "x, y or z",
    "bend 30 about w": "x, y or z",
    "move 1 2": "three lengths",
    "move 1 2 3deg": "an angle",
    "push 30deg": "an angle",
    "scale 0": "greater than 0",
    "scale 2 along x": "remove “along”",
    "shear 0.3": "as in “shear 0.3 along x”",
    "shear 0.3 about x": "needs “along” before an axis",
    "shear 0.3deg along x": "an angle",
    "shear 0.3 along z": "no height",
    "handle 0: push 1": "from 1",
    "handle 3: push 1": "no handle 3",
    "twist 40000": "at most 100 turns",
}


@pytest.mark.parametrize("text", WRONG)
def test_parse_motion_says_what_is_no_motion(text, state):
    with pytest.raises(InputError, match=WRONG[text]):
        paths(state, text)


@pytest.mark.parametrize("text", ["turn 30deg{}about{}x", "move 0 1{}2", "handle 2{}:{}twist 3"])
def test_parse_motion_takes_no_time_for_many_spaces(text):
    """A pattern that looks for the axis from each of them takes as many steps squared."""
    began = time.process_time()
    assert parse_motion(text.replace("{}", " " * 50_000)) == parse_motion(text.replace("{}", " "))
    assert time.process_time() - began < 2.0


def test_parse_amounts_needs_the_unit_of_the_mesh_for_a_length(state):
    with pytest.raises(InputError, match="unit of the mesh is not set; choose it") as refused:
        parse_motion("push 2mm")[0].parse_amounts(Unit.NONE)
    assert str(pickle.loads(pickle.dumps(refused.value))) == str(refused.value)
