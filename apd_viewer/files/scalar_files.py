"""Scalars per vertex and per triangle as CSV and PLY."""

from __future__ import annotations

from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.files.tables import write_table
from apd_viewer.language import tr

if TYPE_CHECKING:
    from apd_viewer.geometry.analysis.scalars import Scalars
    from apd_viewer.geometry.mesh.mesh import Mesh

_HEAD = """ply
format binary_little_endian 1.0
comment scalars by apd-viewer
element vertex {n}
property double x
property double y
property double z
{vertices}element face {m}
property list uchar int vertex_indices
{triangles}end_header
"""
# PLY names of the scalar types.
_TYPES = {"<u1": "uchar", "<f8": "double"}


class ScalarRows(Enum):
    """Rows of a CSV table: one per vertex or one per triangle."""

    VERTICES = "vertices"
    TRIANGLES = "triangles"


def check_scalar_file(path: str | Path) -> Path:
    """Return ``path`` if its name allows writing scalars, else raise InputError."""
    path = Path(path)
    if path.suffix.lower() not in (".csv", ".ply"):
        raise InputError(
            tr("{name} cannot hold scalars; use the ending .csv or .ply.").format(name=path.name)
        )
    return path


def write_scalars(
    path: Path, mesh: Mesh, U: np.ndarray, scalars: Scalars, rows: ScalarRows = ScalarRows.VERTICES
) -> None:
    """Write scalars of the shape ``U`` (n, 3) as CSV or PLY, depending on the suffix.

    A PLY contains the shape with vertex and face scalars; a CSV contains the requested ``rows`` with ids in
    the first column. NaN is left empty in a CSV.

    Raises
    ------
    InputError
        If the name is of another kind, or the file cannot be written.
    """
    if check_scalar_file(path).suffix.lower() == ".ply":
        with replacing_file(path) as scratch:
            scratch.write_bytes(_ply_of(mesh, U, scalars))
        return
    if rows is ScalarRows.VERTICES:
        columns = {"vertex": np.arange(len(U)), "x": U[:, 0], "y": U[:, 1], "z": U[:, 2], **scalars.vertices}
    else:
        corners = {name: mesh.F[:, k] for k, name in enumerate("abc")}
        columns = {"triangle": np.arange(len(mesh.F)), **corners, **scalars.triangles}
    write_table(path, list(columns), np.column_stack(list(columns.values())))


def _ply_of(mesh: Mesh, U: np.ndarray, scalars: Scalars) -> bytes:
    vertices = _rows({"x": U[:, 0], "y": U[:, 1], "z": U[:, 2], **scalars.vertices})
    corners = np.empty(len(mesh.F), dtype=[("count", "u1"), ("corners", "<i4", (3,))])
    corners["count"], corners["corners"] = 3, mesh.F
    faces = _rows(scalars.triangles, corners)
    head = _HEAD.format(
        n=len(vertices),
        vertices=_properties(scalars.vertices),
        m=len(faces),
        triangles=_properties(scalars.triangles),
    )
    return head.encode() + vertices.tobytes() + faces.tobytes()


def _kind(column: np.ndarray) -> str:
    return "<f8" if column.dtype.kind == "f" else "<u1"


def _properties(columns: dict[str, np.ndarray]) -> str:
    return "".join(f"property {_TYPES[_kind(column)]} {name}\n" for name, column in columns.items())


def _rows(columns: dict[str, np.ndarray], first: np.ndarray | None = None) -> np.ndarray:
    """Structured array of the columns, preceded by the fields of ``first`` if given."""
    before = [] if first is None else [(name, first.dtype[name]) for name in first.dtype.names or ()]
    own = [(name, np.dtype(_kind(column))) for name, column in columns.items()]
    rows = np.empty(len(next(iter(columns.values()))), dtype=[*before, *own])
    for name, _ in before:
        rows[name] = first[name]  # type: ignore[index]
    for name, column in columns.items():
        rows[name] = column
    return rows
