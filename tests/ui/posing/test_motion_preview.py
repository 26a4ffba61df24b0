"""The ghost of a typed motion: where Enter would put the handle, and gone without a trace."""

import numpy as np
import pytest
from meshes import rotation
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from apd_viewer.geometry.pose.constraints import BASE, HANDLE, transform
from apd_viewer.geometry.pose.transforms import rotation_about, translation
from apd_viewer.ui.posing.motion_ghost import motion_trace


def choose(window, motion):
    field = window.panel.handles.motion
    field.choice.setCurrentIndex(field.choice.findData(motion))


def retype(window, text):
    """Type into the field for amounts as it stands, in place of its text."""
    amount = window.panel.handles.motion.amount
    amount.selectAll()
    QTest.keyClick(amount, Qt.Key.Key_Delete)
    QTest.keyClicks(amount, text)


@pytest.fixture
def typing(qtbot, bottle):
    """The bottle with the keys in the field for amounts."""
    bottle.shell.activateWindow()
    qtbot.waitUntil(bottle.shell.isActiveWindow)
    bottle.actions_.pose.enter_motion.trigger()
    return bottle


def gripped(window):
    document = window.session.store.state.document
    return document.initial_positions[document.labels == HANDLE]


def test_motion_ghost_is_where_enter_puts_the_handle(typing):
    field, ghost, gestures = typing.panel.handles.motion, typing.motion_preview.ghost, typing.session.gestures
    for motion, text in [("TWIST", "60deg"), ("TWIST", "400deg"), ("MOVE_X", "0.15L"), ("SCALE", "1.3")]:
        choose(typing, motion)
        typing.actions_.pose.enter_motion.trigger()
        before = typing.session.store.state
        retype(typing, text)
        assert typing.session.store.state is before, "nothing else changes"
        shown = ghost.patches.vertices
        QTest.keyClick(field.amount, Qt.Key.Key_Return)
        pose = typing.session.store.state.document.handles[0].pose
        np.testing.assert_allclose(shown, transform(pose, gripped(typing)), rtol=0, atol=1e-9)
        assert not len(ghost.patches.vertices)
        assert not ghost.traces
        gestures.undo()


def test_motion_ghost_goes_the_rest_of_the_way_to_a_total(typing):
    typing.session.handles.move_by(typing.panel.handles.motion.motion, "60deg", 0)
    field = typing.panel.handles.motion
    field.relation.setCurrentIndex(field.relation.findData(True))
    typing.actions_.pose.enter_motion.trigger()
    retype(typing, "0")
    np.testing.assert_allclose(
        typing.motion_preview.ghost.patches.vertices, gripped(typing), rtol=0, atol=1e-9
    )


def test_motion_ghost_vanishes_without_enter(qtbot, typing):
    before, ghost = typing.session.store.state, typing.motion_preview.ghost
    retype(typing, "60deg")
    assert len(ghost.patches.vertices)
    typing.panel.handles.motion.choice.setFocus()
    assert not len(ghost.patches.vertices), "the field was left"
    typing.actions_.pose.enter_motion.trigger()
    assert len(ghost.patches.vertices), "Enter would do it now"
    QTest.keyClick(typing.panel.handles.motion.amount, Qt.Key.Key_Escape)
    assert not len(ghost.patches.vertices)
    assert typing.session.store.state is before


def test_motion_field_has_a_sentence_and_no_ghost_for_an_invalid_amount(qtbot, typing):
    field, ghost = typing.panel.handles.motion, typing.motion_preview.ghost
    retype(typing, "60deg")
    QTest.keyClicks(field.amount, " parsec")
    assert not len(ghost.patches.vertices)
    assert field.problem.isHidden(), "it may be half-typed"
    qtbot.waitUntil(field.problem.isVisible)
    assert "parsec" in field.problem.text()
    retype(typing, "60deg")
    assert len(ghost.patches.vertices)
    assert field.problem.isHidden()
    retype(typing, "")
    assert not len(ghost.patches.vertices)
    assert field.problem.isHidden()


def test_motion_ghost_begins_from_what_undo_brings_back(typing):
    ghost = typing.motion_preview.ghost
    typing.session.handles.move_by(typing.panel.handles.motion.motion, "30deg", 0)
    retype(typing, "0.1deg")
    turned = ghost.patches.vertices
    typing.session.gestures.undo()
    assert np.abs(ghost.patches.vertices - turned).max() > 0.1
    np.testing.assert_allclose(ghost.patches.vertices, gripped(typing), rtol=0, atol=0.1)


def test_motion_trace_rotation_is_an_arc_about_its_axis():
    rng = np.random.default_rng(3)
    grip = rng.normal(size=(20, 3))
    start = translation([3.0, -1.0, 2.0])
    for centre in ([5.0, 4.0, 0.0], transform(start, grip.mean(axis=0)[None])[0]):
        direction = np.array([1.0, 2.0, -2.0]) / 3.0
        poses = [rotation_about(centre, direction, a) @ start for a in np.linspace(0.0, 1.0, 15)]
        trace = motion_trace(grip, poses)
        along = np.diff(trace.axis, axis=0)[0]
        np.testing.assert_allclose(np.cross(along, direction), 0.0, atol=1e-8 * np.linalg.norm(along))
        np.testing.assert_allclose(np.cross(trace.axis[0] - centre, direction), 0.0, atol=1e-8)
        arms = trace.path - trace.axis.mean(axis=0)
        np.testing.assert_allclose(arms @ direction, 0.0, atol=1e-8)
        np.testing.assert_allclose(arms, arms[0] @ rotation_steps(direction, 15), atol=1e-8)


def rotation_steps(direction, count):
    return np.array([rotation(direction, a).T for a in np.linspace(0.0, 1.0, count)])


def test_motion_trace_translation_is_the_way_of_the_center():
    grip = np.eye(3)
    trace = motion_trace(grip, [translation([0, 0, 0]), translation([1.0, 2.0, 3.0])])
    assert not len(trace.axis)
    np.testing.assert_allclose(np.diff(trace.path, axis=0), [[1.0, 2.0, 3.0]])
    assert not len(motion_trace(grip, [np.eye(4)]).path)


@pytest.mark.parametrize(("motion", "axis"), [("BEND_X", 0), ("BEND_Z", 2), ("TURN_Y", 1)])
def test_motion_ghost_shows_the_axis_of_a_rotation_before_any_amount(typing, motion, axis):
    field, ghost = typing.panel.handles.motion, typing.motion_preview.ghost
    document = typing.session.store.state.document
    choose(typing, motion)
    field.choice.activated.emit(field.choice.currentIndex())
    ((_, trace),) = ghost.traces
    assert not len(ghost.patches.vertices), "nothing moves yet"
    way = trace.axis[1] - trace.axis[0]
    np.testing.assert_allclose(np.abs(way) / np.linalg.norm(way), np.eye(3)[axis], atol=1e-6)
    base = document.initial_positions[document.labels == BASE].mean(axis=0)
    centre = base if motion.startswith("BEND") else document.pivot(0)
    np.testing.assert_allclose(trace.pivot, centre[None], atol=1e-6 * np.linalg.norm(way))
    ends = trace.axis_with_pivot
    np.testing.assert_allclose(np.delete(ends - centre, axis, axis=1), 0.0, atol=1e-6 * np.linalg.norm(way))
    assert (ends[0] - centre)[axis] * (ends[1] - centre)[axis] <= 1e-9, "it leads as far as the pivot"
    retype(typing, "20deg")
    assert len(ghost.patches.vertices)
    field.amount.clear()
    choose(typing, "MOVE_X")
    field.choice.activated.emit(field.choice.currentIndex())
    assert not ghost.traces, "nothing turns"


def test_motion_ghost_shows_the_axis_of_a_motion_chosen_from_the_list_until_that_is_left(typing):
    field, ghost = typing.panel.handles.motion, typing.motion_preview.ghost
    field.choice.setFocus()
    assert not ghost.traces
    field.choice.setCurrentIndex(field.choice.findData("BEND_X"))
    field.choice.activated.emit(field.choice.currentIndex())
    assert len(ghost.traces) == 1
    field.relation.setFocus()
    assert not ghost.traces
