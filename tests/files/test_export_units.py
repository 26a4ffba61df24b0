"""A unit that is known goes along into formats with one of their own: GLB is in metres."""

from dataclasses import replace

import numpy as np
import pytest
from meshes import box

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh

V, F = box(1, 2, 2)
METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "ft": 0.3048}


@pytest.mark.parametrize("unit", METRES)
@pytest.mark.parametrize("stated", [True, False])
def test_save_mesh_writes_a_new_glb_in_metres(unit, stated, tmp_path):
    mesh = Mesh(V, F, unit=unit if stated else "")
    written = save_mesh(mesh, 2 * V, tmp_path / "a.glb", None if stated else unit)
    again = open_mesh(tmp_path / "a.glb")
    assert again.unit == "m"
    np.testing.assert_allclose(again.V, 2 * V * METRES[unit], rtol=1e-6)
    assert written.area == pytest.approx(4 * 16.0, rel=1e-6)  # in the unit of the mesh


@pytest.mark.parametrize("suffix", [".obj", ".ply", ".stl", ".off"])
def test_save_mesh_writes_the_numbers_as_they_are_in_formats_without_a_unit(suffix, tmp_path):
    save_mesh(Mesh(V, F, unit="in"), V, tmp_path / f"a{suffix}")
    again = open_mesh(tmp_path / f"a{suffix}")
    assert again.unit == ""
    assert np.ptp(again.V, axis=0).tolist() == [1, 2, 2]


def test_save_mesh_keeps_a_glb_the_same_file_in_whatever_unit_it_is_measured(tmp_path):
    save_mesh(Mesh(V, F), V, tmp_path / "a.glb")
    mesh = open_mesh(tmp_path / "a.glb")
    save_mesh(replace(mesh, unit="mm"), mesh.V, tmp_path / "b.glb", "mm")
    assert (tmp_path / "b.glb").read_bytes() == (tmp_path / "a.glb").read_bytes()
    save_mesh(mesh, mesh.V, tmp_path / "c.obj")
    save_mesh(open_mesh(tmp_path / "c.obj"), mesh.V, tmp_path / "d.glb")  # without a unit, as it stands
    np.testing.assert_array_equal(open_mesh(tmp_path / "d.glb").V, mesh.V)
