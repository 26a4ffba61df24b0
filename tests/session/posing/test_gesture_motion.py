"""The motion of a gesture: from where it began to where it ended, and nothing of what was before."""

from dataclasses import replace

import numpy as np
import pytest
from meshes import box, ends

from apd_viewer.cases.case import case_of, case_steps
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.transforms import rotation_about
from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.posing.initial_positions import gesture_motion

V, F = box(2, 2, 5)
AXIS = [0.0, 0.0, 1.0]


def turned(document, degrees, step=30):
    """The document with its handle turned on to an angle, as by the ring: in steps."""
    start = round(np.degrees(document.handles[0].rotation[2]))
    step = step if degrees > start else -step
    for angle in range(start + step, degrees + np.sign(step), step):
        document = document.with_handle_moved(0, rotation_about([1, 1, 0], AXIS, np.deg2rad(angle)))
    return document.with_handle_moved(0, rotation_about([1, 1, 0], AXIS, np.deg2rad(degrees)))


def shown(state, document):
    """The state with a document whose held vertices are where they belong, the others bent by sines."""
    held = document.constraints()
    U = V + 0.1 * np.sin(V)
    U[held.fixed] = held.targets
    return replace(state, document=document, frame=replace(state.frame, U=frozen(U)))


@pytest.fixture
def state():
    base, handle = ends(V)
    labels = np.ones(len(V), dtype=np.uint8)
    labels[base], labels[handle] = 0, 2
    return initial_state(Mesh(V, F), frozen(labels))


@pytest.mark.parametrize("step", [10, 30, 70])
@pytest.mark.parametrize(
    ("first", "second"), [(0, 60), (90, 150), (30, 390), (210, 570), (400, 100), (300, -300)]
)
def test_gesture_motion_leads_from_the_shape_before_to_the_pose_after(first, second, step, state):
    before = shown(state, turned(state.document, first, step))
    after = turned(before.document, second, step)
    motion = gesture_motion(before, after)
    assert motion.initial_positions is before.frame.U
    assert motion.mesh is after.mesh
    np.testing.assert_allclose(motion.constraints().targets, after.constraints().targets, atol=1e-12)
    made = motion.handles[0].rotation
    np.testing.assert_allclose(np.degrees(made), [0, 0, second - first], atol=1e-6)


def test_gesture_motion_begins_with_the_shape_before_when_swept(state):
    before = shown(state, turned(state.document, 90))
    motion = gesture_motion(before, turned(before.document, 150))
    first, *_, last = case_steps(case_of(motion.with_settings(method="exact"), 2, iterations=1))
    held = before.document.constraints()
    np.testing.assert_allclose(first.frame.U[held.fixed], held.targets, atol=1e-9)
    assert first.degrees == 0.0
    assert last.degrees == pytest.approx(60.0)


def test_gesture_motion_is_none_for_what_is_no_motion_of_handles_alone(state):
    before = shown(state, turned(state.document, 60))
    document = before.document
    moved = turned(document, 120)
    assert gesture_motion(before, moved) is not None
    assert gesture_motion(before, document) is None
    assert gesture_motion(before, document.with_settings(stiffness=0.1)) is None
    assert gesture_motion(before, moved.with_label(np.array([0]), 1)) is None
    assert gesture_motion(before, replace(moved, initial_positions=frozen(V.copy()))) is None
    pushed = NamedObstacle("Ball", ObstacleKind.SPHERE, np.full(3, 9.0), radius=1.0, shift=np.ones(3))
    assert gesture_motion(before, replace(moved, obstacles=(pushed,))) is None
