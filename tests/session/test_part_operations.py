"""Changes of a part as a whole, against sets and distances found by looking at everything."""

import dataclasses
from collections import defaultdict

import meshes
import numpy as np
import pytest
from driven_session import Driven
from hypothesis import given, settings, strategies as st

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.picking.vertex_sets import RINGS
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import PaintedPart
from apd_viewer.session.model.handles_and_regions import NamedRegion
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.part_operations import PartOperation, members_after

PARTS = [
    PaintedPart(BASE),
    PaintedPart(HANDLE),
    PaintedPart(HANDLE + 1),
    PaintedPart(1, is_region=True),
    PaintedPart(2, is_region=True),
]
MIRRORS = PartOperation.MIRROR_X, PartOperation.MIRROR_Y, PartOperation.MIRROR_Z
MESHES = {"whole": meshes.rabbit(2), "seams": meshes.soup(*meshes.rabbit(1))}
STATES = {name: initial_state(Mesh(*mesh)) for name, mesh in MESHES.items()}


def place_of(V):
    return np.unique(V, axis=0, return_inverse=True)[1].ravel()


def ring_of(mesh):
    """Oracle: the neighbours of every place."""
    ring = defaultdict(set)
    for corners in place_of(mesh.V)[mesh.F].tolist():
        for v in corners:
            ring[v] |= set(corners) - {v}
    return ring


def painted(name, seed):
    """A mesh with patches of base, two handles and two regions; the same at all vertices of a place."""
    state, rng = STATES[name], np.random.default_rng(seed)
    V = state.document.mesh.V
    labels, member = (np.full(len(V), c, dtype=np.uint8) for c in (FREE, 0))
    for codes, code in ((labels, BASE), (labels, HANDLE), (labels, HANDLE + 1), (member, 1), (member, 2)):
        near = np.linalg.norm(V - V[rng.integers(len(V))], axis=1)
        codes[near < rng.uniform(0.2, 1.2)] = code
    document = dataclasses.replace(
        state.document,
        labels=frozen(labels),
        member=frozen(member),
        regions=(NamedRegion("one"), NamedRegion("two")),
    )
    return state.updated(document)


def wanted(state, part, change):
    """Oracle: the vertices that a change wants, as a set of places."""
    V, place = state.document.mesh.V, place_of(state.document.mesh.V)
    ring, member = ring_of(state.document.mesh), set(place[part.mask(state.document)].tolist())
    if change is PartOperation.GROW:
        return member | {w for v in member for w in ring[v]}
    if change is PartOperation.SHRINK:
        return {v for v in member if ring[v] <= member}
    if change is PartOperation.INVERT:
        return set(place.tolist()) - member
    axis, found = MIRRORS.index(change), set(member)
    U = np.zeros((place.max() + 1, 3))
    U[place] = V
    centre = (U.min(axis=0) + U.max(axis=0)) / 2
    for v in member:
        image = U[v].copy()
        image[axis] = 2 * centre[axis] - image[axis]
        far = np.linalg.norm(U - image, axis=1)
        if far.min() <= np.mean([np.linalg.norm(U[v] - U[w]) for w in ring[v]]) / 2:
            found.add(int(np.argmin(far)))
    return found


SEEDS = st.integers(0, 10_000)
CHANGES = st.sampled_from([PartOperation.GROW, PartOperation.SHRINK, PartOperation.INVERT, *MIRRORS])


@given(st.sampled_from(list(MESHES)), SEEDS, st.sampled_from(PARTS), CHANGES)
def test_members_after_is_what_plain_search_says_and_takes_from_no_other(name, seed, part, change):
    state = painted(name, seed)
    document = state.document
    after = part.document_with_members(document, members_after(state, part, change))
    free = part.codes(document) == part.unpainted_code
    found = np.isin(place_of(document.mesh.V), list(wanted(state, part, change)))
    np.testing.assert_array_equal(part.mask(after), found & (free | part.mask(document)))
    others = ~free & ~part.mask(document)
    np.testing.assert_array_equal(part.codes(after)[others], part.codes(document)[others])
    assert after.handles is document.handles
    assert after.regions is document.regions
    if part.is_region:
        assert after.labels is document.labels
    else:
        assert after.member is document.member
    if (part.codes(after) == part.codes(document)).all():
        assert after is document


@given(st.sampled_from(list(MESHES)), SEEDS, st.sampled_from(PARTS))
@settings(max_examples=30)
def test_members_after_by_smoothing_stays_near_the_border_and_takes_from_no_other(name, seed, part):
    state = painted(name, seed)
    document, ring = state.document, ring_of(state.document.mesh)
    after = members_after(state, part, PartOperation.SMOOTH)
    before, place = part.mask(document), place_of(document.mesh.V)
    other = (part.codes(document) != part.unpainted_code) & ~before
    assert not (after & other).any()
    first = np.unique(place, return_index=True)[1]
    np.testing.assert_array_equal(after, after[first][place], "all vertices of a place go together")
    inside = dict(zip(place.tolist(), before.tolist(), strict=True))
    near = {v for v, around in ring.items() if any(inside[w] != inside[v] for w in around)}
    for _ in range(RINGS - 1):
        near |= {w for v in near for w in ring[v]}
    assert set(place[after != before].tolist()) <= near


def test_members_after_smooths_a_lone_vertex_and_a_lone_hole_away():
    V, F = meshes.grid(12, 12)
    state = initial_state(Mesh(V, F))
    half = V[:, 0] < 5.5
    spot, hole = (np.flatnonzero((V[:, 0] == x) & (V[:, 1] == 6.0)) for x in (9.0, 2.0))
    jagged = half.copy()
    jagged[spot], jagged[hole] = True, False
    part = PaintedPart(BASE)
    state = state.updated(part.document_with_members(state.document, jagged))
    np.testing.assert_array_equal(members_after(state, part, PartOperation.SMOOTH), half)


@pytest.mark.parametrize("change", MIRRORS)
def test_members_after_mirrors_a_part_in_the_middle_of_the_mesh_at_rest(change):
    V, F = meshes.sphere(3)
    V = V * (3, 2, 1) + (10, 20, 30)
    state, axis, part = initial_state(Mesh(V, F)), MIRRORS.index(change), PaintedPart(1, is_region=True)
    here = np.linalg.norm(V - V[7], axis=1) < 0.8
    image = V.copy()
    image[:, axis] = 2 * (10, 20, 30)[axis] - image[:, axis]
    there = np.linalg.norm(image - V[7], axis=1) < 0.8
    state = state.updated(part.document_with_members(state.document, here))
    frame = dataclasses.replace(state.frame, U=V @ meshes.rotation((1, 1, 0), 1))
    bent = dataclasses.replace(state, frame=frame)
    for shape in (state, bent):
        mirrored = members_after(shape, part, change)
        np.testing.assert_array_equal(mirrored, here | there)
        twice = part.document_with_members(shape.document, mirrored)
        assert part.document_with_members(twice, members_after(shape.updated(twice), part, change)) is twice


# Parts


def test_painted_part_is_its_vertices():
    document = painted("whole", 3).document
    for part in PARTS:
        codes = document.member if part.is_region else document.labels
        assert part.codes(document) is codes
        np.testing.assert_array_equal(part.mask(document), codes == part.code)
        assert part.document_with_members(document, part.mask(document)) is document


@given(SEEDS, st.sampled_from(PARTS))
def test_painted_part_becomes_all_that_is_wanted_and_what_it_leaves_is_free(seed, part):
    document = painted("whole", seed).document
    want = np.random.default_rng(seed).random(len(document.labels)) < 0.4
    after = part.document_with_members(document, want)
    np.testing.assert_array_equal(part.mask(after), want)
    left, rest = part.mask(document) & ~want, ~part.mask(document) & ~want
    assert (part.codes(after)[left] == part.unpainted_code).all()
    np.testing.assert_array_equal(part.codes(after)[rest], part.codes(document)[rest])


def test_painted_part_takes_all_vertices_of_a_place_together():
    document = STATES["seams"].document
    place = place_of(document.mesh.V)
    for part in PARTS[:2]:
        some = np.arange(len(place)) == 17
        np.testing.assert_array_equal(
            part.mask(part.document_with_members(document, some)), place == place[17]
        )


def test_painted_part_makes_the_first_region_when_it_is_wanted():
    document, part = STATES["whole"].document, PaintedPart(1, is_region=True)
    assert document.regions == ()
    none, some = np.zeros(len(document.labels), dtype=bool), np.arange(len(document.labels)) < 5
    assert part.document_with_members(document, none) is document
    after = part.document_with_members(document, some)
    assert [region.name for region in after.regions] == ["Region 1"]
    np.testing.assert_array_equal(after.member == 1, some)


# In a session


@pytest.fixture
def session():
    session = Driven()
    session.show_now(Mesh(*meshes.rabbit(2)))
    session.paint_ends()
    yield session
    session.close()


def both_ways(session: Driven, before: Document, steps: int) -> None:
    """A change was one step, and undo and redo go to the very same documents."""
    after = session.store.state.document
    assert after is not before
    assert len(session.gestures.history.undo_states) == steps + 1
    session.gestures.undo()
    assert session.store.state.document is before
    session.gestures.redo()
    assert session.store.state.document is after
    session.gestures.undo()


@pytest.mark.parametrize("change", [PartOperation.GROW, PartOperation.SMOOTH, PartOperation.INVERT, *MIRRORS])
@pytest.mark.parametrize("part", PARTS[:2])
def test_apply_operation_is_one_step_and_has_the_name_of_the_change(session, part, change):
    before, steps, shape = (
        session.store.state.document,
        len(session.gestures.history.undo_states),
        session.store.state.frame.U,
    )
    session.painting.apply_operation(part, change)
    assert session.store.state.frame.U is shape
    if session.store.state.document is before:
        assert len(session.gestures.history.undo_states) == steps
        assert change is not PartOperation.GROW
        return
    assert session.gestures.history.next_undo_name == change.value
    both_ways(session, before, steps)


def test_apply_operation_by_inverting_makes_the_first_region_of_everything(session):
    before, steps = session.store.state.document, len(session.gestures.history.undo_states)
    session.painting.apply_operation(PaintedPart(1, is_region=True), PartOperation.INVERT)
    assert [region.name for region in session.store.state.document.regions] == ["Region 1"]
    assert (session.store.state.document.member == 1).all()
    assert session.store.state.frame.regions == pytest.approx([session.store.state.inspection.area])
    both_ways(session, before, steps)


def test_apply_operation_takes_a_gesture_under_way_back(session):
    before, steps = session.store.state.document, len(session.gestures.history.undo_states)
    session.gestures.begin()
    session.painting.paint(np.arange(100), BASE)
    session.painting.apply_operation(PaintedPart(HANDLE), PartOperation.GROW)
    assert session.gestures.history.undo_states[-1].document is before
    both_ways(session, before, steps)


def test_apply_operation_lets_a_bent_shape_stay(session):
    pose = np.eye(4)
    pose[0, 3] = 0.4
    session.drag(pose)
    session.settle()
    shape = session.store.state.frame.U
    assert not np.allclose(shape, session.store.state.document.mesh.V, atol=0.01)
    session.painting.apply_operation(PaintedPart(HANDLE), PartOperation.GROW)
    session.settle()
    assert session.store.state.frame.U is shape
    assert session.store.state.document.initial_positions is shape
    assert not session.store.state.document.is_posed
    session.gestures.undo()
    np.testing.assert_array_equal(session.store.state.document.handles[0].pose, pose)
    assert session.store.state.frame.U is shape
