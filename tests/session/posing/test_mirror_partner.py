"""Symmetric posing: the partner of a handle, and the shape that comes of both."""

import numpy as np
import pytest
from driven_session import VIEW, Driven
from meshes import box, sphere

from apd_viewer.commands.replay_command import replay_session
from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.geometry.pose.transforms import rotation_about, translation
from apd_viewer.session.posing.mirror_partner import mirror_partner, mirror_plane
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.storage.session_file import open_session, save_session

X = 0


def symmetric_mesh() -> Mesh:
    """A sphere drawn out, whose vertices are mirror images along each axis."""
    V, F = sphere(3)
    return Mesh(V * [2.0, 1.0, 1.0] + [7.0, 0.0, 0.0], F)


@pytest.fixture
def winged(session) -> Driven:
    """Base below, a handle at each end, a third on top, moved symmetrically along x."""
    session.show_now(symmetric_mesh())
    V = session.store.state.document.mesh.V
    session.stroke(np.flatnonzero(V[:, 1] < -0.7), BASE)
    session.stroke(np.flatnonzero(V[:, 0] > 8.3), HANDLE)
    session.parts.add_handle()
    session.stroke(np.flatnonzero(V[:, 0] < 5.7), HANDLE + 1)
    session.parts.add_handle()
    session.stroke(np.flatnonzero(V[:, 1] > 0.8), HANDLE + 2)
    session.handles.set_mirror_axis(X)
    return session


def asymmetry(session: Driven) -> float:
    """Greatest distance of a mirror image on screen from the vertex it belongs to, in diagonals."""
    document = session.store.state.document
    plane = mirror_plane(document.mesh, X)
    V, U = document.mesh.V, session.U
    image = np.array([int(np.abs(V - x).sum(axis=1).argmin()) for x in plane.image(V)])
    return float(np.abs(plane.image(U) - U[image]).max() / np.linalg.norm(np.ptp(V, axis=0)))


def poses(session: Driven) -> list[np.ndarray]:
    return [handle.pose for handle in session.store.state.document.handles]


def test_mirror_partner_finds_partners_by_their_paint(winged):
    document = winged.store.state.document
    assert [mirror_partner(document, k).number for k in range(3)] == [1, 0, 2]
    assert [mirror_partner(document, k).fraction for k in range(3)] == [1.0, 1.0, 1.0]
    winged.stroke(np.flatnonzero(document.mesh.V[:, 0] < 5.5), FREE)
    assert mirror_partner(winged.store.state.document, 0) is None, "too little is left of it"
    winged.handles.set_mirror_axis(None)
    assert mirror_partner(winged.store.state.document, 2) is None


@pytest.mark.parametrize("how", ["drag", "typed", "keys"])
def test_mirror_partner_keeps_the_shape_symmetric_in_one_step(winged, how):
    winged.settle()
    before, steps = winged.store.state, len(winged.gestures.history.undo_names)
    bent = translation([0.3, 0.4, 0.1]) @ rotation_about([8.5, 0, 0], [1, 2, 3], 0.5)
    if how == "drag":
        winged.drag(translation([0.1, 0.1, 0.0]), bent)
    elif how == "typed":
        winged.handles.move_by(MOTIONS["BEND_Z"], "10deg", 1)
    else:
        winged.handles.set_pose(bent, 0, "Nudge handle", is_repeat=True)
        winged.handles.set_pose(translation([0.0, 0.1, 0.0]) @ bent, 0, "Nudge handle", is_repeat=True)
    winged.settle()
    assert asymmetry(winged) <= 1e-6
    right, left = winged.store.state.document.handles[:2]
    assert not np.array_equal(right.pose, np.eye(4))
    np.testing.assert_allclose(left.rotation, right.rotation * [1, -1, -1], atol=1e-9)
    assert len(winged.gestures.history.undo_names) == steps + 1
    winged.gestures.undo()
    assert winged.store.state is before


def test_mirror_partner_winds_the_partner_as_far_the_other_way_round(winged):
    winged.handles.move_by(MOTIONS["TURN_Y"], "400deg", 0)
    right, left = winged.store.state.document.handles[:2]
    assert right.has_half_turn
    assert left.has_half_turn
    np.testing.assert_allclose(right.rotation, [0, np.deg2rad(400), 0], atol=1e-9)
    np.testing.assert_allclose(left.rotation, -right.rotation, atol=1e-9)
    winged.handles.move_by(MOTIONS["TURN_Y"], "400deg", 1)
    assert not winged.store.state.document.handles[0].waypoints


def test_mirror_partner_names_both_handles_and_resets_them_together(winged):
    winged.handles.move_by(MOTIONS["MOVE_Y"], "0.2", 0)
    assert winged.gestures.history.next_undo_name == "Move along y +0.2 (Handle 1, Handle 2)"
    winged.drag(translation([0.0, 0.5, 0.0]))
    assert winged.gestures.history.next_undo_name == "Move along y +0.3 (Handle 1, Handle 2)"
    winged.handles.reset_handle(1)
    for pose in poses(winged):
        np.testing.assert_array_equal(pose, np.eye(4))


def test_mirror_partner_moves_a_handle_on_the_plane_within_it(winged):
    winged.drag(translation([0.4, 0.3, 0.2]), which=2)
    np.testing.assert_allclose(poses(winged)[2], translation([0.0, 0.3, 0.2]), atol=1e-12)
    winged.settle()
    assert asymmetry(winged) <= 1e-6
    before = winged.store.state
    for motion, text in ((MOTIONS["MOVE_X"], "0.1"), (MOTIONS["TURN_Y"], "30deg")):
        with pytest.raises(InputError, match="its own mirror image"):
            winged.handles.move_by(motion, text, 2)
    winged.handles.move_by(MOTIONS["MOVE_X"], "0", 2)
    assert winged.store.state is before
    winged.handles.move_by(MOTIONS["TURN_X"], "200deg", 2)
    assert winged.store.state.document.handles[2].rotation[0] == pytest.approx(np.deg2rad(200))


def test_paint_partner_paints_the_other_side_already_posed(winged):
    winged.gestures.begin()
    winged.painting.paint(np.flatnonzero(winged.store.state.document.labels == HANDLE + 1), FREE)
    winged.painting.end_stroke("Erase")
    winged.parts.remove_handle(1)
    winged.handles.move_by(MOTIONS["MOVE_Y"], "0.3", 0)
    before, steps = winged.store.state, len(winged.gestures.history.undo_names)
    assert mirror_partner(before.document, 0) is None
    winged.handles.paint_partner(0)
    winged.settle()
    document = winged.store.state.document
    assert mirror_partner(document, 0) == (2, 1.0)
    assert asymmetry(winged) <= 1e-6
    assert len(winged.gestures.history.undo_names) == steps + 1
    winged.handles.paint_partner(0)
    assert "free vertices" in winged.failed[-1]
    assert winged.store.state.document is document
    winged.gestures.undo()
    assert winged.store.state is before


def test_mirror_partner_is_undone_saved_and_replayed(winged, tmp_path):
    winged.handles.set_mirror_axis(None)
    assert winged.gestures.history.next_undo_name == "Change symmetry"
    winged.gestures.undo()
    assert winged.store.state.document.mirror_axis == X
    winged.handles.move_by(MOTIONS["BEND_Z"], "20deg", 0)
    winged.settle()
    save_session(tmp_path / "a.apd", winged.store.state, VIEW, embed=True)
    found, _ = open_session(tmp_path / "a.apd")
    assert found.document.mirror_axis == X
    for handle, other in zip(found.document.handles, winged.store.state.document.handles, strict=True):
        np.testing.assert_array_equal(handle.pose, other.pose)
    _, result = replay_session(tmp_path / "a.apd", from_rest=True)
    assert np.abs(result.U - winged.U).max() < 1e-3


def test_mirror_partner_lets_a_handle_without_a_mirror_image_move_alone(session):
    V, F = box(2, 2, 6)
    session.show_now(Mesh(V, F))
    session.paint_ends()
    session.handles.set_mirror_axis(2)
    assert mirror_partner(session.store.state.document, 0) is None, "the base is there"
    session.drag(translation([0.0, 0.0, 1.0]))
    np.testing.assert_array_equal(poses(session)[0], translation([0.0, 0.0, 1.0]))
