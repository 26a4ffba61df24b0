"""ParaView series: a PVD file listing one VTU file per shape, written by VTK."""

from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import (
    VTK_TRIANGLE,
    vtkCellArray,
    vtkDataSetAttributes,
    vtkUnstructuredGrid,
)
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

from apd_viewer.files.animations.animation_shapes import Animation
from apd_viewer.files.storage.atomic_file import replacing_file, staging_folder

_HEAD = '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>\n'
_ROW = '    <DataSet timestep="{time!r}" part="0" file={file}/>\n'
_END = "  </Collection>\n</VTKFile>\n"


def write_series(animation: Animation, path: Path) -> None:
    """Write the shapes as PVD, with a folder of the same name for their VTU files.

    Points have the vertex scalars, with the displacement as a vector, and cells the triangle scalars: see
    :class:`apd_viewer.geometry.analysis.scalars.Scalars`. The times are those of the animation.

    Raises
    ------
    InputError
        If a file cannot be written.
    """
    folder, digits = path.with_suffix(""), len(str(len(animation) - 1))
    names = [f"{path.stem}-{number:0{digits}d}.vtu" for number in range(len(animation))]
    cells = _cells(animation.mesh.F)
    with staging_folder(folder) as scratch:
        for U, name in zip(animation, names, strict=True):
            _write(_grid(animation, U, cells), scratch / name)
    rows = [
        _ROW.format(time=float(time), file=quoteattr(f"{folder.name}/{name}"))
        for time, name in zip(animation.times, names, strict=True)
    ]
    with replacing_file(path) as part:
        part.write_text(_HEAD + "".join(rows) + _END, encoding="utf-8")


def _cells(F: np.ndarray) -> vtkCellArray:
    cells = vtkCellArray()
    starts = np.arange(0, F.size + 1, 3)
    cells.SetData(*(numpy_to_vtkIdTypeArray(array, deep=True) for array in (starts, F.ravel())))
    return cells


def _grid(animation: Animation, U: np.ndarray, cells: vtkCellArray) -> vtkUnstructuredGrid:
    scalars = animation.scalars(U)
    grid, points = vtkUnstructuredGrid(), vtkPoints()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(U), deep=True))
    grid.SetPoints(points)
    grid.SetCells(VTK_TRIANGLE, cells)
    _add(grid.GetPointData(), scalars.vertices | {"displacement": U - animation.mesh.V})
    _add(grid.GetCellData(), scalars.triangles)
    return grid


def _add(there: vtkDataSetAttributes, arrays: dict[str, np.ndarray]) -> None:
    for name, values in arrays.items():
        array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
        array.SetName(name)
        there.AddArray(array)


def _write(grid: vtkUnstructuredGrid, path: Path) -> None:
    writer = vtkXMLUnstructuredGridWriter()
    # Written via memory: on a full disk VTK prints a page of text without the reason.
    writer.WriteToOutputStringOn()
    writer.SetInputData(grid)
    writer.Write()
    path.write_text(writer.GetOutputString(), encoding="ascii", newline="\n")
