"""Handles, regions and what is asked of areas and of the volume, answered by the real worker."""

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest
from driven_session import BENT, Driven, bar, pose, ready
from meshes import ends, grid

from apd_viewer.files.selections.selection import MOST_REGIONS
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE, MOST_HANDLES
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.settings import Settings
from apd_viewer.session.model.document import Document
from apd_viewer.session.state_store import Activity


def layers(session: Driven, lowest: float, highest: float) -> np.ndarray:
    """The vertices between two heights."""
    z = session.store.state.document.mesh.V[:, 2]
    return np.flatnonzero((lowest <= z) & (z <= highest))


def region_stroke(session: Driven, ids: np.ndarray, number: int) -> None:
    session.gestures.begin()
    session.painting.paint_region(ids, number)
    session.painting.end_stroke("Paint region")


def region_shares(session: Driven) -> np.ndarray:
    """Area of each region, against its area at rest."""
    state = session.store.state
    return np.array(state.frame.regions) / state.document.region_areas(state.document.mesh.V)


def volume_share(session: Driven) -> float:
    return session.store.state.frame.volume / session.store.state.inspection.volume


@pytest.fixture
def parted(session):
    """The bar with a region around its middle and a second handle, half of its upper end."""
    top = layers(session, 6, 6)
    session.parts.add_handle()
    session.stroke(top[session.store.state.document.mesh.V[top, 0] == 0.0], HANDLE + 1)
    session.parts.add_region()
    region_stroke(session, layers(session, 2, 4), 1)
    return session


# Undo

VERBS: dict[str, Callable[[Driven], object]] = {
    "Add handle": lambda session: session.parts.add_handle(),
    "Remove handle": lambda session: session.parts.remove_handle(1),
    "Rename": lambda session: session.parts.rename_handle(1, "Neck"),
    "Add region": lambda session: session.parts.add_region(),
    "Remove region": lambda session: session.parts.remove_region(0),
    "Paint region": lambda session: region_stroke(session, layers(session, 1, 3), 1),
    "Change region": lambda session: session.settings.set_region_area(0, 105.0),
    "Change area": lambda session: session.settings.change(area=110.0),
    "Change volume": lambda session: session.settings.change(volume=100.0),
    "Change stiffness": lambda session: session.settings.change(stiffness=0.01),
    "Reset all handles": lambda session: session.shapes.restore(),
}
ALIASES: dict[str, tuple[str, Callable[[Driven], object]]] = {
    "the region's name": ("Rename", lambda session: session.parts.rename_region(0, "Waist")),
    "holding": ("Change area", lambda session: session.settings.change(hold_area=True)),
    "the material": (
        "Change stiffness",
        lambda session: session.settings.change(shear_stiffness=0.5),
    ),
}


@pytest.mark.parametrize("name", [*VERBS, *ALIASES])
def test_gestures_record_every_verb_as_one_entry_and_undo_it_exactly(parted, name):
    gesture, verb = ALIASES.get(name) or (name, VERBS[name])
    parted.drag(BENT)
    parted.settle()
    before, entries = parted.store.state, len(parted.gestures.history.undo_states)
    verb(parted)
    parted.settle()
    after = parted.store.state
    assert parted.gestures.history.next_undo_name == gesture
    assert len(parted.gestures.history.undo_states) == entries + 1
    parted.gestures.undo()
    assert parted.store.state is before
    parted.gestures.redo()
    assert parted.store.state is after
    parted.listen(0.02)
    assert parted.store.state is after
    assert parted.failed == []


SETTERS: dict[str, tuple[Callable[[Driven, float], None], list[float]]] = {
    "area": (lambda session, x: session.settings.change(area=x), [101.0, 104.0, 108.0]),
    "volume": (lambda session, x: session.settings.change(volume=x), [100.0, 102.0, 104.0]),
    "region": (lambda session, x: session.settings.set_region_area(0, x), [99.0, 98.0, 97.0]),
    "stiffness": (lambda session, x: session.settings.change(stiffness=x), [0.01, 0.02, 0.03]),
    "material": (lambda session, x: session.settings.change(area_stiffness=x), [1.0, 2.0, 3.0]),
}


@pytest.mark.parametrize("what", SETTERS)
def test_gestures_record_a_sweep_as_one_entry_and_single_settings_as_one_each(parted, what):
    setter, values = SETTERS[what]
    before, entries = parted.store.state, len(parted.gestures.history.undo_states)
    parted.gestures.begin()
    for value in values:
        setter(parted, value)
        parted.listen(0.005)
    parted.gestures.end("Sweep")
    assert len(parted.gestures.history.undo_states) == entries + 1
    parted.settle()
    parted.gestures.undo()
    assert parted.store.state is before
    for value in values:
        setter(parted, value)
        setter(parted, value)
    assert len(parted.gestures.history.undo_states) == entries + len(values)


def test_gestures_cancel_leaves_no_trace_of_a_sweep(parted):
    before, undo = parted.store.state, parted.gestures.history.next_undo_name
    parted.gestures.begin()
    parted.settings.change(area=120.0)
    parted.settings.change(volume=110.0)
    parted.until(lambda: parted.store.state.frame.iteration)
    parted.gestures.cancel()
    assert parted.store.state is before
    assert parted.gestures.history.next_undo_name == undo
    parted.listen(0.03)
    assert parted.store.state is before


def test_settings_changed_within_a_region_stroke_take_the_stroke_back(parted):
    before = parted.store.state
    parted.gestures.begin()
    parted.painting.paint_region(layers(parted, 0, 6), 0)
    parted.settings.change(stiffness=0.01)
    parted.painting.end_stroke("Paint region")
    assert parted.store.state.document.member is before.document.member
    parted.gestures.undo()
    assert parted.store.state is before


def test_settings_that_are_the_same_do_nothing(parted):
    state, changes = parted.store.state, len(parted.changes)
    same = state.document.settings
    parted.settings.change(area=100)
    parted.settings.change(hold_area=False)
    parted.settings.change(volume=None)
    parted.settings.change(method=same.method)
    parted.settings.change(tolerance=same.tolerance)
    parted.settings.change(stiffness=0)
    parted.settings.change(area_stiffness=same.area_stiffness, shear_stiffness=same.shear_stiffness)
    parted.settings.set_region_area(0, None)
    parted.parts.rename_handle(0, " ")
    parted.parts.rename_region(0, "Region 1")
    assert parted.store.state is state
    assert len(parted.changes) == changes


# Handles


def test_handle_editor_drag_takes_two_handles_each_to_its_own_pose(parted):
    poses = pose(0.3, (0.5, 0.0, 0.0)), pose(-0.2, (0.0, 0.4, 0.3))
    parted.gestures.begin()
    for which, there in enumerate(poses):
        parted.handles.drag(there, which)
    parted.gestures.end("Move handle")
    parted.settle()
    document = parted.store.state.document
    for which, there in enumerate(poses):
        mine = document.labels == HANDLE + which
        expected = document.mesh.V[mine] @ there[:3, :3].T + there[:3, 3]
        assert np.allclose(parted.U[mine], expected, rtol=0, atol=1e-12)
    assert parted.store.state.frame.handle_drift < 1e-12
    base = document.labels == BASE
    assert np.array_equal(parted.U[base], document.mesh.V[base])


def test_remove_handle_lets_go_and_the_others_stay_where_they_are(parted):
    parted.gestures.begin()
    parted.handles.drag(BENT, 0)
    parted.handles.drag(pose(0.5, (0.3, 0.2, 0.4)), 1)
    parted.gestures.end("Move handle")
    parted.settle()
    U, labels = parted.U, parted.store.state.document.labels
    parted.parts.remove_handle(0)
    assert parted.U is U
    document = parted.store.state.document
    assert not document.is_posed
    assert [handle.name for handle in document.handles] == ["Handle 2"]
    assert (document.labels[labels == HANDLE] == FREE).all()
    assert parted.store.activity is Activity.IDLE
    parted.drag(pose(0.0, (0.0, 0.0, 0.1)))
    parted.settle()
    other = labels == HANDLE + 1
    assert np.allclose(parted.U[other], U[other] + [0.0, 0.0, 0.1], rtol=0, atol=1e-12)


def test_remove_handle_takes_the_last_and_it_can_be_painted_again(session):
    session.parts.remove_handle(0)
    assert [handle.name for handle in session.store.state.document.handles] == ["Handle 1"]
    session.drag(BENT)
    assert session.store.activity is Activity.IDLE
    session.stroke(ends(session.store.state.document.mesh.V)[1], HANDLE)
    session.drag(BENT)
    session.settle()
    assert session.store.activity is Activity.SETTLED


@pytest.mark.parametrize(
    ("add", "most", "remove"),
    [
        (
            lambda session: session.parts.add_handle(),
            MOST_HANDLES - 1,
            lambda session, k: session.parts.remove_handle(k),
        ),
        (
            lambda session: session.parts.add_region(),
            MOST_REGIONS,
            lambda session, k: session.parts.remove_region(k),
        ),
    ],
)
def test_parts_can_be_added_only_so_many(session, add, most, remove):
    numbers = [add(session) for _ in range(most)]
    assert numbers == list(range(numbers[0], numbers[0] + most))
    state = session.store.state
    assert add(session) == numbers[-1]
    assert session.store.state is state
    assert len(session.failed) == 1
    remove(session, 3)
    assert add(session) == numbers[-1]
    names = [
        each.name for each in (*session.store.state.document.handles, *session.store.state.document.regions)
    ]
    assert len(set(names)) == len(names)


def test_parts_are_renamed_without_a_word_to_the_worker(parted, slow, factored):
    ready(parted)
    factored.count = 0
    there = parted.U
    parted.drag(BENT)
    parted.until(lambda: parted.U is not there and parted.store.state.frame.iteration >= 2)
    iteration = parted.store.state.frame.iteration
    parted.parts.rename_handle(1, "Neck")
    parted.parts.rename_handle(0, "Neck")
    parted.parts.rename_region(0, "Waist")
    parted.until(lambda: parted.store.state.frame.iteration > iteration)
    parted.settle()
    document = parted.store.state.document
    assert [handle.name for handle in document.handles] == ["Neck 2", "Neck"]
    assert [region.name for region in document.regions] == ["Waist"]
    assert document.is_posed
    assert parted.store.activity is Activity.SETTLED
    assert parted.store.state.frame.converged
    assert factored.count == 0


def test_rename_handle_in_the_middle_of_a_drag_keeps_nothing_of_the_drag(parted):
    before = parted.store.state.document.handles[0]
    parted.gestures.begin()
    parted.handles.drag(BENT)
    parted.parts.rename_handle(0, "Neck")
    named = parted.store.state.document.handles[0]
    assert named.name == "Neck"
    np.testing.assert_array_equal(named.pose, before.pose)
    parted.gestures.undo()
    assert parted.store.state.document.handles[0] is before


def test_rename_handle_to_the_same_name_ends_no_drag(parted):
    parted.gestures.begin()
    parted.handles.drag(BENT)
    parted.parts.rename_handle(0, parted.store.state.document.handles[0].name)
    np.testing.assert_array_equal(parted.store.state.document.handles[0].pose, BENT)
    parted.gestures.end("Move handle")


# Regions


def test_set_region_area_gives_a_region_its_target_while_a_pose_is_held(parted):
    parted.drag(BENT)
    parted.settle()
    there = parted.handle_at
    for percent in (100.0, 90.0, 107.0):
        parted.settings.set_region_area(0, percent)
        assert parted.store.activity is Activity.REFINING
        parted.settle()
        assert parted.store.activity is Activity.SETTLED
        assert abs(region_shares(parted)[0] - percent / 100.0) < 1e-9
        assert abs(parted.store.state.frame.area_error) < 1e-9
        assert np.allclose(parted.handle_at, there, rtol=0, atol=1e-12)


@pytest.mark.parametrize("target", [None, 100.0])
def test_paint_region_neither_factors_nor_moves_the_handle(parted, factored, target):
    parted.settings.set_region_area(0, target)
    parted.drag(BENT)
    parted.settle()
    factored.count = 0
    before, document = parted.U, parted.store.state.document
    parted.gestures.begin()
    for top in (4.0, 4.5, 5.0):
        parted.painting.paint_region(layers(parted, 2, top), 1)
        assert len(parted.store.state.frame.regions) == 1
        parted.listen(0.005)
    parted.painting.end_stroke("Paint region")
    parted.settle()
    now = parted.store.state.document
    assert (now.labels, now.initial_positions) == (document.labels, document.initial_positions)
    assert all(a.pose is b.pose for a, b in zip(now.handles, document.handles, strict=True))
    assert factored.count == 0
    if target is None:
        assert parted.U is before
        assert parted.store.activity is Activity.SETTLED
    else:
        assert abs(region_shares(parted)[0] - 1.0) < 1e-9
        assert np.abs(parted.U - before).max() > 1e-6, "the shape follows"
    held = now.constraints()
    assert np.allclose(parted.U[held.fixed], held.targets, rtol=0, atol=1e-12)


def test_paint_region_at_rest_has_the_region_measured_at_once(session):
    session.parts.add_region()
    assert session.store.state.frame.regions == (0.0,)
    region_stroke(session, layers(session, 0, 2), 1)
    assert session.store.state.frame.regions == pytest.approx((2 * 2 + 4 * 2 * 2,))
    session.parts.add_region()
    region_stroke(session, layers(session, 0, 1), 2)
    # Of the strip between the two no triangle has all its corners in one of them.
    assert session.store.state.frame.regions == pytest.approx((0.0, 2 * 2 + 4 * 2 * 1))
    region_stroke(session, layers(session, 0, 6), 0)
    assert session.store.state.frame.regions == (0.0, 0.0)
    session.parts.remove_region(0)
    assert session.store.state.frame.regions == (0.0,)
    assert session.store.activity is Activity.IDLE
    assert session.U is session.store.state.document.mesh.V


def test_paint_region_makes_the_region_with_the_first_stroke_in_one_step(session):
    before = session.store.state
    region_stroke(session, layers(session, 0, 2), 1)
    assert [region.name for region in session.store.state.document.regions] == ["Region 1"]
    assert session.gestures.history.next_undo_name == "Paint region"
    session.gestures.undo()
    assert session.store.state is before


def test_store_tells_with_every_frame_the_regions_of_its_document(parted, slow):
    parted.gestures.begin()
    parted.handles.drag(BENT)
    parted.until(lambda: parted.store.state.frame.iteration)
    parted.gestures.end("Move handle")
    parted.parts.add_region()
    parted.listen(0.03)
    region_stroke(parted, layers(parted, 0, 1), 2)
    parted.listen(0.03)
    parted.parts.remove_region(0)
    parted.settle()
    for _, state in parted.changes:
        expected = state.document.region_areas(state.frame.U)
        assert np.allclose(state.frame.regions, expected, rtol=1e-12)
        assert len(state.frame.regions) == len(state.document.regions)


def test_set_region_area_waits_for_a_triangle_in_a_region_without_one(session):
    session.parts.add_region()
    session.settings.set_region_area(0, 120.0)
    assert session.store.activity is Activity.IDLE
    region_stroke(session, layers(session, 0, 0)[:1], 1)
    assert session.store.activity is Activity.IDLE
    region_stroke(session, layers(session, 2, 4), 1)
    assert session.store.activity is Activity.REFINING
    session.settle()
    assert abs(region_shares(session)[0] - 1.2) < 1e-9
    region_stroke(session, layers(session, 0, 6), 0)
    session.settle()
    assert session.failed == []
    assert np.allclose(session.U, session.store.state.document.mesh.V, rtol=0, atol=1e-3), (
        "nothing is asked for"
    )


def test_remove_region_leaves_nothing_asked_for(parted):
    parted.settings.set_region_area(0, 120.0)
    parted.settle()
    assert np.abs(parted.U - parted.store.state.document.mesh.V).max() > 1e-2
    parted.parts.remove_region(0)
    parted.settle()
    assert np.allclose(parted.U, parted.store.state.document.mesh.V, rtol=0, atol=1e-3)


# Area and volume


@pytest.mark.parametrize("method", ["exact", "paper"])
def test_set_area_is_met_at_once_without_a_pose(session, factored, method):
    session.settings.change(method=method)
    ready(session)
    session.shapes.restore()
    factored.count = 0
    assert session.store.state.is_at_rest
    session.settings.change(area=120.0)
    assert session.store.activity is Activity.REFINING
    assert not session.store.state.is_at_rest
    session.settle()
    assert session.store.activity is Activity.SETTLED
    within = 1.2 * session.store.state.document.settings.tolerance if method == "paper" else 1e-9
    assert abs(session.store.state.frame.area_error - 0.2) < within
    assert not session.store.state.document.is_posed
    session.shapes.restore()
    assert session.U is session.store.state.document.mesh.V
    assert session.store.state.document.settings.area == 100.0
    assert session.store.state.is_at_rest
    session.listen(0.02)
    assert session.store.activity is Activity.IDLE
    assert session.U is session.store.state.document.mesh.V
    assert factored.count == 0


def test_shape_editor_restore_asks_for_100_percent_and_leaves_free_what_is_free(parted):
    parted.parts.add_region()
    parted.settings.set_region_area(0, 110.0)
    parted.settings.change(area=105.0)
    parted.drag(BENT)
    parted.settle()
    parted.shapes.restore()
    assert parted.store.state.document.target_percentages == (100.0, None, 100.0, None)
    assert parted.store.state.frame.regions == parted.store.state.document.region_areas(parted.U)
    parted.settings.change(volume=110.0)
    parted.shapes.restore()
    assert parted.store.state.document.settings.volume == 100.0
    assert parted.store.state.is_at_rest
    undo = parted.gestures.history.next_undo_name
    parted.shapes.restore()
    assert (parted.gestures.history.next_undo_name, len(parted.gestures.history.undo_states)) == (
        undo,
        len(parted.gestures.history.undo_states),
    )


def test_settings_move_nothing_at_rest_with_100_percent_of_everything(parted):
    ready(parted)
    parted.shapes.restore()
    for verb in (
        lambda: parted.settings.change(volume=100.0),
        lambda: parted.settings.set_region_area(0, 100.0),
        lambda: parted.settings.change(stiffness=0.05),
        lambda: parted.settings.change(method="local"),
        lambda: parted.settings.change(area_stiffness=5.0, shear_stiffness=1.0),
        lambda: parted.settings.change(hold_area=True),
        lambda: parted.settings.change(method="paper"),
        lambda: parted.settings.change(tolerance=0.01),
        lambda: parted.settings.change(method="arap"),
        lambda: parted.settings.change(area=130.0),  # which this method is not asked for
        parted.parts.add_handle,
        lambda: parted.parts.remove_handle(2),
        lambda: region_stroke(parted, layers(parted, 1, 5), 1),
    ):
        verb()
        assert parted.store.activity is Activity.IDLE
        assert parted.U is parted.store.state.document.mesh.V
    assert not parted.store.state.is_at_rest, "the area is asked for as soon as another method can have it"
    parted.settings.change(method="exact")
    parted.settle()
    assert parted.store.state.frame.area_error == pytest.approx(0.3)
    assert abs(volume_share(parted) - 1.0) < 1e-9
    assert abs(region_shares(parted)[0] - 1.0) < 1e-9


def test_set_volume_keeps_the_volume_while_it_is_asked_for(session):
    session.drag(BENT)
    session.settle()
    free = volume_share(session)
    assert abs(free - 1.0) > 1e-3
    session.settings.change(volume=100.0)
    session.settle()
    assert abs(volume_share(session) - 1.0) < 1e-9
    assert abs(session.store.state.frame.area_error) < 1e-9
    session.drag(pose(-0.4, (0.3, 0.0, 0.0)))
    session.settle()
    assert abs(volume_share(session) - 1.0) < 1e-9
    session.drag(BENT)
    session.settings.change(volume=None)
    session.settle()
    assert volume_share(session) == pytest.approx(free, abs=1e-3)


def test_set_volume_lets_go_what_is_no_longer_asked_for_without_a_pose(session):
    session.settings.change(method="arap")
    session.settings.change(volume=130.0)
    session.settle()
    assert abs(volume_share(session) - 1.3) < 1e-9
    session.settings.change(volume=None)
    session.settle()
    assert np.allclose(session.U, session.store.state.document.mesh.V, rtol=0, atol=1e-2)


def test_set_volume_finds_no_volume_to_keep_in_an_open_mesh(empty):
    empty.show_now(Mesh(*grid(3, 3)))
    state = empty.store.state
    empty.settings.change(volume=100.0)
    assert empty.store.state is state
    assert "no volume" in empty.failed[0]
    assert "open" in empty.failed[0]
    empty.settings.change(volume=None)
    assert len(empty.failed) == 1


@pytest.mark.parametrize("verb", ["area", "region"])
def test_settings_out_of_reach_are_said_and_can_be_taken_back(parted, verb):
    parted.drag(BENT)
    parted.settle()
    before = parted.store.state
    if verb == "area":
        parted.settings.change(area=20.0)
    else:
        parted.stroke(layers(parted, 2, 4), BASE)
        parted.settings.set_region_area(0, 150.0)
    parted.settle()
    assert parted.store.activity is Activity.UNREACHED
    frame = parted.store.state.frame
    assert frame.settled
    assert not frame.converged
    assert ("the area" if verb == "area" else "Region 1") in frame.unreached
    assert frame.unreached.endswith(".")
    assert np.isfinite(parted.U).all()
    assert parted.failed == []
    unreached = parted.store.state
    parted.gestures.undo()
    parted.gestures.redo()
    parted.listen(0.03)
    assert parted.store.state is unreached, "it is not tried again"
    while parted.store.state is not before:
        parted.gestures.undo()
    parted.settings.change(area=101.0)
    parted.settle()
    assert parted.store.activity is Activity.SETTLED
    assert parted.store.state.frame.unreached is None


def test_set_method_deforms_the_pose_that_is_held_by_another_method(session):
    session.drag(pose(0.9, (1.0, 0.0, 0.5)))
    shapes = {}
    for method in ("exact", "arap", "local", "paper", "exact"):
        session.settings.change(method=method)
        session.settle()
        assert session.store.activity is Activity.SETTLED
        shapes[method] = session.U
        if method == "exact":
            assert abs(session.store.state.frame.area_error) < 1e-9
    pairs = [(a, b) for a in shapes for b in shapes if a < b]
    assert all(np.abs(shapes[a] - shapes[b]).max() > 1e-3 for a, b in pairs)
    assert session.store.state.document.is_posed


def test_set_hold_area_holds_the_total_area_in_the_local_method_on_demand(session):
    session.settings.change(method="local")
    session.drag(BENT)
    session.settle()
    assert abs(session.store.state.frame.area_error) > 1e-9
    session.settings.change(hold_area=True)
    session.settle()
    assert abs(session.store.state.frame.area_error) < 1e-9


# Factorizations


def test_settings_factor_for_every_stiffness_and_not_for_targets(parted, factored):
    parted.drag(BENT)
    parted.settle()
    factored.count = 0
    for percent in (101.0, 103.0):
        parted.settings.change(area=percent)
        parted.settings.change(volume=percent)
        parted.settings.set_region_area(0, percent)
        parted.settle()
    parted.settings.change(volume=None)
    parted.settings.change(tolerance=0.1)
    parted.settle()
    assert factored.count == 0
    parted.settings.change(stiffness=0.02)
    parted.settle()
    assert factored.count == 1
    parted.settings.change(area_stiffness=10.0)
    parted.settle()
    assert factored.count == 2
    parted.settings.change(shear_stiffness=0.3)
    parted.settle()
    assert factored.count == 3


def test_request_solver_is_told_only_what_differs(session, monkeypatch):
    ready(session)
    kept, aimed = [], []
    keep, aim = Deformation.keep, Deformation.aim
    monkeypatch.setattr(Deformation, "keep", lambda self, *args: (kept.append(args), keep(self, *args))[1])
    monkeypatch.setattr(Deformation, "aim", lambda self, *args: (aimed.append(args), aim(self, *args))[1])
    session.drag(*(pose(k / 60) for k in range(20)))
    session.settle()
    assert kept == []
    assert aimed
    aimed.clear()
    session.settings.change(area=103.0)
    session.settle()
    assert len(kept) == 1
    assert aimed == []


def test_request_solver_goes_on_from_the_shape_on_screen_when_contact_is_turned_on(session, monkeypatch):
    session.settings.change(contact=False)
    session.drag(BENT)
    session.settle()
    begun, aim, U = [], Deformation.aim, session.U
    monkeypatch.setattr(
        Deformation, "aim", lambda self, *args: (begun.extend(args[1:2]), aim(self, *args))[1]
    )
    session.settings.change(contact=True)
    session.settle()
    np.testing.assert_array_equal(begun[0], U)


# PaintEditor and targets


def test_settings_made_before_anything_is_painted_are_answered_afterwards(empty):
    empty.show_now(bar())
    empty.settings.change(area=110.0)
    assert empty.store.activity is Activity.IDLE
    base, handle = ends(empty.store.state.document.mesh.V)
    empty.stroke(base, BASE)
    assert empty.store.activity is Activity.IDLE
    empty.stroke(handle, HANDLE)
    assert empty.store.activity is Activity.REFINING
    empty.settle()
    assert empty.store.state.frame.area_error == pytest.approx(0.1, abs=1e-9)


def test_paint_on_an_inflated_shape_moves_nothing(session):
    session.settings.change(area=115.0)
    session.settle()
    U = session.U
    session.stroke(layers(session, 1, 1), BASE)
    session.listen(0.03)
    assert session.U is U
    assert session.store.activity is Activity.IDLE


# Another mesh


@pytest.mark.parametrize(("cells", "on"), [(199, True), (200, False)])
def test_contact_by_default_is_on_where_it_leaves_the_hand_its_pace(empty, cells, on):
    empty.show_now(Mesh(*grid(cells, cells)))
    document = empty.store.state.document
    assert (len(document.mesh.V) <= 40_000) == on
    assert document.settings.contact == on


def test_files_open_mesh_begins_with_the_defaults_and_without_parts(parted):
    parted.settings.change(method="local")
    parted.settings.change(tolerance=0.01)
    parted.settings.change(stiffness=0.02)
    parted.settings.change(area_stiffness=10.0, shear_stiffness=0.5)
    parted.settings.change(area=110.0)
    parted.settings.change(volume=100.0)
    parted.show_now(bar())
    document = parted.store.state.document
    given = {"mesh", "labels", "initial_positions", "member", "handles", "settings"}
    assert document.settings == Settings(contact=True), "which is on for meshes of its size"
    for one in dataclasses.fields(Document):
        assert one.name in given or getattr(document, one.name) == one.default, one.name
    assert [handle.name for handle in document.handles] == ["Handle 1"]
    assert not document.member.any()
    assert parted.store.activity is Activity.IDLE
