"""Laws of areas, volumes, normals, cotangents, weights and the Laplacian."""

import igl
import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays
from meshes import box, grid, rotation, sphere, tube

from apd_viewer.geometry.mesh.operators import (
    area,
    cotangents,
    edge_weights,
    face_areas,
    laplacian,
    vertex_areas,
    vertex_neighbours,
    volume,
)
from apd_viewer.geometry.mesh.weighted_areas import Patch

MESHES = {
    "grid": grid(4, 3, 1.0, 0.3),
    "box": box(2, 1, 3),
    "sphere": sphere(1),
    "tube": tube(8, 5),
    "obtuse tube": tube(8, 5, height=1.0, shear=0.8),
}
every_mesh = pytest.mark.parametrize("mesh", MESHES.values(), ids=MESHES.keys())
triangles = arrays(float, (3, 3), elements=st.floats(-1e3, 1e3))
CUBE = box(1, 1, 1)
ONE = np.array([[0, 1, 2]])


def test_area_of_half_a_unit_square_is_one_half():
    V = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    assert face_areas(V, ONE).tolist() == [0.5]
    assert area(V, ONE) == 0.5


@given(triangles, st.floats(1e-3, 1e3))
def test_area_grows_with_the_square_of_the_size(V, s):
    assert area(s * V, ONE) == pytest.approx(s * s * area(V, ONE), rel=1e-9, abs=1e-9 * s * s)


@given(triangles)
def test_area_is_half_the_product_of_base_and_height(V):
    base = np.linalg.norm(V[1] - V[0])
    direction = (V[1] - V[0]) / base if base else np.zeros(3)
    side = V[2] - V[0]
    height = np.linalg.norm(side - (side @ direction) * direction)
    assert area(V, ONE) == pytest.approx(base * height / 2, rel=1e-9, abs=1e-6)


@every_mesh
def test_area_does_not_depend_on_the_pose_or_the_orientation(mesh):
    V, F = mesh
    turned = V @ rotation([1, 2, 3], 1.0).T + [5.0, -3.0, 2.0]
    assert area(turned, F[:, ::-1]) == pytest.approx(area(V, F), rel=1e-13)


@every_mesh
def test_vertex_areas_share_out_the_area(mesh):
    V, F = mesh
    V = np.vstack([V, [[9.0, 9.0, 9.0]]])  # of no face
    shares = vertex_areas(V, F)
    assert shares.shape == (len(V),)
    assert shares.sum() == pytest.approx(area(V, F), rel=1e-13)
    assert (shares[:-1] > 0).all()
    assert shares[-1] == 0.0
    assert shares[0] == pytest.approx(face_areas(V, F)[(F == 0).any(axis=1)].sum() / 3, rel=1e-13)


def test_volume_of_a_unit_cube_is_one():
    assert volume(*CUBE) == pytest.approx(1.0, rel=1e-15)


@given(arrays(float, 3, elements=st.floats(-1e6, 1e6)), st.floats(0.0, 7.0))
def test_volume_does_not_depend_on_the_pose(shift, angle):
    V, F = CUBE
    assert volume(V @ rotation([1, -2, 1], angle).T + shift, F) == pytest.approx(1.0, rel=1e-9)


def test_volume_far_from_the_origin_is_as_exact_with_an_unused_first_vertex():
    V, F = sphere(1)
    far = np.vstack([np.zeros((1, 3)), V + 1e6])
    # The rounding of the positions themselves costs 1e-10.
    assert volume(far, F + 1) == pytest.approx(volume(V, F), rel=1e-9)


def test_volume_of_a_ball_and_its_sign():
    V, F = sphere(4)
    assert volume(V, F) == pytest.approx(4 / 3 * np.pi, rel=5e-3)
    assert volume(V, F) < 4 / 3 * np.pi
    assert volume(V, F[:, ::-1]) == pytest.approx(-volume(V, F), rel=1e-13)
    assert volume(V * [1, 1, -1], F) == pytest.approx(-volume(V, F), rel=1e-13)
    assert volume(3 * V, F) == pytest.approx(27 * volume(V, F), rel=1e-13)


@every_mesh
def test_cotangents_are_those_of_the_angles(mesh):
    V, F = mesh
    for c in range(3):
        a, b = V[F[:, (c + 1) % 3]] - V[F[:, c]], V[F[:, (c + 2) % 3]] - V[F[:, c]]
        cosine = (a * b).sum(axis=1) / np.linalg.norm(a, axis=1) / np.linalg.norm(b, axis=1)
        angle = np.arccos(np.clip(cosine, -1, 1))
        assert cotangents(V, F)[:, c] == pytest.approx(1 / np.tan(angle), abs=1e-9)


def test_cotangents_of_a_triangle_without_area_are_zero():
    V = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]])
    assert (cotangents(V, np.array([[0, 1, 2], [0, 0, 1], [1, 1, 1]])) == 0.0).all()


def weights(V, F):
    return edge_weights(V, Patch(F, len(V)))


def weights_by_hand(V, F):
    W = np.zeros((len(V), len(V)))
    for f in F:
        for c in range(3):
            k, i, j = f[c], f[(c + 1) % 3], f[(c + 2) % 3]
            a, b = V[i] - V[k], V[j] - V[k]
            cot = a @ b / np.linalg.norm(np.cross(a, b))
            W[i, j] += max(0.0, cot) / 2
            W[j, i] += max(0.0, cot) / 2
    return W


def wheel(spokes=100):
    """A vertex with more edges than are sorted by insertion."""
    angle = np.linspace(0.0, 2.0 * np.pi, spokes, endpoint=False)
    rim = np.column_stack([np.cos(angle), np.sin(angle), np.cos(7 * angle)])
    i = np.arange(spokes)
    return np.vstack([rim, np.zeros(3)]), np.column_stack([i, (i + 1) % spokes, np.full(spokes, spokes)])


def soup(n=40, count=200):
    """Triangles between random vertices, so that edges have several."""
    rng = np.random.default_rng(1)
    return rng.normal(size=(n, 3)), np.array([rng.permutation(n)[:3] for _ in range(count)])


@pytest.mark.parametrize("mesh", [*MESHES.values(), wheel(), soup()], ids=[*MESHES, "wheel", "soup"])
def test_edge_weights_are_those_of_the_formula(mesh):
    V, F = mesh
    W = weights(V, F)
    assert np.abs(W.toarray() - weights_by_hand(V, F)).max() <= 1e-13 * max(1.0, W.data.max())
    assert W.has_canonical_format, "columns ascend, each once"
    edges = np.sort(np.vstack([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]), axis=1)
    assert W.nnz == 2 * len(np.unique(edges, axis=0)), "edges of weight zero are stored"


def test_edge_weights_clamp_each_cotangent_by_itself():
    # Edge 0-1 sees an obtuse corner with cotangent -3/4 at vertex 2 and an acute one with 1 at vertex 3.
    V = np.array([[-2.0, 0, 0], [2, 0, 0], [0, 1, 0], [0, -2 * (1 + 2**0.5), 0]])
    F = np.array([[0, 1, 2], [1, 0, 3]])
    cot = cotangents(V, F)
    assert cot[0, 2] == pytest.approx(-3 / 4)
    assert cot[1, 2] == pytest.approx(1.0)
    assert weights(V, F)[0, 1] == pytest.approx(0.5)


@pytest.mark.parametrize("name", ["sphere", "tube"])
def test_laplacian_is_that_of_libigl_where_all_angles_are_acute(name):
    V, F = MESHES[name]
    assert np.abs((laplacian(weights(V, F)) + igl.cotmatrix(V, F)).toarray()).max() <= 1e-12


def one_vertex_without_weight():
    """A grid with one more vertex in the middle of an inner edge, joined by flat triangles alone."""
    V, F = grid(4, 4)
    i, j = F[0, 1], F[0, 2]
    return np.vstack([V, V[[i, j]].mean(axis=0)]), np.vstack([F, [[i, len(V), j]]])


@pytest.mark.parametrize("mesh", [*MESHES.values(), one_vertex_without_weight()], ids=[*MESHES, "flat fan"])
def test_laplacian_is_symmetric_semi_definite_and_kills_constants(mesh):
    W = weights(*mesh)
    L = laplacian(W).toarray()
    assert np.array_equal(W.toarray(), W.toarray().T)
    assert W.diagonal().max() == 0.0
    assert W.data.min() >= 0.0
    assert np.array_equal(L, L.T)
    assert np.abs(L.sum(axis=1)).max() <= 1e-13 * np.abs(L).max()
    values = np.linalg.eigvalsh(L)
    assert values[0] >= -1e-13 * values[-1]
    # One piece: constants are all that it kills.
    assert values[1] > 1e-9 * values[-1]


def test_edge_weights_have_a_tiny_floor_and_only_where_it_is_needed():
    V, F = one_vertex_without_weight()
    W, without = weights(V, F).toarray(), weights(V[:-1], F[:-1]).toarray()
    assert np.abs(W[:-1, :-1] - without).max() <= 1e-13
    assert 0 < W[-1].max() <= 1e-5 * without.max()


def test_edge_weights_do_not_depend_on_size_or_place():
    V, F = MESHES["obtuse tube"]
    expected = weights(V, F).toarray()
    for s in (1e-6, 1e6):
        assert np.abs(weights(s * V, F).toarray() - expected).max() <= 1e-12
    assert np.abs(weights(V + 1e6, F).toarray() - expected).max() <= 1e-8


@every_mesh
def test_vertex_neighbours_are_the_other_ends_of_the_edges(mesh):
    V, F = mesh
    F = np.vstack([F, [[0, 0, 1], [2, 2, 2]]])
    expected = [set() for _ in V]
    for f in F.tolist():
        for a, b in zip(f, f[1:] + f[:1], strict=True):
            if a != b:
                expected[a].add(b)
                expected[b].add(a)
    start, neighbour = vertex_neighbours(F, len(V) + 1)
    rings = [neighbour[start[i] : start[i + 1]].tolist() for i in range(len(V) + 1)]
    assert rings == [sorted(ring) for ring in expected] + [[]]
