"""Young's modulus of each material by stretching a sheet whose sides are free."""

import numpy as np
import pytest
from meshes import grid
from scipy.optimize import minimize_scalar

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.solver.methods import METHODS

STRAIN = 1e-4


@pytest.mark.parametrize(
    ("method", "area", "shear", "known"),
    [
        ("arap", 20.0, 0.1, 4.0),
        ("exact", 20.0, 0.1, 4.0),
        ("local", 20.0, 0.1, 1.18),
        ("local", 0.0, 0.0, 0.4),
        ("local", 0.0, 0.5, 1.4),
        ("local", 100.0, 10.0, None),
    ],
)
def test_young_is_the_modulus_by_which_a_sheet_resists(method, area, shear, known):
    """Energy per area E t e^2 / 2, at the width that it takes by itself; one strain in all triangles."""
    V, F = grid(6, 6)
    material = METHODS[method].material(0.001, area, shear)
    surface = ElasticSurface(SolveMesh(V, F), np.arange(0), material)
    found = minimize_scalar(
        lambda across: surface.energy_after_local_step(V * [1.0 + STRAIN, 1.0 + across, 1.0]),
        bounds=(-2.0 * STRAIN, STRAIN),
        method="bounded",
        options={"xatol": 1e-9},
    )
    young = 2.0 * found.fun / face_areas(V, F).sum() / STRAIN**2
    assert material.tensile_stiffness == pytest.approx(young, rel=2e-3)
    if known is not None:
        assert material.tensile_stiffness == pytest.approx(known, rel=3e-3)
