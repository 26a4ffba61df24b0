"""What follows from what was said, without a worker."""

import dataclasses

import numpy as np
import pytest
from meshes import box, ends, soup

from apd_viewer.files.selections.selection import Selection
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.geometry.solver.settings import Settings
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import (
    next_name,
    targets_of,
    unique_name,
    with_selection,
    without_handle,
    without_region,
)
from apd_viewer.session.model.handles_and_regions import Handle, NamedRegion
from apd_viewer.session.model.state import initial_state


def document(mesh: Mesh | None = None) -> Document:
    """A bar with base, two handles and two regions."""
    said = initial_state(mesh or Mesh(*box(2, 2, 6))).document
    base, top = ends(said.mesh.V)
    left = top[said.mesh.V[top, 0] == 0.0]
    said = said.with_label(base, BASE).with_label(top, HANDLE + 1).with_label(left, HANDLE)
    z = said.mesh.V[:, 2]
    said = said.with_region_number(np.flatnonzero(z < 3), 1).with_region_number(np.flatnonzero(z >= 3), 2)
    return dataclasses.replace(
        said,
        handles=(Handle("left"), Handle("right")),
        regions=(NamedRegion("low", 90.0), NamedRegion("high", 110.0)),
        settings=Settings(volume=100.0),
    )


def percentages(said: Document) -> tuple:
    asked = targets_of(said)
    return asked.area, asked.volume, tuple(region.area for region in asked.regions)


@pytest.mark.parametrize(
    ("method", "expected"),
    [
        ("exact", (105.0, 100.0, (90.0, 110.0))),
        ("local", (None, 100.0, (90.0, 110.0))),
        ("arap", (None, 100.0, (90.0, 110.0))),
        ("paper", (105.0, None, (None, None))),
    ],
)
def test_targets_of_asks_each_method_for_what_it_can_keep(method, expected):
    assert percentages(document().with_settings(method=method, area=105.0)) == expected


def test_targets_of_asks_the_local_method_for_the_total_area_where_it_is_held():
    local = document().with_settings(method="local", hold_area=True)
    assert percentages(local)[0] == 100.0


def test_targets_of_asks_nothing_of_a_region_until_it_covers_a_triangle():
    said = document()
    for ids, expected in (([], None), ([0], None), (said.mesh.F[0], 90.0)):
        some = dataclasses.replace(said, member=frozen(np.zeros_like(said.member)))
        asked = targets_of(some.with_region_number(np.array(ids, dtype=int), 1))
        assert [region.name for region in asked.regions] == ["low", "high"]
        assert [region.area for region in asked.regions] == [expected, None]


def test_region_areas_are_those_of_the_triangles_that_lie_in_the_regions():
    said = document()
    low, high = said.region_areas(said.mesh.V)
    assert low == pytest.approx(2 * 2 + 4 * 2 * 2)
    assert high == pytest.approx(2 * 2 + 4 * 2 * 3)
    assert said.region_areas(2.0 * said.mesh.V) == pytest.approx((4 * low, 4 * high))


def test_with_region_number_reaches_across_seams():
    """A soup repeats every vertex: the regions of both are the same surface."""
    whole, torn = document(), document(Mesh(*soup(*box(2, 2, 6))))
    assert torn.region_areas(torn.mesh.V) == pytest.approx(whole.region_areas(whole.mesh.V))
    for region in targets_of(torn).regions:
        places = {tuple(x) for x in torn.mesh.V[region.vertices]}
        assert len(region.vertices) == sum(tuple(x) in places for x in torn.mesh.V)


def test_with_region_number_puts_a_vertex_in_one_region_and_leaves_its_label():
    said = document()
    ids = np.flatnonzero(said.mesh.V[:, 2] == 6.0)
    again = said.with_region_number(ids, 1)
    assert again.labels is said.labels
    assert (again.member[ids] == 1).all()
    assert np.array_equal(np.delete(again.member, ids), np.delete(said.member, ids))
    assert said.with_label(ids, BASE).member is said.member


def test_with_label_leaves_the_very_document_where_the_paint_is_there_already():
    said = document()
    assert said.with_label(np.flatnonzero(said.labels == HANDLE), HANDLE) is said
    assert said.with_region_number(np.flatnonzero(said.member == 2), 2) is said


@pytest.mark.parametrize("k", [0, 1])
def test_without_handle_frees_what_it_held_and_the_others_count_down(k):
    said = document()
    less = without_handle(said, k)
    assert [handle.name for handle in less.handles] == ["right", "left"][k : k + 1]
    assert (less.labels[said.labels == HANDLE + k] == FREE).all()
    assert (less.labels[said.labels == HANDLE + 1 - k] == HANDLE).all()
    assert np.array_equal(less.labels == BASE, said.labels == BASE)
    assert less.member is said.member


def test_without_handle_leaves_an_empty_one_after_the_last():
    none = without_handle(without_handle(document(), 0), 0)
    assert [handle.name for handle in none.handles] == ["Handle 1"]
    assert "no handle" in none.paint_problem


@pytest.mark.parametrize("k", [0, 1])
def test_without_region_puts_its_members_in_none_and_the_others_count_down(k):
    said = document()
    less = without_region(said, k)
    assert [region.name for region in less.regions] == ["high", "low"][k : k + 1]
    assert np.array_equal(less.member == 0, said.member == k + 1)
    assert less.region_areas(said.mesh.V) == said.region_areas(said.mesh.V)[1 - k : 2 - k]
    assert less.labels is said.labels


def test_document_arrays_are_read_only_after_every_change():
    said = document()
    for each in (said, without_handle(said, 0), without_region(said, 0), said.with_pose(1, 2 * np.eye(4))):
        arrays = (each.labels, each.member, each.initial_positions, *(handle.pose for handle in each.handles))
        assert not any(array.flags.writeable for array in arrays)
        assert each.labels.dtype == each.member.dtype == np.uint8


def test_at_rest_keeps_the_paint_and_what_is_free():
    said = document().with_settings(area=120.0, volume=None).with_pose(1, 2 * np.eye(4))
    rest = said.at_rest()
    assert not rest.is_posed
    assert rest.target_percentages == (100.0, None, 100.0, 100.0)
    assert (rest.labels, rest.member, rest.initial_positions) == (said.labels, said.member, said.mesh.V)


def test_initial_state_brings_the_handles_from_labels_of_several():
    labels = document().labels
    assert [handle.name for handle in initial_state(document().mesh, labels).document.handles] == [
        "Handle 1",
        "Handle 2",
    ]


def test_next_name_counts_on_and_new_name_tells_names_apart():
    assert next_name("Handle", []) == "Handle 1"
    assert next_name("Handle", ["Handle 1", "Neck", "Handle 3"]) == "Handle 2"
    assert unique_name(" Neck ", "Handle 1", ["Handle 1", "Handle 2"]) == "Neck"
    assert unique_name("  ", "Handle 1", ["Handle 1"]) == "Handle 1"
    assert unique_name("Handle 1", "Handle 1", ["Handle 1"]) == "Handle 1"
    assert unique_name("Neck", "Handle 1", ["Handle 1", "Neck"]) == "Neck 2"
    assert unique_name("Neck", "Neck 2", ["Neck", "Neck 2"]) == "Neck 2"


def test_with_selection_keeps_paint_on_any_of_coincident_vertices():
    """A file of loose triangles repeats each position, and a selection may be of some faces."""
    V, F = soup(*box(2, 2, 2))
    top = np.flatnonzero((V[:, 2].reshape(-1, 3) == 2.0).all(axis=1))
    labels, member = np.full(len(V), FREE, dtype=np.uint8), np.zeros(len(V), dtype=np.uint8)
    labels.reshape(-1, 3)[top], member.reshape(-1, 3)[top] = BASE, 1
    found = Selection(labels, member, ("Handle",), ("Region",), (None,))
    painted = with_selection(initial_state(Mesh(V, F)).document, found)
    np.testing.assert_array_equal(painted.labels == BASE, V[:, 2] == 2.0)
    np.testing.assert_array_equal(painted.member == 1, V[:, 2] == 2.0)
