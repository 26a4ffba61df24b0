"""Boundary edges that lie on others are said, and welded on request; the file keeps its vertices."""

import numpy as np
import pytest
from meshes import box, grid, soup
from seams import half, halves, twisted

import apd_viewer
from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.geometry.analysis.shape_check import SEAMS
from apd_viewer.geometry.mesh import seams as seams_module
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.mesh.edges_and_components import opposite_half_edges
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.seams import Seams
from apd_viewer.geometry.mesh.weld import SEAM_TOLERANCE, Weld

ROWS = 12


def seams(V, F):
    weld = Weld.from_positions(V, F)
    return Seams.from_mesh(V, F, weld, opposite_half_edges(weld.representative[F], len(V)))


def kinds(mesh):
    return [finding.kind for finding in inspect(mesh).findings]


def torn(V, F, U):
    """Distances of vertices in ``U`` that are copies of one place in ``V``."""
    to = Mesh(V, F).welded().weld.representative
    apart = np.flatnonzero(to != np.arange(len(V)))
    return np.linalg.norm(U[apart] - U[to[apart]], axis=1)


@pytest.mark.parametrize("by", [1e-6, 1e-5, 0.9 * SEAM_TOLERANCE])
def test_seams_whose_sides_nearly_meet_are_said_and_welded(by):
    V, F = halves(by)
    mesh = Mesh(V, F)
    assert SEAMS in kinds(mesh)
    found = seams(V, F)
    assert len(found.edges) == 4 * ROWS, "two seams, two sides each"
    assert found.gap == pytest.approx(by * diagonal(V), rel=1e-3)
    welded = mesh.welded()
    assert len(welded.weld.first) == len(V) - 2 * (ROWS + 1)
    assert SEAMS not in kinds(welded)
    assert inspect(welded).components == 1
    assert welded.V is mesh.V
    assert welded.F is mesh.F


@pytest.mark.parametrize("method", ["exact", "local", "arap"])
def test_deform_twists_a_welded_tube_as_a_whole_one(method):
    V, F = halves(1e-5)
    whole, _ = halves(0.0)
    fixed, handle, targets = twisted(V, 0.5 * np.pi)
    open_ = apd_viewer.deform(V, F, fixed, targets, method, handle=handle)
    assert torn(V, F, open_.U).max() > 0.1, "as the warning says"
    assert any("weld" in sentence for sentence in open_.warnings)
    result = apd_viewer.deform(V, F, fixed, targets, method, handle=handle, weld=True)
    assert torn(V, F, result.U).max() < 1.1e-5 * diagonal(V)
    assert not any("weld" in sentence for sentence in result.warnings)
    fixed, handle, targets = twisted(whole, 0.5 * np.pi)
    exact = apd_viewer.deform(whole, F, fixed, targets, method, handle=handle)
    assert result.volume_capped == pytest.approx(exact.volume_capped, rel=1e-4)
    assert np.abs(result.U - exact.U).max() < 1e-2


def test_weld_spread_leaves_what_does_not_move_where_it_was_to_the_bit():
    V, F = halves(3.3e-5)
    weld = Mesh(V + [1e-4, 3e-5, 1e-3], F).welded().weld
    assert np.array_equal(weld.to_file_vertices(weld.V[weld.first]), weld.V)


def test_seams_beyond_the_tolerance_are_neither_said_nor_welded():
    V, F = halves(1.5 * SEAM_TOLERANCE)
    assert SEAMS not in kinds(Mesh(V, F))
    assert len(Mesh(V, F).welded().weld.first) == len(V)


def test_mesh_welded_leaves_details_smaller_than_the_tolerance_alone():
    """An open speck, far smaller than the tolerance of the mesh that it belongs to."""
    V, F = halves(0.0)
    small, G = grid(5, 5)
    W = np.vstack([V, 1e-6 * small + 3.0])
    welded = Mesh(W, np.vstack([F, G + len(V)])).welded()
    corners = welded.joined_F[len(F) :]
    assert len(np.unique(corners)) == len(small), "the speck keeps all its vertices"


@pytest.mark.parametrize("seed", range(4))
def test_mesh_welded_collapses_no_edge_wherever_vertices_are_near(seed):
    """Chains a, b, c of near vertices: loose triangles of a fine grid, all within the tolerance."""
    rng = np.random.default_rng(seed)
    V, F = soup(*grid(6, 6, 2e-4, 2e-4))
    V = V + 6e-5 * rng.normal(size=V.shape)
    W, G = (
        np.vstack([V, [[0, 0, 1], [4, 0, 1], [0, 4, 1]]]),
        np.vstack([F, [[len(V), len(V) + 1, len(V) + 2]]]),
    )
    joined = Mesh(W, G).welded().joined_F
    assert len(np.unique(joined)) < len(W), "some are welded"
    assert (joined != np.roll(joined, 1, axis=1)).all()


def test_seams_tell_of_vertices_inside_other_boundary_edges():
    V, F = halves(0.0, along=(12, 8))
    found = seams(V, F)
    # Of 11 and 7 heights within each seam, 3 are common.
    assert len(found.joints) == 2 * (8 + 4)
    assert "T-junctions" in kinds(Mesh(V, F))
    assert "T-junctions" not in kinds(Mesh(*halves(0.0)))


def test_seams_are_the_same_when_few_pairs_are_looked_at_at_once(monkeypatch):
    V, F = halves(0.0, along=(12, 8))
    whole = seams(V, F).joints
    monkeypatch.setattr(seams_module, "PAIRS_AT_ONCE", 3)
    assert np.array_equal(seams(V, F).joints, whole)


def test_seams_of_which_a_part_lies_on_another_are_found_there():
    V, F = half(0.0, 6, 12)
    W, G = half(np.pi, 6, 12)
    W[:, 2] += 2.0  # four rows higher
    V, F = np.vstack([V, W * (1.0 + 1e-5)]), np.vstack([F, G + len(V)])
    assert len(seams(V, F).edges) == 4 * (ROWS - 4)


@pytest.mark.parametrize("corner", [0, 7])
def test_mesh_welded_has_no_boundary_left_on_a_surface_that_welding_closes(corner):
    """As an STL of which one corner of a triangle is rounded differently."""
    V, F = soup(*box(2, 1, 3))
    V = V.copy()
    V[corner] += 1e-5 * diagonal(V)
    found = seams(V, F)
    assert len(found.edges) > 0
    assert len(found.joints) == 0
    assert SEAMS in kinds(Mesh(V, F))
    assert SEAMS not in kinds(Mesh(V, F).welded())


def test_seams_are_not_found_where_closed_parts_touch():
    V, F = box(2, 2, 4)
    W = np.vstack([V, V + [2.0, 0.0, 1e-6]])
    assert not seams(W, np.vstack([F, F + len(V)])).sentences


def test_seams_take_a_flat_sliver_at_the_boundary_for_no_joint():
    V, F = grid(4, 4)
    middle = np.append(0.5 * (V[0] + V[1]), 0.0)[:3]
    G = np.vstack([F, [[1, 0, len(V)]]])
    assert not len(seams(np.vstack([V, middle]), G).joints)


def test_press_welds_too():
    V, F = halves(1e-5)
    args = {"axis": (1, 0, 0), "to": 1.6, "steps": 1, "stiffness": 0.02, "iterations": 40}
    assert torn(V, F, apd_viewer.press(V, F, weld=True, **args).U).max() < 1.1e-5 * diagonal(V)
