"""Where walls touch, and how hard."""

import numpy as np
import pytest
from meshes import grid
from scipy.spatial import cKDTree

from apd_viewer.geometry.contact.mesh_contact import ContactPressure
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE

NEAR = 0.02


@pytest.fixture(scope="module")
def plates():
    """Two square plates held at their left edges, the upper one a handle, and a third that nothing holds."""
    V, F = grid(10, 10, 0.1, 0.1)
    sheets = [V + height * np.array([0.0, 0.0, 1.0]) for height in (0.0, 0.5, 2.0)]
    V, F = np.concatenate(sheets), np.concatenate([F + k * len(V) for k in range(3)])
    sheet = np.repeat(np.arange(3), len(V) // 3)
    labels = np.full(len(V), FREE, np.uint8)
    labels[(V[:, 0] == 0.0) & (sheet == 0)] = BASE
    labels[(V[:, 0] == 0.0) & (sheet == 1)] = HANDLE
    return Mesh(V, F), labels, sheet


def test_contact_pressure_is_where_plates_are_near_and_grows_as_they_near(plates):
    mesh, labels, sheet = plates
    pressure = ContactPressure(mesh, labels, NEAR)
    assert not pressure.relative_pressure(mesh.V)[sheet < 2].any()
    U = mesh.V.copy()
    x, upper = mesh.V[:, 0], sheet == 1
    U[upper, 2] = 0.005 + 0.05 * np.abs(x[upper] - 0.7) ** 2 + (np.abs(x[upper] - 0.7) > 0.35)
    found = pressure.relative_pressure(U)
    assert np.isnan(found[sheet == 2]).all(), "nothing keeps a loose part apart"
    assert np.nanmax(found) == 1.0
    gap = cKDTree(U[upper]).query(U[sheet == 0])[0]
    low = found[sheet == 0]
    assert (low[gap < NEAR] > 0.0).all()
    assert not low[gap > 0.1].any()
    inner = (np.abs(mesh.V[sheet == 0][:, 1] - 0.5) < 0.3) & (gap < NEAR)
    # Farther from its middle the wall is farther away.
    away = np.abs(x[sheet == 0][inner] - 0.7).round(6)
    means = [low[inner][away == value].mean() for value in np.unique(away)]
    assert (np.diff(means) < 0.0).all()


def test_contact_pressure_is_none_where_all_stand_free_of_each_other(plates):
    mesh, labels, sheet = plates
    U = mesh.V + (sheet == 1)[:, None] * np.array([0.0, 0.0, 3.0])
    found = ContactPressure(mesh, labels, None).relative_pressure(U)
    assert not found[sheet < 2].any()
    assert np.isnan(found[sheet == 2]).all()
