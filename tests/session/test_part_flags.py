"""Locked parts keep their vertices whatever is painted; hidden ones hold without a colour."""

from dataclasses import replace

import numpy as np
import pytest
from driven_session import VIEW, check_equal
from hypothesis import given, settings, strategies as st
from meshes import box

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.session.model.document_parts import (
    PaintedPart,
    with_next_region,
    without_handle,
    without_paint,
)
from apd_viewer.session.model.handles_and_regions import Handle, PartFlags
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.part_operations import PartOperation, members_after
from apd_viewer.session.storage.session_file import open_session, save_session

PARTS = [
    PaintedPart(BASE),
    PaintedPart(HANDLE),
    PaintedPart(HANDLE + 1),
    PaintedPart(1, is_region=True),
    PaintedPart(2, is_region=True),
]
LOCKED = PartFlags(locked=True)
N = len(box(1, 1, 3)[0])
IDS = st.lists(st.integers(0, N - 1), max_size=12).map(lambda ids: np.array(sorted(set(ids)), dtype=int))


def parted():
    """A bar with two handles and two regions, all painted."""
    state = initial_state(Mesh(*box(1, 1, 3)))
    document = with_next_region(with_next_region(state.document))
    document = document.with_handle(1, Handle("Other"))
    for code, ids in ((BASE, [0, 1]), (HANDLE, [4, 5]), (HANDLE + 1, [8, 9])):
        document = document.with_label(np.array(ids), code)
    for number, ids in ((1, [2, 4]), (2, [6, 8])):
        document = document.with_region_number(np.array(ids), number)
    return state.updated(document)


ACTS = st.lists(
    st.one_of(
        st.tuples(st.just("paint"), IDS, st.sampled_from([BASE, FREE, HANDLE, HANDLE + 1])),
        st.tuples(st.just("region"), IDS, st.integers(0, 2)),
        st.tuples(st.just("reshape"), st.sampled_from(PARTS), st.sampled_from(PartOperation)),
        st.tuples(st.just("clear"), st.just(0), st.just(0)),
    ),
    max_size=6,
)


@settings(max_examples=60, deadline=None)
@given(part=st.sampled_from(PARTS), acts=ACTS)
def test_part_flags_keep_the_vertices_of_a_locked_part_whatever_is_painted(part, acts):
    state = parted()
    member = part.mask(state.document)
    state = state.updated(part.document_with_flags(state.document, LOCKED))
    for act, one, other in acts:
        document = state.document
        if act == "paint":
            document = document.with_label(one, other)
        elif act == "region":
            document = document.with_region_number(one, other)
        elif act == "reshape":
            document = one.document_with_members(document, members_after(state, one, other))
        else:
            document = without_paint(document)
        state = state.updated(document)
        np.testing.assert_array_equal(part.mask(document), member)


def test_part_flags_go_with_their_handle_when_another_is_removed():
    document = PaintedPart(HANDLE + 1).document_with_flags(parted().document, LOCKED)
    assert PaintedPart(HANDLE).flags(without_handle(document, 0)) == LOCKED


def test_save_session_keeps_the_part_flags(tmp_path):
    mesh = Mesh(*box(1, 1, 3))
    save_mesh(mesh, mesh.V, tmp_path / "bar.obj")
    state = initial_state(open_mesh(tmp_path / "bar.obj"))
    state = state.updated(
        replace(
            parted().document, mesh=state.document.mesh, initial_positions=state.document.initial_positions
        )
    )
    for k, part in enumerate(PARTS):
        state = state.updated(
            part.document_with_flags(state.document, PartFlags(bool(k % 2), bool(k // 2 % 2)))
        )
    save_session(tmp_path / "a.apd", state, VIEW)
    check_equal(open_session(tmp_path / "a.apd")[0], state)


# The session


def test_paint_clears_each_part_in_one_step(session):
    session.parts.add_region()
    session.gestures.begin()
    session.painting.paint_region(np.arange(5), 1)
    session.painting.end_stroke("Paint region")
    before = session.store.state
    for part in (PaintedPart(BASE), PaintedPart(HANDLE), PaintedPart(1, is_region=True)):
        session.painting.apply_operation(part, PartOperation.CLEAR)
        assert not part.mask(session.store.state.document).any()
        session.gestures.undo()
        assert session.store.state is before
    session.painting.clear_all()
    assert (session.store.state.document.labels == FREE).all()
    assert not session.store.state.document.member.any()
    session.gestures.undo()
    assert session.store.state is before


def test_lock_and_hide_are_steps_of_undo(session):
    before = session.store.state
    session.parts.lock(PaintedPart(BASE), True)
    session.parts.hide(PaintedPart(HANDLE), True)
    document = session.store.state.document
    assert (document.base, document.handles[0].flags) == (LOCKED, PartFlags(hidden=True))
    session.parts.lock(PaintedPart(BASE), True)
    assert session.store.state.document is document, "it is locked already"
    session.gestures.undo()
    session.gestures.undo()
    assert session.store.state is before


@pytest.mark.parametrize("change", ["reshape", "remove", "load"])
def test_parts_lock_refuses_a_change_of_a_part_as_a_whole_in_a_sentence(session, tmp_path, change):
    session.files.save_selection(tmp_path / "paint.json")
    session.until(lambda: session.jobs.current is None)
    session.parts.lock(PaintedPart(HANDLE), True)
    before = session.store.state
    if change == "reshape":
        session.painting.apply_operation(PaintedPart(HANDLE), PartOperation.GROW)
    elif change == "remove":
        session.parts.remove_handle(0)
    else:
        session.files.load_selection(tmp_path / "paint.json")
        session.until(lambda: session.jobs.current is None)
    assert session.store.state is before
    assert len(session.failed) == 1
    assert "unlock" in session.failed[0]


def test_parts_lock_finds_nothing_to_lock_in_a_region_that_is_not_there_yet(session):
    before = session.store.state
    session.parts.lock(PaintedPart(1, is_region=True), True)
    assert session.store.state is before
