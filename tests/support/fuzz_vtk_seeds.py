"""VTK contents with which ``make fuzz`` begins: both kinds of data set in every encoding that VTK writes."""

import itertools

import numpy as np
import vtk
from painted_meshes import MESH
from vtk.util.numpy_support import numpy_to_vtk

CELLS = {
    vtk.VTK_TRIANGLE: [0, 1, 2],
    vtk.VTK_QUAD: [0, 1, 4, 3],
    vtk.VTK_PIXEL: [0, 1, 2, 3],
    vtk.VTK_POLYGON: [0, 1, 2, 3, 4],
    vtk.VTK_TRIANGLE_STRIP: [0, 1, 2, 3],
    vtk.VTK_LINE: [0, 1],
    vtk.VTK_VERTEX: [2],
}
SOLID, CURVED = {vtk.VTK_TETRA: [0, 1, 2, 3]}, {vtk.VTK_QUADRATIC_TRIANGLE: [0, 1, 2, 3, 4, 5]}
COMPRESSORS = None, vtk.vtkLZ4DataCompressor, vtk.vtkZLibDataCompressor, vtk.vtkLZMADataCompressor


def _with_arrays(data):
    """The data set with normals, colours, a thickness and the range that VTK stores beside it."""
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(MESH.V, deep=True))
    data.SetPoints(points)
    n, m = data.GetNumberOfPoints(), data.GetNumberOfCells()
    normals = numpy_to_vtk(np.tile(np.float32([0, 0, 1]), (n, 1)), deep=True)
    normals.SetName("Normals")
    data.GetPointData().SetNormals(normals)
    colors = numpy_to_vtk(np.full((n, 3), 90, np.uint8), deep=True)
    colors.SetName("RGB")
    data.GetPointData().SetScalars(colors)
    thickness = numpy_to_vtk(np.full(m, 0.3), deep=True)
    thickness.SetName("thickness")
    data.GetCellData().AddArray(thickness)
    points.GetData().GetRange(-1)
    words = vtk.vtkStringArray()
    words.SetName("words")
    words.InsertNextValue("a b")
    data.GetFieldData().AddArray(words)
    bits = vtk.vtkBitArray()
    bits.SetName("bits")
    for k in range(n):
        bits.InsertNextValue(k % 2)
    data.GetPointData().AddArray(bits)
    return data


def _cells(lists):
    found = vtk.vtkCellArray()
    for own in lists:
        found.InsertNextCell(len(own), own)
    return found


def _surface():
    data = vtk.vtkPolyData()
    data.SetPolys(_cells([*MESH.F.tolist(), [0, 1, 2, 3]]))
    data.SetStrips(_cells([[0, 1, 2, 3, 4]]))
    data.SetLines(_cells([[0, 1, 2]]))
    data.SetVerts(_cells([[3]]))
    return _with_arrays(data)


def _grid(cells=CELLS):
    data = vtk.vtkUnstructuredGrid()
    data.SetPoints(vtk.vtkPoints())
    for kind, own in cells.items():
        data.InsertNextCell(kind, len(own), own)
    return _with_arrays(data)


def legacy_contents():
    """Both kinds of data set, as text and binary, of version 4.2 and 5.1."""
    found = []
    for (data, writer), version, is_text in itertools.product(
        (
            (_surface(), vtk.vtkPolyDataWriter()),
            *((_grid(cells), vtk.vtkUnstructuredGridWriter()) for cells in (CELLS, SOLID, CURVED)),
        ),
        (42, 51),
        (True, False),
    ):
        writer.SetInputData(data)
        writer.SetFileVersion(version)
        writer.SetFileType(vtk.VTK_ASCII if is_text else vtk.VTK_BINARY)
        writer.WriteToOutputStringOn()
        writer.Write()
        found.append(writer.GetOutputStdString())
    return [each.encode("latin-1") if isinstance(each, str) else bytes(each) for each in found]


def xml_contents(suffix):
    """A data set as text, inline and behind the XML, by every compressor and in both orders of bytes."""
    found = []
    data, kind = (
        (_surface(), vtk.vtkXMLPolyDataWriter)
        if suffix == ".vtp"
        else (_grid(), vtk.vtkXMLUnstructuredGridWriter)
    )
    modes = vtk.vtkXMLWriter.Ascii, vtk.vtkXMLWriter.Binary, vtk.vtkXMLWriter.Appended
    for mode, compressor, is_coded in itertools.product(modes, COMPRESSORS, (True, False)):
        writer = kind()
        writer.SetInputData(data)
        writer.SetDataMode(mode)
        writer.SetCompressor(compressor and compressor())
        writer.SetEncodeAppendedData(is_coded)
        writer.SetHeaderTypeToUInt64() if is_coded else writer.SetHeaderTypeToUInt32()
        writer.SetByteOrderToBigEndian() if compressor is None else writer.SetByteOrderToLittleEndian()
        writer.WriteToOutputStringOn()
        writer.Write()
        text = writer.GetOutputString()
        found.append(text.encode("latin-1") if isinstance(text, str) else bytes(text))
    return list(dict.fromkeys(found))
