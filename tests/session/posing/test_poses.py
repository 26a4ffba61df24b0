"""Named poses: kept through paint, reset, baking and files, and gone to as one step."""

import numpy as np
import pytest
from driven_session import BENT, VIEW, Driven, pose

from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.posing.named_poses import handle_placements, is_in_pose
from apd_viewer.session.storage.session_file import open_session, save_session


@pytest.fixture
def kept(session) -> Driven:
    """A bar with two handles at its end, and two poses kept; it is in the second."""
    V = session.store.state.document.mesh.V
    session.stroke(np.flatnonzero(V[:, 2] >= 5.0), HANDLE)
    session.parts.add_handle()
    session.stroke(np.flatnonzero((V[:, 2] >= 5.0) & (V[:, 0] > 1.5)), HANDLE + 1)
    session.drag(pose(0.3))
    session.poses.add()
    session.drag(BENT)
    session.drag(pose(0.4, (0.0, 0.3, 0.0)), which=1)
    session.poses.add()
    session.settle()
    return session


def document(session):
    return session.store.state.document


def where(session) -> list[np.ndarray]:
    return [handle.pose for handle in document(session).handles]


def test_poses_keep_says_the_kept_pose_by_name(kept):
    assert kept.told[-1] == f"Kept as “{document(kept).poses[-1].name}”."


def test_poses_go_is_one_step_that_the_shape_follows(kept):
    assert [each.name for each in document(kept).poses] == ["Pose 1", "Pose 2"]
    before, second = kept.store.state, where(kept)
    kept.poses.go_to_pose(0)
    assert kept.gestures.history.next_undo_name == "Go to “Pose 1”"
    np.testing.assert_array_equal(where(kept), [pose(0.3), np.eye(4)])
    kept.settle()
    held = document(kept).constraints()
    np.testing.assert_allclose(kept.U[held.fixed], held.targets, atol=1e-9)
    steps = len(kept.gestures.history.undo_names)
    kept.poses.go_to_pose(0)
    assert len(kept.gestures.history.undo_names) == steps, "it is there"
    kept.poses.go_to_pose(1)
    np.testing.assert_array_equal(where(kept), second)
    kept.gestures.undo()
    kept.gestures.undo()
    assert kept.store.state is before


def test_poses_step_goes_around_both_ways_and_does_not_stop_at_the_same_place(kept):
    kept.poses.add()
    assert is_in_pose(document(kept), document(kept).poses[2])
    kept.poses.go_to_neighbour(1)
    assert is_in_pose(document(kept), document(kept).poses[0])
    kept.poses.go_to_neighbour(1)
    assert is_in_pose(document(kept), document(kept).poses[1])
    kept.poses.go_to_neighbour(-1)
    assert is_in_pose(document(kept), document(kept).poses[0])
    kept.handles.reset_handle(0)
    kept.poses.go_to_neighbour(-1)
    assert is_in_pose(document(kept), document(kept).poses[2])


def test_poses_are_renamed_updated_and_removed_and_all_is_undone(kept):
    first, second = document(kept).poses
    kept.poses.rename(0, "Pose 2")
    assert [each.name for each in document(kept).poses] == ["Pose 2 2", "Pose 2"]
    kept.poses.rename(0, " Open ")
    kept.poses.update(0)
    assert is_in_pose(document(kept), document(kept).poses[0])
    kept.poses.remove(1)
    assert [each.name for each in document(kept).poses] == ["Open"]
    for _ in range(4):
        kept.gestures.undo()
    assert document(kept).poses == (first, second)


def test_poses_keep_full_turns_too(kept):
    kept.handles.move_by(MOTIONS["TURN_Y"], "400deg", 0)
    kept.poses.add()
    turned = document(kept).handles[0].rotation
    kept.poses.go_to_pose(0)
    assert not document(kept).has_half_turn
    kept.poses.go_to_pose(2)
    np.testing.assert_allclose(document(kept).handles[0].rotation, turned, atol=1e-9)
    kept.handles.move_by(MOTIONS["TURN_Y"], "-360deg", 0)
    assert not is_in_pose(document(kept), document(kept).poses[2])


def test_poses_stay_where_they_are_when_paint_grips_anew(kept):
    there = handle_placements(document(kept))
    free = np.flatnonzero(document(kept).labels == FREE)
    kept.stroke(free[:3], BASE)
    assert document(kept).initial_positions is not document(kept).mesh.V
    np.testing.assert_array_equal(where(kept)[0], np.eye(4))
    for mine, before in zip(handle_placements(document(kept)), there, strict=True):
        np.testing.assert_allclose(mine.pose, before.pose, atol=1e-9)
    assert is_in_pose(document(kept), document(kept).poses[1])
    kept.poses.go_to_pose(0)
    np.testing.assert_allclose(handle_placements(document(kept))[0].pose, pose(0.3), atol=1e-9)
    kept.shapes.restore()
    kept.poses.go_to_pose(1)
    np.testing.assert_allclose(where(kept)[0], BENT, atol=1e-9)


def test_poses_are_the_same_places_after_baking(kept):
    kept.poses.go_to_pose(0)
    kept.settle()
    mine = document(kept).labels == HANDLE
    there = document(kept).constraints()
    kept.poses.go_to_pose(1)
    kept.settle()
    kept.shapes.bake()
    kept.until(lambda: kept.jobs.current is None)
    assert not document(kept).is_posed
    assert is_in_pose(document(kept), document(kept).poses[1])
    kept.poses.go_to_pose(0)
    found = document(kept).constraints()
    ids = np.flatnonzero(mine)
    rows = np.searchsorted(found.fixed, ids), np.searchsorted(there.fixed, ids)
    np.testing.assert_allclose(found.targets[rows[0]], there.targets[rows[1]], atol=1e-9)


def test_poses_go_names_a_handle_that_is_gone_and_the_others_go(kept):
    kept.parts.rename_handle(0, "Head")
    kept.parts.remove_handle(1)
    kept.poses.go_to_pose(0)
    assert "“Handle 2”" in kept.told[-1]
    assert is_in_pose(document(kept), document(kept).poses[0])
    kept.stroke(np.flatnonzero(document(kept).labels == HANDLE), FREE)
    before = kept.store.state
    kept.poses.go_to_pose(1)
    assert "gone or empty" in kept.failed[-1]
    kept.poses.update(1)
    assert "paint one first" in kept.failed[-1]
    assert kept.store.state is before


def test_poses_answer_in_a_sentence_without_a_pose_or_a_handle(session):
    session.poses.go_to_neighbour(1)
    assert "keep one first" in session.failed[-1]
    session.stroke(np.flatnonzero(document(session).labels == HANDLE), FREE)
    session.poses.add()
    assert "paint one first" in session.failed[-1]
    assert not document(session).poses


def test_poses_are_saved_and_opened(kept, tmp_path):
    kept.handles.move_by(MOTIONS["TURN_Y"], "300deg", 1)
    kept.poses.add()
    save_session(tmp_path / "a.apd", kept.store.state, VIEW, embed=True)
    found, _ = open_session(tmp_path / "a.apd")
    for mine, other in zip(found.document.poses, document(kept).poses, strict=True):
        assert mine.name == other.name
        for one, two in zip(mine.placements, other.placements, strict=True):
            assert one.handle == two.handle
            np.testing.assert_array_equal(one.pose, two.pose)
            np.testing.assert_array_equal(one.waypoints, two.waypoints)
    assert is_in_pose(found.document, found.document.poses[2])
