"""How triangles hang together, against slow and plain ways of finding out."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import given, strategies as st
from meshes import box, grid, sphere, tube

from apd_viewer.geometry.analysis.defects import defects
from apd_viewer.geometry.mesh.edges_and_components import opposite_half_edges


def defects_of(F):
    return defects(F, opposite_half_edges(F, F.max() + 1))


def edges_of(F):
    return Counter(tuple(sorted((int(t[k]), int(t[k - 1])))) for t in F for k in range(3))


def fans_around(F, v):
    """How many groups of triangles at ``v`` share edges at it."""
    own = [set(map(int, t)) - {v} for t in F if v in t]
    groups = []
    for pair in own:
        touching = [group for group in groups if group & pair]
        groups = [group for group in groups if not group & pair] + [set(pair).union(*touching)]
    return len(groups)


triangle = st.lists(st.integers(0, 7), min_size=3, max_size=3, unique=True)


@given(st.lists(triangle, min_size=1, max_size=14))
def test_defects_find_edges_and_vertices_of_any_triangles(faces):
    F = np.array(faces)
    found, edges = defects_of(F), edges_of(F)
    assert {tuple(sorted(e)) for e in found.boundary_edges.tolist()} == {
        e for e, k in edges.items() if k == 1
    }
    assert {tuple(sorted(e)) for e in found.non_manifold_edges.tolist()} == {
        e for e, k in edges.items() if k > 2
    }
    assert set(found.non_manifold_vertices.tolist()) == {v for v in range(8) if fans_around(F, v) > 1}
    same = Counter(tuple(sorted(t)) for t in F.tolist())
    assert len(found.duplicate_faces) == sum(k - 1 for k in same.values())


@pytest.mark.parametrize("mesh", [box(3, 2, 4), sphere(2), tube(12, 5), grid(4, 3)])
@pytest.mark.parametrize("share", [0.0, 0.15, 0.45])
def test_defects_take_the_fewer_for_flipped(mesh, share):
    F = mesh[1].copy()
    which = np.sort(np.random.default_rng(1).permutation(len(F))[: int(share * len(F))])
    F[which] = F[which][:, ::-1]
    found = defects_of(F)
    assert np.array_equal(found.flipped_faces, which)
    assert not found.is_non_orientable


@pytest.mark.parametrize("mesh", [box(3, 2, 4), sphere(2), tube(12, 5), grid(4, 3)])
def test_defects_take_the_half_without_the_first_face_for_flipped(mesh):
    F = mesh[1].copy()
    half = np.arange(len(F) // 2, 2 * (len(F) // 2))
    F[half] = F[half][:, ::-1]
    assert np.array_equal(defects_of(F).flipped_faces, half)


def test_defects_judge_pieces_by_themselves():
    F, n = sphere(1)[1], len(sphere(1)[0])
    both = np.vstack([F, F[:, ::-1] + n])
    assert len(defects_of(both).flipped_faces) == 0, "inside out is no contradiction"


def test_defects_find_that_a_moebius_strip_has_one_side():
    k = np.arange(12)
    a, b = 2 * k, 2 * k + 1
    c, d = np.where(k == 11, 1, 2 * k + 2), np.where(k == 11, 0, 2 * k + 3)
    F = np.vstack([np.column_stack([a, c, b]), np.column_stack([b, c, d])])
    assert defects_of(F).is_non_orientable
