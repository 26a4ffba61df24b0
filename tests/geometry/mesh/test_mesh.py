"""Mesh, Weld and pieces: laws; and every sentence that refuses a mesh."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays
from meshes import box, grid, soup, sphere

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import check_mesh
from apd_viewer.geometry.mesh.edges_and_components import vertex_components
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.weld import Weld

# Few different values, so that many positions coincide; both zeros, which are the same place.
lattice = arrays(
    float, st.tuples(st.integers(1, 30), st.just(3)), elements=st.sampled_from([0.0, -0.0, 1.0, 2.5])
)


@given(lattice)
def test_weld_joins_what_coincides_and_nothing_else(V):
    weld = Weld.from_positions(V)
    same = (V[:, None] == V[None]).all(axis=2)
    assert np.array_equal(weld.inverse[:, None] == weld.inverse[None], same)


@given(lattice)
def test_weld_maps_lead_back_and_keep_the_order_of_the_file(V):
    weld = Weld.from_positions(V)
    assert np.array_equal(V[weld.first][weld.inverse], V)
    assert np.array_equal(weld.inverse[weld.first], np.arange(len(weld.first)))
    assert (np.diff(weld.first) > 0).all()
    # "first": no earlier file vertex is at the same position.
    assert all(weld.first[k] == np.flatnonzero(weld.inverse == k)[0] for k in range(len(weld.first)))
    assert not weld.first.flags.writeable
    assert not weld.inverse.flags.writeable


def test_weld_takes_a_nearly_equal_position_for_another():
    V = np.array([[1.0, 0, 0], [np.nextafter(1.0, 2), 0, 0]])
    assert len(Weld.from_positions(V).first) == 2


def test_weld_undoes_a_soup():
    V, F = sphere(1)
    weld = Weld.from_positions(soup(V, F)[0])
    assert len(weld.first) == len(V)
    assert np.array_equal(soup(V, F)[0][weld.first][weld.inverse], V[F].reshape(-1, 3))


def test_weld_without_repeated_positions_is_the_identity():
    V, _ = box(2, 2, 2)
    weld = Weld.from_positions(V)
    assert np.array_equal(weld.first, np.arange(len(V)))
    assert np.array_equal(weld.inverse, np.arange(len(V)))


@given(arrays(np.int64, st.tuples(st.integers(1, 20), st.just(3)), elements=st.integers(0, 24)))
def test_vertex_components_are_what_edges_join(F):
    n = 25
    label = list(range(n))
    for _ in range(n):
        for f in F:
            low = min(label[v] for v in f)
            for v in f:
                label[v] = low
    expected = np.array(label)
    found = vertex_components(F, n)
    assert np.array_equal(found[:, None] == found[None], expected[:, None] == expected[None])


def test_mesh_keeps_the_order_and_cannot_be_written_to():
    V, F = grid(2, 2)
    mesh = Mesh(V.astype(np.float32), F[::-1].astype(np.uint16))
    assert mesh.V.dtype == np.float64
    assert mesh.F.dtype == np.int64
    assert np.array_equal(mesh.V, V)
    assert np.array_equal(mesh.F, F[::-1])
    for array in (mesh.V, mesh.F):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_mesh_lies_in_memory_row_by_row():
    V, F = grid(2, 2)
    mesh = Mesh(np.asfortranarray(V), np.asfortranarray(F))
    assert mesh.V.flags.c_contiguous
    assert mesh.F.flags.c_contiguous
    assert np.array_equal(mesh.V, V)


def test_mesh_is_a_copy():
    V, F = grid(2, 2)
    mesh = Mesh(V, F)
    V += 1.0
    F += 1
    assert mesh.V.min() == 0.0
    assert mesh.F.min() == 0


def test_mesh_is_named_after_its_file(tmp_path):
    assert Mesh(*grid(1, 1)).name == "mesh"
    assert Mesh(*grid(1, 1), tmp_path / "bar.off").name == "bar.off"


V, F = grid(2, 2)
REFUSED = {
    "vertices are pairs": (V[:, :2], F, r"Vertices must be an \(n, 3\) array, not \(9, 2\)"),
    "vertices are flat": (V.ravel(), F, r"Vertices must be an \(n, 3\) array"),
    "faces are quads": (
        V,
        np.array([[0, 1, 2, 3]]),
        r"Faces must be an \(m, 3\) array of triangles, not \(1, 4\)",
    ),
    "faces are flat": (V, F.ravel(), r"Faces must be an \(m, 3\) array"),
    "no faces": (V, F[:0], "No faces"),
    "no vertices": (V[:0], F, "There are no vertices"),
    "not a number": (
        np.where(np.arange(9)[:, None] == 4, np.nan, V),
        F,
        "1 vertex has a coordinate that is not a number",
    ),
    "infinite": (
        np.where(np.arange(9)[:, None] >= 7, -np.inf, V),
        F,
        r"2 vertices have.*the first is vertex 7",
    ),
    "one face too far": (
        V,
        np.vstack([F, [[0, 1, 9]]]),
        r"1 face refers to missing vertices \(there are 9\)",
    ),
    "negative": (V, np.vstack([F, [[0, 1, -1], [-3, 2, 1]]]), "2 faces refer to missing vertices"),
}


@pytest.mark.parametrize(("V", "F", "sentence"), REFUSED.values(), ids=REFUSED.keys())
def test_check_mesh_refuses_what_is_not_a_mesh(V, F, sentence):
    with pytest.raises(InputError, match=sentence):
        check_mesh(V, F)
    with pytest.raises(InputError, match=sentence):
        Mesh(V, F)


def test_check_mesh_knows_that_the_last_vertex_exists():
    check_mesh(V, np.array([[0, 1, len(V) - 1]]))


FOREIGN = {
    "faces are fractions": (V, F + 0.5),
    "faces are not numbers": (V, np.where(F == 3, np.nan, F)),
    "faces are too large for an integer": (V, F * 1e300),
    "faces are text": (V, [["a", "b", "c"]]),
    "faces are ragged": (V, [[0, 1, 2], [0, 1]]),
    "faces are missing": (V, None),
    "vertices are ragged": ([[0.0, 0.0, 0.0], [1.0]], F),
    "vertices are text": ([["a", "b", "c"]] * 9, F),
    "vertices are complex": (V + 1j, F),
    "vertices are missing": (None, F),
}


@pytest.mark.parametrize(("V", "F"), FOREIGN.values(), ids=FOREIGN.keys())
def test_mesh_refuses_what_is_not_even_numbers_in_one_sentence(V, F):
    with pytest.raises(InputError):
        Mesh(V, F)


anything = st.one_of(
    st.none(),
    st.text(max_size=3),
    arrays(float, st.lists(st.integers(0, 4), max_size=3).map(tuple), elements=st.floats(width=64)),
    arrays(int, st.tuples(st.integers(0, 4), st.just(3)), elements=st.integers(-2, 5)),
    st.lists(st.lists(st.integers(-1, 4) | st.floats(), max_size=4), max_size=4),
)


@given(anything, anything)
def test_mesh_is_made_or_refused_whatever_is_given(V, F):
    try:
        mesh = Mesh(V, F)
    except InputError:
        return
    assert mesh.V.shape[1] == mesh.F.shape[1] == 3
    assert np.isfinite(mesh.V).all()
    assert mesh.F.min() >= 0
    assert mesh.F.max() < len(mesh.V)
    # Nothing was rounded to make it fit.
    assert np.array_equal(mesh.F, np.asarray(F))
