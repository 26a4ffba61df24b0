"""Where a surface passes through itself: against exact arithmetic, another library, and cases by hand."""

import sys
from fractions import Fraction
from itertools import combinations

import igl
import meshes
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from apd_viewer.errors import InputError
from apd_viewer.geometry.analysis import self_intersections
from apd_viewer.geometry.analysis.self_intersections import crossing_pairs, crossings
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.operators import face_areas

CLEAN = {
    "sphere": meshes.sphere(3),
    "box": meshes.box(3, 4, 5),
    "sheet": meshes.grid(9, 7),
    "tube": meshes.tube(9, 7),
    "rabbit": meshes.rabbit(),
    "cup": meshes.cup(),
    "bottle": meshes.sample_bottle(2.5)[:2],
}


def exact(x):
    return [Fraction(float(c)) for c in x]


def minus(a, b):
    return [x - y for x, y in zip(a, b, strict=True)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def normal(t):
    return cross(minus(t[1], t[0]), minus(t[2], t[0]))


def span(t, heights, line):
    """Where a triangle meets the plane that its corners have these heights over, along a line."""
    at = [dot(line, p) for p in t]
    places = [x for x, h in zip(at, heights, strict=True) if h == 0]
    for i, j in ((0, 1), (1, 2), (2, 0)):
        if heights[i] * heights[j] < 0:
            places.append(at[i] + (at[j] - at[i]) * heights[i] / (heights[i] - heights[j]))
    return (min(places), max(places)) if places else None


def cut(s, t):
    """Length over which two triangles that are not parallel meet, up to a factor; negative where they do not.

    By the spans on the common line of their planes [Möller 1997], in rational numbers.
    """
    line = cross(normal(s), normal(t))
    ends = [
        span(one, [dot(normal(other), minus(p, other[0])) for p in one], line)
        for one, other in ((s, t), (t, s))
    ]
    if None in ends:
        return -1
    return min(ends[0][1], ends[1][1]) - max(ends[0][0], ends[1][0])


def by_all_pairs(U, F):
    found = set()
    triangles = [[exact(U[v]) for v in f] for f in F]
    for i, j in combinations(range(len(F)), 2):
        common = len(set(F[i]) & set(F[j]))
        length = cut(triangles[i], triangles[j]) if common < 2 else -1
        if length > 0 or (length == 0 and not common):
            found |= {i, j}
    return sorted(found)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(4, 12), st.integers(2, 16), st.integers(-6, 6))
def test_crossings_of_a_heap_of_triangles_are_those_of_exact_arithmetic(seed, n, m, power):
    """Any triangles among a few vertices, with one or two in common or none, of any size."""
    rng = np.random.default_rng(seed)
    U = (rng.normal(size=(n, 3)) + rng.normal(size=3)) * 10.0**power
    F = np.array([rng.choice(n, 3, replace=False) for _ in range(m)])
    assert crossings(U, F).tolist() == by_all_pairs(U, F)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(4, 12), st.integers(2, 16), st.integers(1, 7))
def test_crossings_searched_in_slabs_are_those_of_exact_arithmetic(seed, n, m, at_once):
    """Also where triangles of any size lie in several slabs, and many begin at one place."""
    rng = np.random.default_rng(seed)
    U = rng.integers(0, 5, (n, 3)).astype(float)
    F = np.array([rng.choice(n, 3, replace=False) for _ in range(m)])
    F = F[face_areas(U, F) > 0.0]
    with pytest.MonkeyPatch.context() as patch:
        whole = crossings(U, F)
        patch.setattr(self_intersections, "MOST_AT_ONCE", at_once)
        assert np.array_equal(crossings(U, F), whole)
        U = U + rng.normal(size=U.shape)
        assert crossings(U, F).tolist() == by_all_pairs(U, F)


@pytest.mark.parametrize("name", CLEAN)
def test_crossings_are_none_in_a_surface_that_does_not_cross(name):
    """Not at seams either, nor far away from the origin, however large it is."""
    V, F = CLEAN[name]
    mesh = Mesh(*meshes.soup(V, F))
    assert len(crossings(mesh.V, mesh.joined_F)) == 0
    turned = (V @ meshes.rotation([1, 2, 3], 1.0).T + [4e4, -7e3, 0]) * 1e-3
    assert len(crossings(turned, F)) == 0


def test_crossings_of_two_spheres_that_pass_through_each_other_are_in_a_ring():
    V, F = meshes.sphere(2)
    U = np.vstack([V, V @ meshes.rotation([3, 1, 2], 0.7).T + [1.1, 0.2, 0.1]])
    both = np.vstack([F, F + len(V)])
    crossing = crossings(U, both)
    corners = [[U[[v]] for v in f] for f in both]
    met = np.array(
        [[any_meeting(corners[i], corners[j]) for j in range(len(F), len(both))] for i in near(U, F)]
    )
    assert np.setdiff1d(crossing[crossing < len(F)], near(U, F)).size == 0
    assert np.array_equal(near(U, F)[met.any(axis=1)], crossing[crossing < len(F)])
    assert np.array_equal(np.flatnonzero(met.any(axis=0)) + len(F), crossing[crossing >= len(F)])
    apart = U + np.where(np.arange(len(U)) < len(V), 0.0, 1.0)[:, None] * [1.5, 0.0, 0.0]
    assert len(crossings(apart, both)) == 0
    inside = np.vstack([V, 0.5 * V])
    assert len(crossings(inside, both)) == 0, "one within the other"


def near(U, F):
    """Triangles of the first sphere that could meet the second one, whose middle is at 1.1, 0.2, 0.1."""
    away = np.linalg.norm(U[F] - [1.1, 0.2, 0.1], axis=2)
    return np.flatnonzero((away.min(axis=1) < 1.2) & (away.max(axis=1) > 0.8))


def any_meeting(s, t):
    return igl.tri_tri_intersection_test_3d(*s, *t)[0]


def placed(*triangles):
    """Triangles in a plane that is not that of any two axes."""
    V = np.array(triangles, dtype=float).reshape(-1, 3) @ meshes.rotation([1, 2, 3], 0.8).T + [3, 2, 1]
    return V, np.arange(len(V)).reshape(-1, 3)


LOW = [[0, 0, 0], [4, 0, 0], [0, 4, 0]]
IN_A_PLANE = {
    "they overlap": ([[1, 1, 0], [5, 1, 0], [1, 5, 0]], True),
    "one within the other": ([[0.5, 0.5, 0], [1.5, 0.5, 0], [0.5, 1.5, 0]], True),
    "as a star": ([[3, 3, 0], [-1, 1, 0], [1, -1, 0]], True),
    "side by side": ([[0, 0, 0.0], [0, 4, 0], [-4, 0, 0]], False),
    "a vertex hangs at an edge": ([[0, 1, 0], [0, 3, 0], [-4, 0, 0]], False),
    "one above the other": ([[1, 1, 1e-6], [5, 1, 1e-6], [1, 5, 1e-6]], False),
    "a corner on it": ([[1, 1, 0], [1, 1, 2], [2, 1, 2]], False),
    "a corner a little below it": ([[1, 1, -1e-6], [1, 1, 2], [2, 1, 2]], True),
    "an edge on it": ([[1, 1, 0], [2, 1, 0], [2, 1, 2]], False),
    "an edge at its edge": ([[1, 0, 0], [2, 0, 0], [2, 0, 2]], False),
}


@pytest.mark.parametrize("case", IN_A_PLANE)
def test_crossings_of_two_triangles_are_those_known_by_hand(case):
    other, meet = IN_A_PLANE[case]
    assert crossings(*placed(LOW, other)).tolist() == ([0, 1] if meet else [])


def test_crossings_of_boxes_that_stand_on_each_other_are_where_they_overlap():
    V, F = meshes.box(2, 2, 2)
    U, both = np.vstack([V, V + [0.5, 0.5, 2.0]]), np.vstack([F, F + len(V)])
    U = U @ meshes.rotation([1, 2, 3], 0.8).T
    found = crossings(U, both)
    lid = np.isclose((V[F][:, :, 2]).mean(axis=1), 2.0)
    floor = np.isclose((V[F][:, :, 2]).mean(axis=1), 0.0)
    flat = np.flatnonzero(np.concatenate([lid, floor]))
    assert face_areas(U, both[np.intersect1d(found, flat)]).sum() >= 2 * 1.5**2
    # The walls only where an edge of the floor runs over theirs.
    assert np.isin(2.0, np.round(np.vstack([V, V + [0, 0, 2]])[both[found]][:, :, 2], 9)).all()
    assert len(crossings(np.vstack([V, V + [0.5, 0.5, 2.001]]), both)) == 0


def test_crossings_are_found_in_a_bottle_whose_neck_is_pushed_through_its_belly():
    V, F, _ = meshes.sample_bottle(2.0)
    U = V.copy()
    high = V[:, 1] > 14
    U[high] += [2.0, -9.0, 0.0]
    found = crossings(U, F)
    assert len(found) > 20
    assert (np.ptp(U[F[found]][:, :, 1], axis=1) > 0).all()
    assert len(crossings(V * [1.0, 0.5, 1.0], F)) == 0


def test_crossings_leave_out_faces_without_area_and_vertices_without_a_face():
    V, F = meshes.sphere(1)
    V = np.vstack([V, [[1e9, 0, 0]]])
    F = np.vstack([F, [[0, 0, 1], [2, 2, 2]], F[:1]])
    assert crossings(V, F).tolist() == []
    assert crossings(V, F[-3:-1]).tolist() == []


def heaps(count, size):
    """So many triangles in each of some places, in a row."""
    rng = np.random.default_rng(3)
    corners = rng.random((count, size, 3, 3)) + 5.0 * np.arange(count)[:, None, None, None] * np.eye(3)[0]
    return corners.reshape(-1, 3), np.arange(3 * count * size).reshape(-1, 3)


def test_crossings_of_dense_places_are_searched_in_slabs(monkeypatch):
    U, F = heaps(5, 60)
    whole = crossings(U, F)
    assert len(whole) > 250
    monkeypatch.setattr(self_intersections, "MOST_PAIRS_AT_ONCE", 1500)
    assert np.array_equal(crossings(U, F), whole)


def test_crossings_are_not_known_in_a_heap_that_no_memory_holds():
    U, F = heaps(1, 20_000)
    assert crossings(U, F) is None
    with pytest.raises(InputError, match="triangles lie in a heap"):
        crossing_pairs(U, F)


@pytest.mark.parametrize("size", [1e-4, 0.3])
def test_crossing_pairs_refuses_a_small_heap_in_a_large_mesh(size, monkeypatch):
    """Of 82,000 triangles 150, small ones or long ones, which make 11,000 pairs."""
    V, F = meshes.sphere(6)
    heap = np.random.default_rng(0).normal(size=(150, 3, 3)) * size + [2.0, 0.0, 0.0]
    U = np.vstack([V, heap.reshape(-1, 3)])
    F = np.vstack([F, np.arange(450).reshape(-1, 3) + len(V)])
    monkeypatch.setattr(self_intersections, "MOST_PAIRS_AT_ONCE", 30_000)
    assert len(crossing_pairs(U, F)) > 1_000
    monkeypatch.setattr(self_intersections, "MOST_PAIRS_AT_ONCE", 3_000)
    with pytest.raises(InputError, match="triangles lie in a heap"):
        crossing_pairs(U, F)


def test_crossings_are_not_known_without_the_library(monkeypatch):
    monkeypatch.setitem(sys.modules, "ipctk", None)
    assert crossings(*meshes.sphere(0)) is None
