"""What is said of a handle that was moved stays true while the mesh is painted on."""

from dataclasses import replace

import numpy as np
import pytest
from driven_session import VIEW, Driven
from hypothesis import given, settings, strategies as st
from meshes import tube

from apd_viewer.cases.case import case_of, case_steps
from apd_viewer.commands.replay_command import replay_session
from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.geometry.pose.transforms import rotation_about, translation
from apd_viewer.presentation import readings
from apd_viewer.presentation.report_blocks import handle_rows
from apd_viewer.session.deck_setup import deck_of, deck_wall
from apd_viewer.session.model.document_parts import PaintedPart
from apd_viewer.session.part_operations import PartOperation
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import WallText
from apd_viewer.session.storage.session_file import open_session, save_session


@pytest.fixture
def twisted(empty: Driven) -> Driven:
    """A tube twisted by 20 degrees, at rest there."""
    empty.show_now(Mesh(*tube(12, 16)))
    z = V(empty)[:, 2]
    empty.stroke(np.flatnonzero(z == z.min()), BASE)
    empty.stroke(np.flatnonzero(z == z.max()), HANDLE)
    empty.settings.set_contact(False)
    twist(empty, 20)
    return empty


def V(session) -> np.ndarray:
    return session.store.state.document.mesh.V


def document(session):
    return session.store.state.document


def twist(session, degrees: float, to: bool = False) -> None:
    session.handles.move_by(MOTIONS["TWIST"], f"{degrees}deg", 0, is_total=to)
    session.settle()


def said(session, k: int = 0) -> str:
    return readings.motion(session.store.state, k, Unit.NONE)


def turned_by(session, degrees: float) -> np.ndarray:
    """The rest shape, turned about the line from the base to the handle."""
    painted = document(session)
    base, top = (V(session)[painted.labels == code].mean(axis=0) for code in (BASE, HANDLE))
    pose = rotation_about(base, (top - base) / np.linalg.norm(top - base), np.deg2rad(degrees))
    moved: np.ndarray = V(session) @ pose[:3, :3].T + pose[:3, 3]
    return moved


def ring(session, share: float) -> np.ndarray:
    """A ring of free vertices at a share of the height."""
    z = V(session)[:, 2]
    heights = np.unique(z)
    return np.flatnonzero(z == heights[round(share * (len(heights) - 1))])


def a_base_stroke(session) -> None:
    session.stroke(ring(session, 0.2), BASE)


def a_longer_handle(session) -> None:
    session.stroke(ring(session, 0.8), HANDLE)


def a_shorter_handle(session) -> None:
    session.stroke(np.flatnonzero(document(session).labels == HANDLE)[::2], FREE)


def a_base_at_one_side(session) -> None:
    """It leads the line from the base to the handle elsewhere."""
    session.stroke(
        np.flatnonzero((V(session)[:, 2] < V(session)[:, 2].mean()) & (V(session)[:, 0] > 0.0)), BASE
    )


def another_handle(session) -> None:
    session.parts.add_handle()
    session.stroke(ring(session, 0.5), HANDLE + 1)


def a_grown_base(session) -> None:
    session.painting.apply_operation(PaintedPart(BASE), PartOperation.GROW)


def a_handle_less(session) -> None:
    another_handle(session)
    session.parts.remove_handle(1)


def a_region(session) -> None:
    session.gestures.begin()
    session.painting.paint_region(ring(session, 0.5), 1)
    session.painting.end_stroke("Paint region")


def names_and_locks(session) -> None:
    session.parts.rename_handle(0, "Neck")
    session.parts.lock(PaintedPart(HANDLE), True)


EDITS = [
    a_base_stroke,
    a_base_at_one_side,
    a_longer_handle,
    a_shorter_handle,
    another_handle,
    a_grown_base,
    a_handle_less,
    a_region,
    names_and_locks,
]


@pytest.mark.parametrize("edit", EDITS)
def test_relative_to_rest_forgets_no_motion_in_any_edit_of_the_paint(twisted, edit, tmp_path):
    before, rest = twisted.store.state, V(twisted)
    edit(twisted)
    twisted.settle()
    assert said(twisted) == "twisted +20.0°"
    assert twisted.U is before.frame.U, "nothing jumps"
    row = next(iter(handle_rows(twisted.store.state, Unit.NONE)))
    assert row[1] == "twisted +20.0°"
    assert "angle 20°" in row[2]

    path = tmp_path / "painted.apd"
    save_session(path, twisted.store.state, VIEW, embed=True)
    opened, _ = open_session(path)
    assert readings.motion(opened, 0, Unit.NONE) == "twisted +20.0°"

    if edit is a_base_at_one_side:
        return  # a twist is about another line now
    twist(twisted, 60, to=True)
    assert said(twisted) == "twisted +60.0°"
    held = document(twisted).relative_to_rest.handles[0].pose
    kept = before.document.labels == HANDLE
    kept &= document(twisted).labels == HANDLE
    moved = rest[kept] @ held[:3, :3].T + held[:3, 3]
    np.testing.assert_allclose(twisted.U[kept], moved, atol=1e-9)
    assert np.degrees(np.arccos((np.trace(held[:3, :3]) - 1) / 2)) == pytest.approx(60.0)

    twisted.handles.reset_handle(0)
    twisted.settle()
    assert said(twisted) == "at rest"
    np.testing.assert_allclose(twisted.U, rest, atol=1e-4)
    twisted.gestures.undo()
    assert said(twisted) == "twisted +60.0°"


def test_open_session_gives_a_session_of_before_the_places_that_it_had(twisted, tmp_path):
    """It says only where its handles are held, not how they came there."""
    a_longer_handle(twisted)
    old = replace(document(twisted).handles[0], earlier_poses=(), former_twist_axis=None)
    path, state = tmp_path / "old.apd", twisted.store.state.updated(document(twisted).with_handle(0, old))
    save_session(path, state, VIEW, embed=True)
    opened, _ = open_session(path)
    assert opened.document.relative_to_rest is opened.document
    assert readings.motion(opened, 0, Unit.NONE) == "not moved since it was painted"
    held, there = opened.document.constraints(), document(twisted).constraints()
    np.testing.assert_array_equal(held.targets, there.targets)
    np.testing.assert_array_equal(opened.frame.U, twisted.U)


@pytest.mark.parametrize("said", [np.zeros((4, 4)), np.diag([1.0, 1.0, 0.0, 1.0])])
def test_open_session_refuses_a_damaged_way(twisted, tmp_path, said):
    path = tmp_path / "damaged.apd"
    handle = replace(document(twisted).handles[0], earlier_poses=(said,))
    save_session(
        path, twisted.store.state.updated(document(twisted).with_handle(0, handle)), VIEW, embed=True
    )
    with pytest.raises(InputError):
        open_session(path)


def test_relative_to_rest_takes_studies_of_a_painted_shape_along_the_whole_motion(twisted, tmp_path):
    a_base_stroke(twisted)
    twist(twisted, 10)
    case = case_of(document(twisted).with_settings(method="arap"), 3)
    steps = list(case_steps(case))
    assert case.abscissa == "degrees"
    assert [step.degrees for step in steps] == pytest.approx([0, 10, 20, 30])
    top = document(twisted).labels == HANDLE
    np.testing.assert_allclose(steps[0].frame.U[top], V(twisted)[top], atol=1e-12)
    np.testing.assert_allclose(steps[3].frame.U[top], twisted.U[top], atol=1e-9)

    deck = deck_of(document(twisted), deck_wall(WallText(), Unit.NONE, 1.0), 2)
    at_top = next(k for k, part in enumerate(deck.held_sets) if part.name == "HANDLE")
    np.testing.assert_allclose(deck.V[top] + deck.steps[-1][at_top], twisted.U[top], atol=1e-9)
    halfway = deck.V[top] + deck.steps[0][at_top]
    np.testing.assert_allclose(halfway, turned_by(twisted, 15)[top], atol=1e-9)

    path = tmp_path / "painted.apd"
    save_session(path, twisted.store.state, VIEW, embed=True)
    shapes = []
    replay_session(path, from_rest=True, on_shape=shapes.append)
    np.testing.assert_allclose(shapes[0][top], V(twisted)[top], atol=1e-12)
    np.testing.assert_allclose(shapes[-1], twisted.U, atol=2e-2)


def test_readings_claim_no_motion_of_a_handle_painted_on_a_deformed_shape(twisted):
    another_handle(twisted)
    assert said(twisted, 1) == "not moved since it was painted"
    assert twisted.store.state.is_handle_moved(1)
    twisted.handles.move_by(MOTIONS["MOVE_Z"], "0.1", 1)
    twisted.settle()
    assert said(twisted, 1) == "moved 0.1000"
    twisted.handles.reset_handle(1)
    twisted.settle()
    assert said(twisted, 1) == "at rest"
    assert said(twisted, 0) == "twisted +20.0°"
    mine = document(twisted).labels == HANDLE + 1
    np.testing.assert_allclose(twisted.U[mine], V(twisted)[mine], atol=1e-12)


def test_set_members_lets_a_handle_painted_elsewhere_start_again(twisted):
    twisted.painting.set_members(
        PaintedPart(HANDLE), np.isin(np.arange(len(V(twisted))), ring(twisted, 0.0)), "Paint"
    )
    twisted.stroke(ring(twisted, 1.0), BASE)
    assert said(twisted) == "at rest"
    assert not document(twisted).handles[0].earlier_poses


def test_relative_to_rest_keeps_full_turns_and_they_are_wound_back(twisted):
    twist(twisted, 340)
    a_base_stroke(twisted)
    assert said(twisted) == "twisted +360.0°"
    twist(twisted, 40)
    assert said(twisted) == "twisted +400.0°"
    assert not document(twisted).has_half_turn, "it goes on from what is on screen"
    assert document(twisted).relative_to_rest.has_half_turn
    twist(twisted, 90, to=True)
    assert said(twisted) == "twisted +90.0°"
    a_longer_handle(twisted)
    twisted.handles.reset_handle(0)
    twisted.settle()
    assert said(twisted) == "at rest"
    np.testing.assert_allclose(twisted.U, V(twisted), atol=1e-3)


@pytest.mark.parametrize(
    "back",
    [
        lambda s: s.handles.reset_handle(0),
        pytest.param(lambda s: twist(s, 0, to=True), marks=pytest.mark.night),
    ],
)
def test_handle_editor_unwinds_a_wound_shape_with_contact(twisted, back):
    """The shortest way from 300 degrees back to rest leads on to a full turn."""
    twisted.settings.set_contact(True)
    twist(twisted, 280)
    assert said(twisted) == "twisted +300.0°"
    back(twisted)
    twisted.settle()
    assert said(twisted) == "at rest"
    np.testing.assert_allclose(twisted.U, V(twisted), atol=1e-3)


def test_poses_go_finds_a_kept_pose_again_after_a_stroke(twisted):
    twisted.poses.add()
    twist(twisted, 300)
    a_longer_handle(twisted)
    twisted.poses.go_to_pose(0)
    twisted.settle()
    assert said(twisted) == "twisted +20.0°"
    pose = document(twisted).relative_to_rest.handles[0].pose
    np.testing.assert_allclose(pose, document(twisted).poses[0].placements[0].pose, atol=1e-9)


def test_paint_partner_takes_a_mirror_handle_along_the_whole_motion(empty):
    empty.show_now(Mesh(*tube(12, 16)))
    x, z = V(empty)[:, 0], V(empty)[:, 2]
    empty.stroke(np.flatnonzero(z == z.min()), BASE)
    empty.stroke(np.flatnonzero((z == z.max()) & (x > 0.2)), HANDLE)
    empty.handles.move_by(MOTIONS["MOVE_X"], "0.1", 0)
    empty.settle()
    empty.stroke(ring(empty, 0.2), BASE)
    empty.handles.set_mirror_axis(0)
    empty.handles.paint_partner(0)
    empty.settle()
    first, second = document(empty).relative_to_rest.handles
    assert first.pose[0, 3] == pytest.approx(0.1)
    assert second.pose[0, 3] == pytest.approx(-0.1)
    other = document(empty).labels == HANDLE + 1
    np.testing.assert_allclose(empty.U[other], V(empty)[other] - [0.1, 0.0, 0.0], atol=1e-9)


def test_bake_begins_anew_from_what_is_on_screen(twisted):
    a_base_stroke(twisted)
    twisted.shapes.bake()
    twisted.until(lambda: twisted.jobs.current is None)
    assert said(twisted) == "at rest"
    assert not twisted.store.state.is_handle_moved(0)
    assert twisted.store.state.is_at_rest


MOVES = st.tuples(st.just("move"), st.floats(-0.6, 0.6), st.floats(-0.1, 0.1))
STROKES = st.tuples(st.just("stroke"), st.floats(0.1, 0.9), st.sampled_from([BASE, FREE, HANDLE, HANDLE + 1]))
STEPS = st.lists(MOVES | STROKES | st.tuples(st.just("undo"), st.just(0), st.just(0)), min_size=3, max_size=9)


@settings(max_examples=10, deadline=None)
@given(steps=STEPS)
def test_relative_to_rest_has_the_product_of_all_motions(steps):
    """Whatever is painted between them, and whatever is undone."""
    session = Driven()
    try:
        session.show_now(Mesh(*tube(8, 8)))
        z = V(session)[:, 2]
        session.stroke(np.flatnonzero(z == z.min()), BASE)
        session.stroke(np.flatnonzero(z == z.max()), HANDLE)
        session.parts.add_handle()
        session.settings.change(method="arap")
        first, done = np.flatnonzero(document(session).labels == HANDLE), []
        total = np.eye(4)
        for step, a, b in steps:
            if step == "undo":
                if done:
                    session.gestures.undo()
                    total = done.pop()
                continue
            before = session.store.state.document
            if step == "move":
                by = translation([b, 0.0, -b]) @ rotation_about([0.0, 0.0, z.max()], [0.3, 0.2, 1.0], a)
                session.handles.set_pose(by @ document(session).handles[0].pose, 0, "Move")
            else:
                session.stroke(ring(session, a), b)
            if document(session) is not before:
                done.append(total)
                total = by @ total if step == "move" else total
            session.settle()
            whole = document(session).relative_to_rest
            np.testing.assert_allclose(whole.handles[0].pose, total, atol=1e-9)
            there = V(session)[first] @ total[:3, :3].T + total[:3, 3]
            np.testing.assert_allclose(session.U[first], there, atol=1e-9)
        session.handles.reset_handle(0)
        assert not session.failed
        held = document(session).constraints()
        assert not session.store.state.is_handle_moved(0)
        np.testing.assert_array_equal(held.targets[np.isin(held.fixed, first)], V(session)[first])
    finally:
        session.close()
