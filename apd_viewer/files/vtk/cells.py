"""Conversion of VTK cells to polygons."""

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.formats.polygon_mesh import Polygons, strip_triangles
from apd_viewer.language import tr

# VTK cell type numbers.
TRIANGLE, STRIP, POLYGON, PIXEL, QUAD = 5, 6, 7, 8, 9
_FLAT = (TRIANGLE, STRIP, POLYGON, PIXEL, QUAD)
_BELOW = (0, 1, 2, 3, 4)  # empty cells, vertices and lines: kept in the file but not part of the surface
_SOLID = (10, 11, 12, 13, 14, 15, 16, 41, 42)
_CORNERS = {TRIANGLE: 3, PIXEL: 4, QUAD: 4}


def point_positions(values: np.ndarray) -> np.ndarray:
    """Positions (n, 3) from flat coordinates (3 n,) of any numeric type."""
    with np.errstate(invalid="ignore"):  # signalling NaN; rejected later
        return values.astype(np.float64).reshape(-1, 3)


def cells_to_polygons(corner: np.ndarray, start: np.ndarray, points: int) -> Polygons:
    """Polygons from checked connectivity ``corner`` (c,) and offsets ``start``.

    Raises
    ------
    ValueError
        If they do not fit each other, or the number of the points.
    """
    if corner.dtype.kind not in "iu" or start.dtype.kind not in "iu":
        raise ValueError(tr("its faces have fractional vertex indices"))
    corner, start = corner.astype(np.int64), start.astype(np.int64)
    if not len(start) or start[0] != 0 or (np.diff(start) < 0).any() or start[-1] != len(corner):
        raise ValueError(tr("its cells do not fit the list of their vertices"))
    if len(corner) and not (corner.min() >= 0 and corner.max() < points):
        raise ValueError(tr("a face has a vertex index out of range"))
    return Polygons(corner, start)


def check_cell_types(types: np.ndarray) -> None:
    """Raise InputError on cells other than flat faces."""
    if np.isin(types, _SOLID).any():
        raise InputError(
            tr("The mesh has volume cells; extract its surface first, with Extract Surface in ParaView.")
        )
    if not np.isin(types, (*_FLAT, *_BELOW)).all():
        raise InputError(
            tr("The mesh has curved or unknown cells; make triangles first, with Tessellate in ParaView.")
        )


def cell_faces(cells: Polygons, types: np.ndarray) -> Polygons:
    """Faces of cells with given types (p,), in order; strips become triangles.

    Raises InputError on cells other than flat faces, ValueError on invalid ones.
    """
    if len(types) != len(cells.start) - 1:
        raise ValueError(tr("the number of its cells differs from that of their types"))
    check_cell_types(types)
    sizes = np.diff(cells.start)
    for kind, corners in _CORNERS.items():
        if (sizes[types == kind] != corners).any():
            raise ValueError(tr("one of its cells has a wrong number of vertices"))
    corner = cells.corner.copy()
    pixels = cells.start[:-1][types == PIXEL]
    corner[pixels + 2], corner[pixels + 3] = cells.corner[pixels + 3], cells.corner[pixels + 2]
    cells = Polygons(corner, cells.start)
    flat = np.isin(types, _FLAT)
    if flat.all() and not (types == STRIP).any():
        return cells
    return _flat_polygons(cells, flat, types == STRIP)


def _flat_polygons(cells: Polygons, flat: np.ndarray, strips: np.ndarray) -> Polygons:
    """Polygons of the flat cells, with strips split into triangles."""
    corners, sizes, start = [], [], cells.start.tolist()
    for k in np.flatnonzero(flat).tolist():
        own = cells.corner[start[k] : start[k + 1]]
        faces = strip_triangles(own) if strips[k] else own[None]
        corners.append(faces.ravel())
        sizes += [faces.shape[1]] * len(faces)
    corner = np.concatenate([np.empty(0, dtype=np.int64), *corners])
    return Polygons(corner, np.concatenate([[0], np.cumsum(sizes, dtype=np.int64)]))
