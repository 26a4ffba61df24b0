"""Normals of a file that are none: they are first looked at when they have to turn."""

import pytest
from mesh_contents import TWO_MATERIALS, bent

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh


@pytest.mark.parametrize("normal", ["vn 0 nan 1", "vn 1e300 0 0"])
def test_obj_file_leaves_a_normal_that_is_none_as_it_is(normal, tmp_path):
    (tmp_path / "a.obj").write_bytes(TWO_MATERIALS.replace(b"vn 0 0 -1.000", normal.encode()))
    mesh = open_mesh(tmp_path / "a.obj")
    save_mesh(mesh, bent(mesh.V), tmp_path / "b.obj")
    assert normal in (tmp_path / "b.obj").read_text()
    assert "vn 0 0.9487 0.3162" not in (tmp_path / "b.obj").read_text()


def test_obj_file_notices_a_normal_that_is_no_number_when_it_has_to_turn(tmp_path):
    (tmp_path / "a.obj").write_bytes(TWO_MATERIALS.replace(b"vn 0 0 -1.000", b"vn 0 zero 0"))
    mesh = open_mesh(tmp_path / "a.obj")
    with pytest.raises(InputError, match=r"normals that cannot be updated \(“zero” is not a number\)"):
        save_mesh(mesh, bent(mesh.V), tmp_path / "b.obj")


@pytest.mark.parametrize("index", ["9" * 20, "-" + "9" * 20, "0"])
def test_obj_file_takes_an_index_of_no_normal_for_none(index, tmp_path):
    path = tmp_path / "a.obj"
    path.write_text(f"v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1/{index}/1 2//{index} -1//-1\n")
    mesh = open_mesh(path)
    assert mesh.F.tolist() == [[0, 1, 2]]
    _, normal_of = mesh.origin.normals(mesh)
    assert normal_of.tolist() == [[0, -1, 0]]
