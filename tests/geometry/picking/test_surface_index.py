"""What is drawn and touched of a mesh."""

import numpy as np
import pytest
from meshes import box, grid, soup, sphere

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.operators import vertex_neighbours
from apd_viewer.geometry.picking.preview_surface import PreviewSurface
from apd_viewer.geometry.picking.render_mesh import write_render_arrays
from apd_viewer.geometry.picking.surface_index import SurfaceIndex
from apd_viewer.geometry.warmup import warm_up


def draped(skin, U, origin=(0.0, 0.0, 0.0)):
    points, normals = np.full((2, *np.shape(U)), np.nan, dtype=np.float32)
    low, high = skin.render_mesh(False).write_render_arrays(
        frozen(np.array(U, dtype=float)), np.array(origin), points, normals
    )
    return points, normals, low, high


def test_surface_index_normals_of_a_ball_point_outwards_and_have_length_one():
    V, F = sphere(2)
    V = np.vstack([V, [[9.0, 9.0, 9.0]]])
    _, N, _, _ = draped(SurfaceIndex.from_triangles(F, len(V)), V)
    assert np.abs(N[:-1] - V[:-1]).max() <= 0.05
    assert np.abs(np.linalg.norm(N[:-1], axis=1) - 1).max() <= 1e-6
    assert (N[-1] == 0.0).all()
    flipped = draped(SurfaceIndex.from_triangles(F[:, ::-1], len(V)), V)[1]
    assert np.abs(N + flipped).max() <= 1e-6


def test_surface_index_normals_are_weighted_by_area():
    V = np.array([[0.0, 0, 0], [3, 0, 0], [0, 1, 0], [0, 0, 1]])
    N = draped(SurfaceIndex.from_triangles(np.array([[0, 1, 2], [0, 2, 3]]), 4), V)[1]
    # 3/2 facing z and 1/2 facing x.
    assert pytest.approx([1 / 10**0.5, 0, 3 / 10**0.5], abs=1e-6) == N[0]


def test_surface_index_normals_are_alike_on_both_sides_of_a_seam():
    V, F = box(2, 2, 3)
    mesh = Mesh(*soup(V, F))
    whole = draped(SurfaceIndex.from_triangles(F, len(V)), V)[1]
    torn = draped(SurfaceIndex.from_triangles(mesh.F, len(mesh.V), mesh.joined_F), mesh.V)[1]
    np.testing.assert_array_equal(torn, whole[F.ravel()])


def test_write_render_arrays_shows_points_from_the_origin_and_gives_the_box_of_the_triangles():
    """Far away single precision would be coarser than the mesh; a vertex without a face is not drawn."""
    V, F = grid(3, 3)
    V = np.vstack([V, [[-50.0, 70.0, 10.0]]]) + 1e8
    points, _, low, high = draped(SurfaceIndex.from_triangles(F, len(V)), V, (1e8, 1e8, 1e8))
    np.testing.assert_array_equal(points, V - 1e8)
    assert (low.tolist(), high.tolist()) == ([0.0, 0.0, 0.0], [3.0, 3.0, 0.0])


def test_surface_index_keeps_a_mesh_without_seams_once():
    V, F = box(1, 1, 2)
    mesh = Mesh(V, F)
    skin = SurfaceIndex.from_triangles(F, len(V), mesh.joined_F)
    assert skin.joined is skin.F
    assert len(skin.source) == 0
    for mine, expected in zip((skin.start, skin.neighbour), vertex_neighbours(F, len(V)), strict=True):
        np.testing.assert_array_equal(mine, expected)
    kept = [*vars(skin).values(), *vars(skin.sharp).values()]
    assert not any(each.flags.writeable for each in kept if isinstance(each, np.ndarray))


def test_vertices_under_brush_goes_on_across_a_seam_and_names_each_place_once():
    V, F = box(2, 2, 2)
    mesh = Mesh(*soup(V, F))
    skin = SurfaceIndex.from_triangles(mesh.F, len(mesh.V), mesh.joined_F)
    centre = mesh.V[mesh.F[0]].mean(axis=0)
    under = skin.vertices_under_brush(mesh.V, (0, 0), centre, centre, 100.0)
    assert sorted(map(tuple, mesh.V[under])) == sorted(map(tuple, V))


def test_warm_up_compiles_what_a_window_calls():
    warm_up("window")
    compiled = len(write_render_arrays.signatures)
    V, F = box(1, 1, 1)
    draped(SurfaceIndex.from_triangles(F, len(V)), V)
    torn = Mesh(*soup(V, F))
    draped(SurfaceIndex.from_triangles(torn.F, len(torn.V), torn.joined_F), torn.V)
    assert len(write_render_arrays.signatures) == compiled


def test_preview_surface_looks_like_what_it_stands_in_for():
    V, F = sphere(2)
    V = np.vstack([V + 100.0, [[-9.0, 9.0, 9.0]]])
    origin = np.full(3, 100.0)
    skin, sketch = (
        draped(SurfaceIndex.from_triangles(F, len(V)), V, origin),
        draped(PreviewSurface(F), V, origin),
    )
    for mine, expected in zip(sketch, skin, strict=True):
        np.testing.assert_allclose(mine, expected, atol=1e-6)
