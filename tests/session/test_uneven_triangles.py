"""Thin triangles over much of a surface: said at opening, at the choice of a method, and by deform."""

import numpy as np
import pytest
from meshes import box, ends

from apd_viewer import deform
from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.solver.methods import METHODS

V, F = box(2, 2, 6)
THIN = V * [30, 1, 1]  # edges along x are longer than ten heights of their triangles
ELASTIC = [name for name, method in METHODS.items() if method.needs_even_triangles]


def uneven(mesh):
    return [each for each in inspect(mesh).findings if each.kind == "uneven triangles"]


def test_inspect_says_how_much_of_a_surface_is_of_thin_triangles():
    """The sides along x are thin; the two ends across it are as they were."""
    assert uneven(Mesh(V, F)) == []
    (found,) = uneven(Mesh(THIN, F))
    sides, end = 2 * (60 * 2 + 60 * 6), 2 * (2 * 6)
    assert f" cover {100 * sides / (sides + end):.0f} % of the surface" in found.sentence
    assert "remesh" in found.sentence
    on_sides = np.isin(V[:, 1], (0, 2)) | np.isin(V[:, 2], (0, 6))
    assert np.array_equal(found.vertices, np.flatnonzero(on_sides))


def test_inspect_lets_few_thin_triangles_pass():
    W = V.copy()
    W[V[:, 2] == 5, 2] = 5.99
    thin = W[F][(np.ptp(W[F][:, :, 2], axis=1) < 0.02) & (np.ptp(W[F][:, :, 2], axis=1) > 0)]
    assert len(thin) > 0
    assert uneven(Mesh(W, F)) == []


def test_method_knows_which_need_even_triangles():
    assert ELASTIC == ["local", "wall"]


@pytest.mark.parametrize("method", METHODS)
def test_deform_warns_of_thin_triangles_where_they_matter(method):
    for X, expected in ((V, False), (THIN, method in ELASTIC)):
        base, handle = ends(X)
        held = np.r_[base, handle]
        result = deform(X, F, held, X[held], method, handle=handle, contact=False)
        assert any("remesh evenly first" in each for each in result.warnings) == expected


def test_settings_editor_warns_as_a_method_is_chosen(empty):
    for X, count in ((V, 0), (THIN, 1)):
        empty.show_now(Mesh(X, F))
        for method in METHODS:
            empty.told.clear()
            empty.settings.change(method=method)
            said = [each for each in empty.told if "remesh evenly first" in each]
            assert len(said) == (count if method in ELASTIC else 0)
        empty.settings.change(method="exact")
