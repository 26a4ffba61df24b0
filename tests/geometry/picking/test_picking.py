import numpy as np
import pytest
import scipy.sparse as sp
import trimesh

from apd_viewer.geometry.mesh.operators import vertex_neighbours
from apd_viewer.geometry.picking.picking import BLOCK, block_boxes, ray_hit, vertices_under_brush


@pytest.fixture(scope="module")
def slab():
    """A closed plate, 2 x 2 and 0.02 thick, with edges much longer than it is thick."""
    mesh = trimesh.creation.box(extents=(2.0, 2.0, 0.02)).subdivide_to_size(0.11)
    mesh.merge_vertices()
    assert mesh.is_watertight
    return np.array(mesh.faces, dtype=np.int32), np.array(mesh.vertices)


def rays(count, seed=3):
    rng = np.random.default_rng(seed)
    origin = rng.normal(size=(count, 3)) * 3
    direction = rng.normal(size=(count, 3)) * 0.4 - origin
    return zip(origin, direction / np.linalg.norm(direction, axis=1, keepdims=True), strict=True)


def nearest_by_linear_algebra(origin, direction, U, F):
    """Solve for every triangle, and keep the nearest of those that are met."""
    a = U[F[:, 0]]
    A = np.stack([U[F[:, 1]] - a, U[F[:, 2]] - a, np.broadcast_to(-direction, a.shape)], axis=2)
    b1, b2, t = np.linalg.solve(A, (origin - a)[..., None])[..., 0].T
    met = (b1 >= 0) & (b2 >= 0) & (b1 + b2 <= 1) & (t > 0)
    return np.where(met, t, np.inf).min()


def test_ray_hit_meets_what_linear_algebra_says_it_meets():
    mesh = trimesh.creation.torus(1.0, 0.4, major_sections=40, minor_sections=20)
    U, F = np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int32)
    met = 0
    for origin, direction in rays(200):
        face, distance, b1, b2 = ray_hit(origin, direction, U, F, block_boxes(U, F))
        assert distance == pytest.approx(nearest_by_linear_algebra(origin, direction, U, F), abs=1e-9)
        if face >= 0:
            met += 1
            corners = np.array([1 - b1 - b2, b1, b2]) @ U[F[face]]
            np.testing.assert_allclose(corners, origin + distance * direction, atol=1e-9)
    assert 50 < met < 200


def test_block_boxes_hide_nothing_that_one_look_at_all_triangles_finds():
    """Flat triangles along the axes and rays along them, on their very edges, far from the origin or not."""
    rng = np.random.default_rng(7)
    U = rng.integers(0, 6, size=(900, 3)).astype(float)
    F = rng.integers(0, len(U), size=(5 * BLOCK + 1, 3)).astype(np.int32)
    everything = np.tile(np.array([[-np.inf] * 3, [np.inf] * 3]), (6, 1, 1))
    ways = rng.integers(-1, 2, size=(300, 3)).astype(float)
    met = 0
    for shift in (0.0, 1e5):
        around = block_boxes(U + shift, F)
        assert around.shape == everything.shape
        for direction in ways[ways.any(axis=1)]:
            origin = rng.integers(0, 6, size=3) + shift - 9.0 * direction
            hit = ray_hit(origin, direction, U + shift, F, around)
            assert hit == ray_hit(origin, direction, U + shift, F, everything)
            met += hit[0] >= 0
    assert met > 100


def test_ray_hit_says_so_when_it_meets_nothing(slab):
    F, U = slab
    assert ray_hit(np.array([0.0, 0.0, 5.0]), np.array([0.0, 0.0, 1.0]), U, F, block_boxes(U, F))[:2] == (
        -1,
        np.inf,
    )


def test_ray_hit_meets_a_face_from_behind():
    U, F = np.eye(3), np.array([[0, 1, 2]], dtype=np.int32)
    towards = np.ones(3) / np.sqrt(3)
    assert ray_hit(np.zeros(3), towards, U, F, block_boxes(U, F))[0] == 0
    assert ray_hit(2 * towards, -towards, U, F, block_boxes(U, F))[0] == 0


def test_ray_hit_never_meets_degenerate_triangles():
    U, F = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]), np.array([[0, 1, 2], [1, 1, 1]], dtype=np.int32)
    assert ray_hit(np.array([0.5, 0.0, 1.0]), np.array([0.0, 0.0, -1.0]), U, F, block_boxes(U, F))[0] == -1


def capsule_component(F, U, seeds, a, b, radius):
    """Oracle: vertices in the capsule that are connected to a seed within it, by scipy."""
    d = b - a
    t = np.clip((U - a) @ d / max(d @ d, 1e-300), 0, 1)
    within = np.linalg.norm(U - a - t[:, None] * d, axis=1) <= radius
    i, j = F[:, [0, 1, 2]].ravel(), F[:, [1, 2, 0]].ravel()
    kept = within[i] & within[j]
    graph = sp.coo_array((np.ones(kept.sum()), (i[kept], j[kept])), shape=(len(U), len(U)))
    _, component = sp.csgraph.connected_components(graph, directed=False)
    inner = [s for s in seeds if within[s]]
    found = within & np.isin(component, component[inner])
    found[seeds[np.argmin(np.linalg.norm(U[seeds] - b, axis=1))]] = True
    return np.flatnonzero(found)


@pytest.mark.parametrize("radius", [0.001, 0.1, 0.3, 0.7, 5.0])
def test_vertices_under_brush_covers_the_connected_part_of_the_capsule(slab, radius):
    F, U = slab
    graph = vertex_neighbours(F, len(U))
    rng = np.random.default_rng(5)
    for _ in range(20):
        faces = rng.integers(len(F), size=2)
        a, b = U[F[faces]].mean(axis=1)
        seeds = F[faces].ravel()
        covered = vertices_under_brush(*graph, U, seeds, a, b, radius)
        assert len(np.unique(covered)) == len(covered)
        np.testing.assert_array_equal(np.sort(covered), capsule_component(F, U, seeds, a, b, radius))


def test_vertices_under_brush_does_not_bleed_through_a_thin_wall(slab):
    F, U = slab
    graph = vertex_neighbours(F, len(U))
    face, distance, _, _ = ray_hit(
        np.array([0.05, 0.02, 1.0]), np.array([0.0, 0.0, -1.0]), U, F, block_boxes(U, F)
    )
    hit = np.array([0.05, 0.02, 1.0 - distance])
    covered = vertices_under_brush(*graph, U, F[face], hit, hit, 0.6)
    ball = np.flatnonzero(np.linalg.norm(U - hit, axis=1) <= 0.6)
    assert len(covered) > 50
    assert (U[covered, 2] > 0).all()
    np.testing.assert_array_equal(np.sort(covered), ball[U[ball, 2] > 0])


def test_vertices_under_brush_finer_than_the_mesh_paints_the_nearest_corner(slab):
    F, U = slab
    graph = vertex_neighbours(F, len(U))
    hit = 0.6 * U[F[7, 1]] + 0.2 * U[F[7, 0]] + 0.2 * U[F[7, 2]]
    assert vertices_under_brush(*graph, U, F[7], hit, hit, 1e-6).tolist() == [F[7, 1]]


def test_ray_hit_towards_a_vertex_meets_the_surface_there():
    """It meets only corners of triangles, where each one alone may round it away."""
    mesh = trimesh.creation.icosphere(subdivisions=3)
    U, F = np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int32)
    around = block_boxes(U, F)
    eye = np.array([3.1, 2.3, 1.7])
    front = U[np.einsum("ij,ij->i", mesh.vertex_normals, eye - U) > 0.2]
    assert len(front) > 100
    for vertex in front:
        way = (vertex - eye) / np.linalg.norm(vertex - eye)
        _, distance, *_ = ray_hit(eye, way, U, F, around)
        assert distance == pytest.approx(np.linalg.norm(vertex - eye), abs=1e-9)
