"""Files that VTK writes: read as VTK reads them, and written back with all else as it was."""

import itertools
from functools import cache

import numpy as np
import pytest
import pyvista
from mesh_contents import bent
from meshes import sphere
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkBitArray
from vtkmodules.vtkIOCore import vtkLZ4DataCompressor
from vtkmodules.vtkIOLegacy import vtkPolyDataWriter, vtkUnstructuredGridWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter, vtkXMLUnstructuredGridWriter

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.vtk.xml_arrays import decompressed_block
from apd_viewer.geometry.mesh.operators import area

_COMPRESSIONS = {"plain": 0, "zlib": 1, "lz4": 2, "lzma": 3}
_MODES = {
    "ascii": ("Ascii", True),
    "base64": ("Binary", True),
    "appended": ("Appended", True),
    "raw": ("Appended", False),
}
XML = list(itertools.product(("vtp", "vtu"), _MODES, _COMPRESSIONS, ("UInt32", "UInt64"), ("Little", "Big")))
LEGACY = list(itertools.product(("vtp", "vtu"), (False, True), (42, 51)))


def surface(kind):
    """A copy of quads with triangles, lines and a vertex, with data of all kinds."""
    return _surface(kind).copy()


@cache
def _surface(kind):
    """Quads with triangles, lines and a vertex, with data of all kinds, repeated values among them."""
    ball = pyvista.PolyData.from_regular_faces(*sphere(2))
    ball = ball.append_polydata(pyvista.Cube(center=(3, 0, 0), clean=True))
    ball = ball.append_polydata(pyvista.Line((5, 0, 0), (6, 1, 0)))
    ball.points = ball.points.astype(np.float64) / 3.0
    chance = np.random.default_rng(0)
    ball.point_data["stress"] = chance.normal(size=(ball.n_points, 6))
    ball.point_data["flag"] = np.zeros(ball.n_points, dtype=np.uint8)
    ball.cell_data["layer"] = np.arange(ball.n_cells) // 7
    ball.field_data["when"] = [0.25]
    ball.field_data["who"] = ["a laboratory"]
    return ball if kind == "vtp" else ball.cast_to_unstructured_grid()


def bits():
    array = vtkBitArray()
    array.SetName("bits")
    for k in range(11):
        array.InsertNextValue(k % 3 == 0)
    return array


def written(path, kind, mode, compression, header, order):
    writer = vtkXMLPolyDataWriter() if kind == "vtp" else vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(surface(kind))
    name, coded = _MODES[mode]
    getattr(writer, f"SetDataModeTo{name}")()
    writer.SetEncodeAppendedData(coded)
    writer.SetCompressorType(_COMPRESSIONS[compression])
    getattr(writer, f"SetHeaderTypeTo{header}")()
    getattr(writer, f"SetByteOrderTo{order}Endian")()
    writer.SetBlockSize(4096)
    assert writer.Write() == 1


def check(path):
    """What opens is what VTK reads, and only positions are others afterwards."""
    mesh, seen = open_mesh(path), pyvista.read(path)
    np.testing.assert_allclose(mesh.V, seen.points, atol=1e-7)
    flat = seen if isinstance(seen, pyvista.PolyData) else seen.extract_surface(algorithm="dataset_surface")
    assert len(mesh.F) == 320 + 12
    assert area(mesh.V, mesh.F) == pytest.approx(flat.area)
    out = path.with_name(f"out{path.suffix}")
    save_mesh(mesh, mesh.V, out)
    assert out.read_bytes() == path.read_bytes()
    U = bent(mesh.V, slice(0, len(mesh.V) // 2))
    save_mesh(mesh, U, out)
    again = pyvista.read(out)
    np.testing.assert_allclose(again.points, U, atol=1e-6)
    assert np.array_equal(again.points[len(U) // 2 :], seen.points[len(U) // 2 :])
    again.points = seen.points
    assert again == seen, "data, cells or their order are others"
    save_mesh(open_mesh(out), mesh.V, out)
    np.testing.assert_allclose(pyvista.read(out).points, seen.points, atol=1e-7)


@pytest.mark.parametrize(("kind", "mode", "compression", "header", "order"), XML)
def test_vtk_xml_file_is_read_as_vtk_reads_it_and_written_back_with_all_else_as_it_was(
    kind, mode, compression, header, order, tmp_path
):
    path = tmp_path / f"in.{kind}"
    written(path, kind, mode, compression, header, order)
    check(path)


@pytest.mark.parametrize(("kind", "binary", "version"), LEGACY)
def test_vtk_legacy_file_is_read_as_vtk_reads_it_and_written_back_with_all_else_as_it_was(
    kind, binary, version, tmp_path
):
    path = tmp_path / "in.vtk"
    writer = vtkPolyDataWriter() if kind == "vtp" else vtkUnstructuredGridWriter()
    writer.SetFileName(str(path))
    ball = surface(kind)
    ball.field_data["notes"] = ["", *(size * "a b\n%" for size in (1, 20, 5_000))]
    ball.GetFieldData().AddArray(bits())
    writer.SetInputData(ball)
    writer.SetFileType(1 + binary)
    writer.SetFileVersion(version)
    assert writer.Write() == 1
    check(path)


def test_vtk_xml_file_declares_the_range_of_its_points(tmp_path):
    path, out = tmp_path / "in.vtp", tmp_path / "out.vtp"
    written(path, "vtp", "ascii", "plain", "UInt32", "Little")
    mesh = open_mesh(path)
    save_mesh(mesh, 5.0 * mesh.V, out)
    text = out.read_text()
    tag = text[text.index('Name="Points"') : text.index("</Points>")]
    farthest = 5.0 * np.linalg.norm(mesh.V, axis=1).max()
    declared = float(tag.split('RangeMax="')[1].split('"')[0])
    assert declared == pytest.approx(farthest)
    assert tag.count("Value index") == 2
    assert float(tag.split('<Value index="1">')[1].split("<")[0]) == pytest.approx(farthest)


@pytest.mark.parametrize("period", [1, 10_000])
def test_decompressed_block_of_what_repeats_is_unpacked_in_the_room_that_it_takes(period):
    data = np.random.default_rng(0).bytes(period) * (300_000 // period)
    block = vtkLZ4DataCompressor().Compress(data, len(data))
    assert block.GetNumberOfValues() < 0.1 * len(data)
    assert decompressed_block(vtk_to_numpy(block).tobytes(), len(data)) == data
