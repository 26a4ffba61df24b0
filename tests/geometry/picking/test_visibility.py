"""Which vertices an eye sees."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from meshes import box, grid, moved, rotation, soup, sphere, tube

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.picking.bounding_hierarchy import BRANCHING, bounding_hierarchy
from apd_viewer.geometry.picking.surface_index import TOUCHING_DISTANCE, SurfaceIndex, is_visible


def seen(eye, U, F, ids=None):
    ids = np.arange(len(U)) if ids is None else ids
    return is_visible(
        np.array(eye, dtype=float), U, bounding_hierarchy(U, np.asarray(F, dtype=np.int32)), ids
    )


def seen_by_linear_algebra(eye, U, F, ids):
    """Oracle: solve for every triangle that does not have the vertex."""
    found = []
    for v in ids:
        T = F[(v != F).all(axis=1)]
        a, d = U[T[:, 0]], U[v] - eye
        A = np.stack([U[T[:, 1]] - a, U[T[:, 2]] - a, np.broadcast_to(-d, a.shape)], axis=2)
        good = np.abs(np.linalg.det(A)) > 1e-12
        b1, b2, t = np.linalg.solve(A[good], (eye - a[good])[..., None])[..., 0].T
        met = (b1 >= 0) & (b2 >= 0) & (b1 + b2 <= 1) & (t > 0) & (t < 1 - TOUCHING_DISTANCE)
        found.append(not met.any())
    return np.array(found)


def cup(around=24, wall=0.03):
    """A closed cup of radius and height 1 about the z axis, with thin walls, and where its inside is."""
    rise = np.linspace(wall, 1.0, 7)
    inner = [(r, wall) for r in (0.3, 0.6)] + [(1 - wall, z) for z in rise]
    outer = [(1.0, z) for z in np.linspace(1.0, 0.0, 8)] + [(r, 0.0) for r in (0.6, 0.3)]
    angle = np.arange(around) * 2 * np.pi / around
    V = [(r * np.cos(a), r * np.sin(a), z) for r, z in inner + outer for a in angle]
    k, count = np.arange(around), len(inner) + len(outer)
    following = (k + 1) % around
    F = []
    for i in range(count - 1):
        a, b = i * around + k, i * around + following
        F += [np.column_stack([a, b, b + around]), np.column_stack([a, b + around, a + around])]
    first, last = len(V), len(V) + 1
    F += [np.column_stack([np.full(around, first), following, k])]
    F += [np.column_stack([np.full(around, last), k, following]) + (count - 1) * around * np.array([0, 1, 1])]
    V = np.array([*V, (0.0, 0.0, wall), (0.0, 0.0, 0.0)])
    within = np.arange(len(V)) < (len(inner) + 1) * around
    within[first] = True
    return V, np.vstack(F).astype(np.int32), within


def test_is_visible_from_above_is_the_inside_of_a_cup_and_nothing_of_its_outside():
    V, F, within = cup()
    for tilt in (0.0, 0.01):
        np.testing.assert_array_equal(seen([tilt, 0.0, 4.0], V, F), within)
    below = seen([0.0, 0.0, -9.0], V, F)
    np.testing.assert_array_equal(below, V[:, 2] == 0.0)
    aside = seen([9.0, 0.3, 0.5], V, F)
    assert not aside[within & (V[:, 2] < 1.0)].any()
    assert aside[~within & (V[:, 0] > 0.5) & (V[:, 2] > 0.0)].all()


@pytest.mark.parametrize("way", [[0.3, 0.2, 0.9], [-1.0, 0.1, 0.2], [0.5, -2.0, -0.4]])
@pytest.mark.parametrize("distance", [0.4, 1.7, 30.0])
def test_is_visible_is_what_linear_algebra_says_for_each_triangle(way, distance):
    eye = distance * np.array(way)
    for V, F in (cup()[:2], sphere(3), tube(20, 9, height=2.0)):
        ids = np.arange(0, len(V), 1 + len(V) // 90)
        found = seen(eye, V, F, ids)
        np.testing.assert_array_equal(found, seen_by_linear_algebra(eye, V, F, ids))
    assert found.any()


@given(
    st.integers(0, 10**6),
    st.sampled_from([1, BRANCHING - 1, BRANCHING + 1, BRANCHING**2, BRANCHING**2 + 1, 600]),
)
def test_bounding_hierarchy_hides_no_triangle(seed, count):
    """Triangles of all sizes in no order."""
    rng = np.random.default_rng(seed)
    middle, size = rng.normal(size=(count, 1, 3)), rng.choice([0.02, 0.2, 1.0], size=(count, 1, 1))
    V = (middle + size * rng.normal(size=(count, 3, 3))).reshape(-1, 3)
    F = np.arange(len(V), dtype=np.int32).reshape(-1, 3)
    eye, ids = rng.normal(size=3) * 2, rng.integers(len(V), size=20)
    np.testing.assert_array_equal(seen(eye, V, F, ids), seen_by_linear_algebra(eye, V, F, ids))


@pytest.mark.parametrize("shift", [0.0, 1e5])
def test_is_visible_lets_no_ray_slip_through_between_two_triangles(shift):
    """Those to the far side pass exactly through vertices and edges of the near one."""
    V, F = box(4, 4, 4)
    for axis in range(3):
        for end, eye in ((4.0, 8.0), (0.0, -4.0)):
            middle = np.where(np.arange(3) == axis, eye, 2.0)
            np.testing.assert_array_equal(seen(middle + shift, V + shift, F), V[:, axis] == end)


def test_is_visible_is_all_within_a_ball_and_outside_it_the_corners_of_what_faces_the_eye():
    V, F = sphere(3)
    assert seen([0.1, 0.2, 0.3], V, F).all()
    eye = np.array([0.2, 0.5, 2.0])
    normals = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    facing = ((eye - V[F[:, 0]]) * normals).sum(axis=1) > 0.0
    assert set(np.flatnonzero(seen(eye, V, F))) == set(F[facing].ravel())


def test_is_visible_depends_neither_on_the_order_of_triangles_nor_on_a_rigid_motion():
    V, F, _ = cup()
    eye, rng = np.array([2.0, 1.1, 1.7]), np.random.default_rng(5)
    expected = seen(eye, V, F)
    assert 0.2 < expected.mean() < 0.8
    np.testing.assert_array_equal(seen(eye, V, F[rng.permutation(len(F))][:, [2, 0, 1]]), expected)
    carried = moved(np.vstack([V, [eye]]), rotation([1.0, 1.0, 0.2], 1.3), (5.0, 6.0, 7.0))
    np.testing.assert_array_equal(seen(carried[-1], carried[:-1], F), expected)


def test_is_visible_sees_a_mesh_of_seams_as_if_it_were_whole():
    V, F = box(3, 3, 3)
    torn = Mesh(*soup(V, F))
    skin, eye = SurfaceIndex.from_triangles(torn.F, len(torn.V), torn.joined_F), [5.0, 6.0, 8.0]
    named = np.unique(skin.joined)
    np.testing.assert_array_equal(
        seen(eye, torn.V, skin.joined, named), seen(eye, V, F)[np.ravel(F)[named]], strict=True
    )


def test_is_visible_does_not_hide_a_vertex_behind_what_touches_it():
    """Two sheets of unjoined triangles at one place, and a third behind them by more than the tolerance."""
    V, F = grid(3, 3)
    sheets = np.vstack([V, V + [0, 0, 1e-8], V - [0, 0, 1e-3]])
    found = seen([1.4, 1.3, 5.0], sheets, np.vstack([F, F + len(V), F + 2 * len(V)])).reshape(3, -1)
    assert found[:2].all()
    inner = (V[:, :2] > 0).all(axis=1) & (V[:, :2] < 3).all(axis=1)
    assert not found[2, inner].any()


def test_is_visible_lets_triangles_without_area_or_seen_edge_on_hide_nothing():
    V = np.array([[0.0, 0, 0], [-1, 0, 1], [1, 0, 1], [0, 0, 1], [0, -1, 2], [0, 1, 2], [0, 0, 3]])
    F = np.array([[1, 2, 3], [2, 2, 2], [4, 5, 6]], dtype=np.int32)
    for angle in range(30):
        turned = np.vstack([V, [[0.0, 0, 9]]]) @ rotation([1.0, 2.0, 3.0], angle).T
        assert seen(turned[-1], turned[:-1], F, np.array([0])).all()


def test_is_visible_works_with_nothing_asked_or_in_the_way():
    V, F = sphere(1)
    assert seen([0.0, 0.0, 9.0], V, F, np.empty(0, dtype=np.int64)).shape == (0,)
    assert seen([0.0, 0.0, 9.0], V, np.empty((0, 3), dtype=np.int32)).all()
    assert seen(V[5], V, F, np.array([5])).all()


def test_is_visible_welcomes_read_only_arrays():
    V, F = sphere(1)
    skin, U = SurfaceIndex.from_triangles(F, len(V)), V.copy()
    U.setflags(write=False)
    np.testing.assert_array_equal(seen([0.0, 0.5, 9.0], U, skin.joined), seen([0.0, 0.5, 9.0], V, F))
