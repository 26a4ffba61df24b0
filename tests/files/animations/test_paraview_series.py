"""ParaView series, opened again by VTK with all their arrays."""

from xml.sax.saxutils import quoteattr

import numpy as np
import pytest
import pyvista as pv
from animated import animated
from meshes import sphere

from apd_viewer.errors import InputError
from apd_viewer.files.animations.animation_files import check_animation, replacing_series, write_animation
from apd_viewer.geometry.analysis.scalars import shape_scalars
from apd_viewer.geometry.mesh.mesh import Mesh

V, F = sphere(1)
MESH = Mesh(V, F)
LABELS = np.where(V[:, 2] > 0.5, 2, 1).astype(np.uint8)
LABELS[V[:, 2] < -0.5] = 0
MEMBER = (V[:, 0] > 0).astype(np.uint8)


@pytest.fixture
def written(tmp_path):
    animation, shapes = animated(MESH, tmp_path / "shapes", 12, LABELS, MEMBER)
    write_animation(animation, tmp_path / "a & b.pvd")
    return tmp_path / "a & b.pvd", animation, shapes


def test_write_series_lets_vtk_read_every_shape_with_all_its_arrays(written):
    path, animation, shapes = written
    reader = pv.get_reader(path)
    assert reader.time_values == pytest.approx(animation.times, abs=0)
    for k, U in enumerate(shapes):
        reader.set_active_time_point(k)
        grid = reader.read()[0]
        scalars = shape_scalars(MESH, U, LABELS, MEMBER)
        assert np.array_equal(grid.points, U)
        assert np.array_equal(grid.cells.reshape(-1, 4)[:, 1:], F)
        assert set(grid.point_data) == set(scalars.vertices)
        assert set(grid.cell_data) == set(scalars.triangles)
        assert np.array_equal(grid.point_data["displacement"], U - V)
        for name in set(scalars.vertices) - {"displacement"}:
            np.testing.assert_array_equal(grid.point_data[name], scalars.vertices[name])
        for name, values in scalars.triangles.items():
            np.testing.assert_array_equal(grid.cell_data[name], values)


def test_write_series_writes_the_area_change_and_strain_of_a_stretch(tmp_path):
    """Stretched to twice its height and half its width, a plane keeps its area."""
    flat = Mesh(V * [1.0, 1.0, 0.0], F[[0]])
    animation, _ = animated(flat, tmp_path / "shapes", 2)
    np.save(animation.files[1], flat.V * [2.0, 0.5, 1.0])
    write_animation(animation, tmp_path / "a.pvd")
    reader = pv.get_reader(tmp_path / "a.pvd")
    reader.set_active_time_point(1)
    cells = reader.read()[0].cell_data
    assert cells["area_change"] == pytest.approx([0.0], abs=1e-12)
    assert cells["largest_stretch"] == pytest.approx([2.0])
    assert cells["smallest_stretch"] == pytest.approx([0.5])


def test_write_series_gives_names_that_sort_in_the_order_of_time(written):
    path, _, shapes = written
    names = sorted(each.name for each in path.with_suffix("").iterdir())
    assert names == [f"a & b-{k:02d}.vtu" for k in range(len(shapes))]


def test_check_animation_refuses_a_file_in_place_of_the_folder(tmp_path):
    (tmp_path / "a").write_text("mine")
    with pytest.raises(InputError, match=r"a\.pvd needs a folder a beside it, which is a file"):
        check_animation(tmp_path / "a.pvd")
    check_animation(tmp_path / "b.pvd")


def test_write_series_leaves_nothing_of_what_cannot_be_written(tmp_path):
    animation, _ = animated(MESH, tmp_path / "shapes")
    animation.files[2].unlink()
    before = sorted(tmp_path.iterdir())
    with pytest.raises(InputError, match="cannot be written"):
        write_animation(animation, tmp_path / "a.pvd")
    assert sorted(tmp_path.iterdir()) == before


def test_write_series_says_in_a_sentence_what_the_disk_refuses(tmp_path, capfd):
    """Here a name: VTK would print a page, and say that the reason is success."""
    animation, _ = animated(MESH, tmp_path / "shapes")
    with pytest.raises(InputError, match=r"cannot be written \((?!Success)"):
        write_animation(animation, tmp_path / f"{250 * 'n'}.pvd")
    assert capfd.readouterr() == ("", "")


def test_replacing_series_does_not_delete_what_a_series_lists_elsewhere(written):
    """As one of another program may: in other folders, of other kinds, or nothing that can be read."""
    path, _, _ = written
    for file in ("../b.vtu", "c.vtu", "a & b/d.csv"):
        (path.parent / file).write_text("mine")
        row = f'<DataSet timestep="0" file={quoteattr(file)}/>'
        path.write_text(f"<VTKFile><Collection>{row}</Collection></VTKFile>")
        with replacing_series([path]):
            path.write_text("<VTKFile/>")
        assert (path.parent / file).exists()
    path.write_text("no series")
    with replacing_series([path, path.with_name("gone.pvd")]):
        pass


def test_replacing_series_deletes_nothing_when_it_fails(written):
    path, _, shapes = written

    def interrupted():
        path.write_text("<VTKFile/>")
        raise InputError

    with pytest.raises(InputError), replacing_series([path]):
        interrupted()
    assert len(list(path.with_suffix("").iterdir())) == len(shapes)
