"""Half-edges and edges of triangles, against a plain count of their uses."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import given, strategies as st
from meshes import box, soup, sphere, tube

from apd_viewer.geometry.mesh.edges_and_components import (
    boundary_edges,
    boundary_vertices,
    edge_defect_counts,
    missing_volume_reason,
    opposite_half_edges,
)

CUBE = box(1, 1, 1)
triangles = st.lists(st.tuples(*[st.integers(0, 6)] * 3), min_size=1, max_size=12).map(np.array)


def directed_edges(F):
    """Half-edges of the triangles with three distinct corners."""
    return [(int(t[k]), int(t[(k + 1) % 3])) for t in F if len(set(t)) == 3 for k in range(3)]


@given(triangles)
def test_edge_defect_counts_are_those_of_the_uses_of_each_edge(F):
    uses = Counter(tuple(sorted(edge)) for edge in directed_edges(F))
    same_way = Counter(directed_edges(F))
    border = sorted(edge for edge, k in uses.items() if k == 1)
    crowded = sum(k > 2 for k in uses.values())
    one_way = sum(k == 2 and 2 in (same_way[edge], same_way[edge[::-1]]) for edge, k in uses.items())
    opposite = opposite_half_edges(F, 7)
    assert edge_defect_counts(F, opposite) == (len(border), crowded, one_way)
    found = boundary_edges(F, opposite).tolist()
    assert [tuple(sorted(edge)) for edge in found] == border
    assert set(map(tuple, found)) <= set(directed_edges(F))
    assert boundary_vertices(F, 7).tolist() == sorted({v for edge in border for v in edge})


def reason(F):
    return missing_volume_reason(F, opposite_half_edges(F, F.max() + 1))


def two_cubes():
    V, F = CUBE
    return np.vstack([V, V + 5.0]), np.vstack([F, F + len(V)])


@pytest.mark.parametrize("mesh", [CUBE, sphere(1), two_cubes()])
def test_missing_volume_reason_has_nothing_against_closed_surfaces(mesh):
    F = mesh[1]
    assert reason(F) is None
    assert reason(F[:, ::-1]) is None


def test_missing_volume_reason_takes_no_surface_for_open_because_of_a_face_without_extent():
    F = CUBE[1]
    assert reason(np.vstack([F, [[0, 0, 1], [2, 2, 2]]])) is None


def test_missing_volume_reason_says_how_open_a_surface_is():
    F = CUBE[1]
    assert reason(F[1:]) == "the surface is open (3 boundary edges)"
    F = tube(7, 3)[1]
    assert reason(F) == "the surface is open (14 boundary edges)"
    F = soup(*CUBE)[1]
    assert reason(F) == "the surface is open (36 boundary edges)"


def test_missing_volume_reason_says_that_a_surface_with_three_faces_at_an_edge_is_not_manifold():
    F = two_cubes()[1]
    a, b = F[0, :2]
    glued = F.copy()
    for mine, other in ((a, a + len(CUBE[0])), (b, b + len(CUBE[0]))):
        glued[glued == other] = mine
    assert "not manifold (1 edge" in reason(glued)
    # A closed surface and a copy of it: every edge is used twice in either direction.
    assert "not manifold" in reason(np.vstack([F, F]))
    assert "not manifold (1 edge" in reason(glued[1:]), "a cap mends an opening, not this"


def test_missing_volume_reason_notices_a_flipped_face():
    F = CUBE[1]
    F = F.copy()
    F[3] = F[3, ::-1]
    assert "not consistently oriented" in reason(F)
    assert "not consistently oriented" in reason(F[:-1]), "a cap mends an opening, not this"
