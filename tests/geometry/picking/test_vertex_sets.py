"""Sets of vertices: by the graph, by the shape, by an outline."""

from collections import defaultdict
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st
from meshes import box, grid, rotation, soup, sphere, tube
from scipy.spatial import Delaunay

from apd_viewer.geometry.mesh.edges_and_components import (
    BOUNDARY,
    NON_MANIFOLD,
    flood_fill,
    opposite_half_edges,
)
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.operators import vertex_neighbours
from apd_viewer.geometry.picking.surface_index import SurfaceIndex
from apd_viewer.geometry.picking.vertex_sets import (
    RINGS,
    border_loop,
    component_of,
    grown_set,
    is_inside_polygon,
    mirrored_set,
    shrunk_set,
    smoothed_set,
)
from apd_viewer.geometry.pose.mirror import MirrorPlane

N = 9  # vertices of the triangles that hypothesis makes up
triangles = st.lists(st.tuples(*[st.integers(0, N - 1)] * 3), min_size=1, max_size=14).map(
    lambda F: np.array(F, dtype=np.int32)
)
sets = st.lists(st.booleans(), min_size=N, max_size=N).map(lambda member: np.array(member, dtype=bool))


def around(F):
    """Oracle of the one-rings: a set for every vertex."""
    found = defaultdict(set)
    for corners in F.tolist():
        for v in corners:
            found[v] |= set(corners) - {v}
    return found


def rings(F, seeds):
    """Oracle: how many rings every vertex that can be reached is away from the ``seeds``."""
    ring, found, away = around(F), dict.fromkeys(seeds, 0), 0
    front = set(seeds)
    while front:
        away += 1
        front = {w for v in front for w in ring[v]} - set(found)
        found |= dict.fromkeys(front, away)
    return found


def corners_of_edges(F):
    """Oracle: where each edge is found, as ``3 * t + c``, in triangles with three corners."""
    found = defaultdict(list)
    for t, corners in enumerate(F.tolist()):
        if len(set(corners)) == 3:
            for c in range(3):
                found[frozenset((corners[c], corners[(c + 1) % 3]))].append(3 * t + c)
    return found


def joined(V, F):
    """The skin of a mesh like an STL file, and which vertex of ``V`` each of its vertices is."""
    torn = Mesh(*soup(V, F))
    return torn.V, SurfaceIndex.from_triangles(torn.F, len(torn.V), torn.joined_F), np.ravel(F)


def border_length(F, member):
    """Number of edges from within to without."""
    return len({frozenset((v, w)) for v, ring in around(F).items() for w in ring if member[v] != member[w]})


@given(triangles, sets)
def test_grown_set_and_shrunk_are_what_their_neighbours_say(F, member):
    graph, ring = vertex_neighbours(F, N), around(F)
    larger, smaller = grown_set(*graph, member), shrunk_set(*graph, member)
    for v in range(N):
        assert larger[v] == (member[v] or any(member[w] for w in ring[v]))
        assert smaller[v] == (member[v] and all(member[w] for w in ring[v]))


def test_grown_set_and_shrunk_cross_seams():
    V, F = box(3, 3, 3)
    U, skin, where = joined(V, F)
    whole, torn = V[:, 2] > 2.5, U[:, 2] > 2.5
    for act in (grown_set, shrunk_set):
        expected = act(*vertex_neighbours(F, len(V)), whole)
        named = np.unique(skin.joined)
        np.testing.assert_array_equal(
            act(skin.start, skin.neighbour, torn)[named], expected[where[named]], strict=True
        )


@pytest.mark.parametrize("turned", [False, True])
def test_smoothed_set_makes_a_jagged_border_straight_and_leaves_a_straight_one(turned):
    V, F = grid(20, 20)
    graph = vertex_neighbours(F, len(V))
    x, y = V[:, :2].T[:: -1 if turned else 1]
    for jagged in (x <= 10 + y % 2, x <= 10 + 2 * (y // 2 % 2), x <= 10 + 3 * (y % 2)):
        smooth = smoothed_set(*graph, V, jagged)
        assert border_length(F, smooth) == border_length(F, x <= 10) < border_length(F, jagged)
        assert (smooth | (x > 10)).all()
        assert (~smooth | (x <= 13)).all()
        np.testing.assert_array_equal(smoothed_set(*graph, V, smooth), smooth)
    np.testing.assert_array_equal(smoothed_set(*graph, V, x <= 10), x <= 10)


@pytest.mark.parametrize("seed", range(3))
def test_smoothed_set_lets_no_half_plane_creep_however_often_it_is_called(seed):
    rng = np.random.default_rng(seed)
    X = rng.uniform(size=(1500, 2)) * 20
    F, V = Delaunay(X).simplices, np.column_stack([X, np.zeros(1500)])
    graph = vertex_neighbours(F, len(V))
    for member in (X[:, 0] < 10, X[:, 0] + rng.normal(size=1500) < 10):
        first, before = smoothed_set(*graph, V, member), member
        while (before != member).any() or before is member:
            before, member = member, smoothed_set(*graph, V, member)
            assert border_length(F, member) <= 1.05 * border_length(F, first)
        assert (member != first).sum() <= 12
        assert border_length(F, member) < 1.1 * border_length(F, X[:, 0] < 10)


@given(st.lists(st.booleans(), min_size=225, max_size=225))
def test_smoothed_set_treats_both_sides_alike_and_stays_near_the_border(drawn):
    V, F = grid(14, 14)
    graph, member = vertex_neighbours(F, len(V)), np.array(drawn)
    smooth = smoothed_set(*graph, V, member)
    np.testing.assert_array_equal(smoothed_set(*graph, V, ~member), ~smooth)
    patch = (V[:, 0] < 7) & ((V[:, 0] > 3) | member)
    change = np.flatnonzero(smoothed_set(*graph, V, patch) != patch)
    away = rings(F, np.flatnonzero(grown_set(*graph, patch) & ~shrunk_set(*graph, patch)).tolist())
    assert max((away[v] for v in change.tolist()), default=0) < RINGS


def test_smoothed_set_lets_vertices_at_almost_one_place_go_with_most_of_them():
    V, F = grid(8, 8)
    graph, column = vertex_neighbours(F, len(V)), V[:, 0].copy()
    V[:, 0] = np.where((column >= 3) & (column <= 5), 3 + 1e-6 * column, column)
    np.testing.assert_array_equal(smoothed_set(*graph, V, column <= 3), column <= 2)
    np.testing.assert_array_equal(smoothed_set(*graph, V, column <= 4), column <= 5)


def test_smoothed_set_bears_vertices_at_one_place_and_sets_without_a_border():
    V, F = grid(6, 6)
    V[V[:, 0] < 3] = 0.0
    graph = vertex_neighbours(F, len(V))
    assert smoothed_set(*graph, V, V[:, 0] > 4).sum() in range(7, 22)
    for whole in (True, False):
        assert (smoothed_set(*graph, V, np.full(len(V), whole)) == whole).all()


@pytest.mark.parametrize("axis", range(3))
def test_mirrored_set_is_the_mirror_image_of_a_set_on_a_symmetric_mesh(axis):
    V, F = box(4, 2, 6)
    graph, middle = vertex_neighbours(F, len(V)), np.array([2.0, 1.0, 3.0])
    rng = np.random.default_rng(axis)
    for member in rng.random((5, len(V))) < 0.2:
        image = mirrored_set(*graph, V, member, MirrorPlane(axis, middle[axis]))
        flipped = V[member] + (2 * (middle - V[member])) * (np.arange(3) == axis)
        assert sorted(map(tuple, V[image])) == sorted(map(tuple, flipped))
        np.testing.assert_array_equal(mirrored_set(*graph, V, image, MirrorPlane(axis, middle[axis])), member)
    assert not mirrored_set(*graph, V, np.zeros(len(V), dtype=bool), MirrorPlane(axis, middle[axis])).any()


def test_mirrored_set_has_no_image_of_a_vertex_without_a_counterpart():
    V, F = grid(4, 2)
    V, F = np.vstack([V, [[0.0, 0.0, 9.0], [4.0, 0.0, 9.0]]]), F.astype(np.int32)
    graph = vertex_neighbours(F, len(V))
    everything = np.ones(len(V), dtype=bool)
    # Nobody names the last two; those at x = 4 are mirrored to x = -0.5, and to x = -0.7, too far away.
    np.testing.assert_array_equal(mirrored_set(*graph, V, everything, MirrorPlane(0, 2.0))[:-2], True)
    assert not mirrored_set(*graph, V, everything, MirrorPlane(0, 2.0))[-2:].any()
    right = V[:, 0] == 4.0
    assert mirrored_set(*graph, V, right, MirrorPlane(0, 1.75))[:-2].sum() == 3
    assert not mirrored_set(*graph, V, right, MirrorPlane(0, 1.65)).any()
    assert not mirrored_set(*graph, V, right, MirrorPlane(0, -98.0)).any()
    ends = mirrored_set(*graph, V, right | (V[:, 0] == 0.0), MirrorPlane(0, 1.65))
    np.testing.assert_array_equal(ends[:-2], V[:-2, 0] == 3.0)


def test_mirrored_set_has_only_named_vertices_at_seams():
    V, F = box(2, 2, 2)
    U, skin, where = joined(V, F)
    image = mirrored_set(skin.start, skin.neighbour, U, U[:, 0] > 1.5, MirrorPlane(0, 1.0))
    assert set(np.flatnonzero(image)) <= set(skin.joined.ravel())
    assert sorted(where[image]) == np.flatnonzero(V[:, 0] < 0.5).tolist()


@given(triangles, st.integers(0, N - 1))
def test_component_of_a_vertex_is_what_can_be_reached(F, seed):
    assert set(np.flatnonzero(component_of(*vertex_neighbours(F, N), seed))) == set(rings(F, [seed]))


@given(triangles)
def test_opposite_half_edges_are_those_of_the_same_edge(F):
    expected = np.full(F.size, NON_MANIFOLD)
    for here in corners_of_edges(F).values():
        if len(here) == 1:
            expected[here] = BOUNDARY
        elif len(here) == 2:
            expected[here] = here[::-1]
    np.testing.assert_array_equal(opposite_half_edges(F, N).ravel(), expected)


@given(triangles, st.lists(st.integers(0, N - 1), max_size=3))
def test_border_loop_is_the_nearest_loop_of_a_border(F, seeds):
    edges = [tuple(edge) for edge, here in corners_of_edges(F).items() if len(here) == 1]
    loops = {v: {v} for edge in edges for v in edge}
    for v, w in edges:
        both = loops[v] | loops[w]
        loops |= dict.fromkeys(both, both)
    away = rings(F, seeds)
    nearest = min((away[v] for v in loops if v in away), default=None)
    found = set(
        np.flatnonzero(border_loop(F, opposite_half_edges(F, N), *vertex_neighbours(F, N), seeds)).tolist()
    )
    assert found in ([loops[v] for v in loops if away.get(v) == nearest] if nearest is not None else [set()])


def test_border_loop_is_an_end_of_a_tube_and_nothing_on_closed_surfaces():
    V, F = tube(12, 9)
    graph, opposite = vertex_neighbours(F, len(V)), opposite_half_edges(F, len(V))
    for seed, z in ((24, V[:, 2].min()), (12 * 7, V[:, 2].max())):
        loop = border_loop(F, opposite, *graph, np.array([seed]))
        np.testing.assert_array_equal(loop, np.abs(V[:, 2] - z) < 1e-9)
    V, F = sphere(1)
    loop = border_loop(F, opposite_half_edges(F, len(V)), *vertex_neighbours(F, len(V)), np.array([3]))
    assert (loop.shape, loop.any()) == ((len(V),), False)


def test_border_loop_takes_loops_that_touch_for_one():
    V, F = grid(6, 6)
    middle = V[F].mean(axis=1)
    hole, corner = np.abs(middle[:, :2] - 2.5).max(axis=1) < 0.5, (middle[:, :2] < 2).all(axis=1)
    seeds = np.array([np.flatnonzero((V == [3, 3, 0]).all(axis=1))[0]])
    graph = vertex_neighbours(F, len(V))
    for out, count in ((hole, 4), (hole | corner, 24 + 3)):
        left = F[~out]
        assert border_loop(left, opposite_half_edges(left, len(V)), *graph, seeds).sum() == count


@given(triangles, st.floats(0.0, 3.2), st.integers(0, 99))
def test_flood_fill_reaches_what_a_plain_search_reaches(F, crease, seed):
    U = np.random.default_rng(seed).normal(size=(N, 3))
    across = {h: here for here in corners_of_edges(F).values() if len(here) == 2 for h in here}
    normals = np.cross(U[F[:, 1]] - U[F[:, 0]], U[F[:, 2]] - U[F[:, 0]])
    todo, reached = [0], {0}
    while todo:
        t = todo.pop()
        for c in range(3):
            for h in set(across.get(3 * t + c, ())) - {3 * t + c}:
                s = h // 3
                side = -1 if F[s, h % 3] == F[t, c] else 1
                cosine = (
                    side * normals[s] @ normals[t] / np.linalg.norm(normals[s]) / np.linalg.norm(normals[t])
                )
                angle = np.arccos(np.clip(cosine, -1, 1))
                assume(abs(angle - crease) > 1e-5)
                if angle <= crease and s not in reached:
                    reached.add(s)
                    todo.append(s)
    member = flood_fill(F, opposite_half_edges(F, N), U, 0, crease)
    assert set(np.flatnonzero(member)) == set(F[list(reached)].ravel())


@pytest.mark.parametrize("torn", [False, True])
def test_flood_fill_on_a_cube_is_a_side_or_everything(torn):
    V, F = box(3, 3, 3)
    rng = np.random.default_rng(1)
    flipped = np.where((rng.random(len(F)) < 0.5)[:, None], F[:, ::-1], F)
    U, G = V, flipped.astype(np.int32)
    if torn:
        U, skin, _ = joined(V, flipped)
        G = skin.joined
    U = U @ rotation([1.0, 2.0, 3.0], 0.7).T
    opposite = opposite_half_edges(G, len(U))
    assert (opposite >= 0).all()
    for face in range(0, len(G), 7):
        axis = np.flatnonzero(np.ptp(V[F[face]], axis=0) == 0)[0]
        side = V[:, axis] == V[F[face, 0], axis]
        for degrees, expected in ((0, side), (1, side), (89, side), (91, side | True), (360, side | True)):
            member = flood_fill(G, opposite, U, face, np.deg2rad(degrees))
            assert set(map(tuple, U[member])) == set(
                map(tuple, (V @ rotation([1.0, 2.0, 3.0], 0.7).T)[expected])
            )


def test_flood_fill_goes_through_triangles_without_area_but_not_around_the_corner_by_them():
    # 4 lies on the edge from 0 to 1, and the triangle of these three closes the gap.
    V = np.array([[0.0, 0, 0], [2, 0, 0], [1, 2, 0], [1, -2, 0], [1, 0, 0]])
    F = np.array([[0, 4, 2], [4, 1, 2], [0, 1, 4], [1, 0, 3]], dtype=np.int32)
    opposite = opposite_half_edges(F, 5)
    for face in range(4):
        assert flood_fill(F, opposite, V, face, 0.1).all()
    V[3] = [1, 0, -2]
    assert np.flatnonzero(flood_fill(F, opposite, V, 0, 0.1)).tolist() == [0, 1, 2, 4]
    assert np.flatnonzero(flood_fill(F, opposite, V, 3, 0.1)).tolist() == [0, 1, 3, 4]
    assert flood_fill(F, opposite, V, 3, 1.6).all()


corners = st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), max_size=9)


@given(corners)
def test_is_inside_polygon_holds_points_from_which_a_ray_crosses_the_outline_an_odd_number_of_times(corners):
    x, y = np.meshgrid(np.arange(-1.0, 7.5, 0.5) + 0.21, np.arange(-1.0, 7.5, 0.5) + 0.17)
    points = np.column_stack([x.ravel(), y.ravel()])
    expected = np.zeros(len(points), dtype=bool)
    for i, (px, py) in enumerate(points.tolist()):
        for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1], strict=True):
            if (ay < py) != (by < py):
                expected[i] ^= Fraction(px) < ax + (Fraction(py) - ay) / (by - ay) * (bx - ax)
    polygon = np.array(corners, dtype=float).reshape(-1, 2)
    np.testing.assert_array_equal(is_inside_polygon(points, polygon), expected)
    np.testing.assert_array_equal(is_inside_polygon(points, polygon[::-1].copy()), expected)


def test_is_inside_polygon_leaves_out_the_middle_of_a_star_and_what_is_no_number():
    angle = np.arange(5) * 4 * np.pi / 5
    star = np.column_stack([np.sin(angle), np.cos(angle)])
    points = np.array([[0.0, 0.0], [0.0, 0.9], [0.0, 1.1], [np.nan, 0.0], [0.0, np.nan], [np.inf, 0.0]])
    assert is_inside_polygon(points, star).tolist() == [False, True, False, False, False, False]
    assert is_inside_polygon(np.empty((0, 2)), star).shape == (0,)


def test_is_inside_polygon_finds_every_point_once_in_tiles_that_share_their_sides():
    tiles = [np.array([[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1.0]]) for x in range(3) for y in range(3)]
    points = np.stack(np.meshgrid(np.arange(0, 3, 0.5), np.arange(0, 3, 0.5)), axis=-1).reshape(-1, 2)
    assert (sum(is_inside_polygon(points, tile).astype(int) for tile in tiles) == 1).all()


def test_vertex_sets_welcome_read_only_arrays():
    V, F = sphere(1)
    skin, U = SurfaceIndex.from_triangles(F, len(V)), V.copy()
    U.setflags(write=False)
    member = U[:, 2] > 0
    member.setflags(write=False)
    graph, opposite = (skin.start, skin.neighbour), opposite_half_edges(skin.joined, len(U))
    assert smoothed_set(*graph, U, member).any()
    assert mirrored_set(*graph, U, member, MirrorPlane(2, 0.0)).any()
    assert flood_fill(skin.joined, opposite, U, 0, 4.0).all()
    assert component_of(*graph, 5).all()
