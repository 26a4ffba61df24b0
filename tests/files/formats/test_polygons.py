"""Polygons become triangles that cover them, whatever their shape."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from meshes import rotation

from apd_viewer.files.formats.polygon_mesh import Polygons

ARROW = np.array([[0, 0, 0], [1, -1, 0], [0.3, 0, 0], [1, 1, 0]])
STAR = np.array([[np.cos(t), np.sin(t), 0] for t in np.arange(10) * np.pi / 5]) * np.array([[1.0], [0.4]] * 5)
COMB = np.array(
    [[0, 0], [7, 0], [7, 3], [6, 3], [6, 1], [5, 1], [5, 3], [3, 3], [3, 1], [2, 1], [2, 3], [0, 3]]
)
COMB = np.column_stack([COMB, np.zeros(len(COMB))]).astype(float)


def area_vector(X):
    return 0.5 * np.cross(X, np.roll(X, -1, axis=0)).sum(axis=0)


def triangle_areas(V, F):
    return 0.5 * np.linalg.norm(np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]]), axis=1)


@pytest.mark.parametrize("shape", [ARROW, STAR, COMB], ids=["arrow", "star", "comb"])
@pytest.mark.parametrize("first", range(4))
@pytest.mark.parametrize("turned", [np.eye(3), rotation([1, 2, 3], 1.0)])
def test_polygons_cover_a_face_that_is_not_convex_once(shape, first, turned):
    V = np.roll(shape, first, axis=0) @ turned.T
    F = Polygons.from_faces([list(range(len(V)))]).triangles(V)
    assert len(F) == len(V) - 2
    assert triangle_areas(V, F).sum() == pytest.approx(np.linalg.norm(area_vector(V)), rel=1e-12)


@given(st.lists(st.lists(st.integers(0, 19), min_size=0, max_size=9), max_size=12), st.integers(0, 9))
def test_polygons_have_the_triangles_of_every_face_in_its_place(faces, seed):
    V = np.random.default_rng(seed).normal(size=(20, 3))
    F = Polygons.from_faces(faces).triangles(V)
    sizes = [max(len(face) - 2, 0) for face in faces]
    assert len(F) == sum(sizes)
    for face, T in zip(faces, np.split(F, np.cumsum(sizes)[:-1] if sizes else []), strict=False):
        assert set(T.ravel()) <= set(face)
        if len(face) > 2:
            both = sum(area_vector(V[t]) for t in T)
            assert np.abs(both - area_vector(V[face])).max() < 1e-12, "what folds back takes away"


def test_polygons_make_fans_of_convex_faces_around_their_first_corner():
    angle = np.arange(6) * np.pi / 3
    V = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    assert Polygons.from_faces([[1, 2, 3, 4, 5, 0]]).triangles(V).tolist() == [
        [1, 2, 3],
        [1, 3, 4],
        [1, 4, 5],
        [1, 5, 0],
    ]


def test_polygons_leave_faces_of_missing_vertices_to_be_refused():
    assert Polygons.from_faces([[0, 1, 2, 9]]).triangles(np.zeros((3, 3))).tolist() == [[0, 1, 2], [0, 2, 9]]


def test_polygons_take_no_time_for_a_face_of_thousands_of_corners():
    rng = np.random.default_rng(0)
    V = rng.normal(size=(20_000, 3))
    assert len(Polygons.from_faces([list(range(20_000))]).triangles(V)) == 19_998


def test_polygons_keep_the_hole_that_a_bridge_leads_to():
    """Corners of a bridge are in two places at once, and block no ear."""
    flat = [[0, 0], [3, 0], [3, 3], [0, 3], [0, 0], [1, 1], [1, 2], [2, 2], [2, 1], [1, 1]]
    V = np.column_stack([flat, np.zeros(len(flat))]).astype(float)
    T = Polygons.from_faces([range(len(V))]).triangles(V)
    middles = V[T].mean(axis=1)[triangle_areas(V, T) > 0]
    assert triangle_areas(V, T).sum() == pytest.approx(8)
    assert not ((middles[:, :2] > 1) & (middles[:, :2] < 2)).all(axis=1).any()


def test_polygons_divide_faces_of_hundreds_of_corners_without_folds():
    teeth = np.array([[k, 3.0 * (k % 4 > 1)] for k in range(200)])
    V = np.vstack([teeth, [[199, -1], [0, -1]]])[::-1]
    V = np.column_stack([V, np.zeros(len(V))])
    T = Polygons.from_faces([range(len(V))]).triangles(V)
    assert triangle_areas(V, T).sum() == pytest.approx(np.linalg.norm(area_vector(V)))
