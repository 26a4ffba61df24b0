"""3MF: the objects of a build, each where its components and the build put it.

Numbers of objects hold within their own part (3MF Core Specification 1.3 and Production Extension 1.1).
"""

from __future__ import annotations

import io
import posixpath
import zipfile
from typing import TYPE_CHECKING
from urllib.parse import unquote

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.formats.model_3mf import Model, ModelObject, read_xml
from apd_viewer.files.formats.parsed_mesh import ParsedMesh
from apd_viewer.files.storage.archive import ARCHIVE_ERRORS, largest_unpacked_size
from apd_viewer.files.storage.sibling_files import LARGEST_FILE, too_large_error
from apd_viewer.language import tr

if TYPE_CHECKING:
    from collections.abc import Iterator

MOST_BYTES = 1 << 31  # bytes; a larger archive is broken or malicious
_MOST_VERTICES = LARGEST_FILE // 24  # a position is three doubles
MOST_OBJECT_USES = 1 << 16  # of objects, a few seconds; components of components multiply
_START = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
_RELATIONSHIP = "http://schemas.openxmlformats.org/package/2006/relationships Relationship"
_USUAL = "3D/3dmodel.model"  # the main part where none is named
# Of a unit of 3MF, the unit in which it is read, and how many of that it is.
_UNITS = {
    "micron": ("mm", 1e-3),
    "millimeter": ("mm", 1.0),
    "centimeter": ("cm", 1.0),
    "inch": ("in", 1.0),
    "foot": ("ft", 1.0),
    "meter": ("m", 1.0),
}
_DEEPEST = 100  # components of components


def read_3mf(content: bytes) -> ParsedMesh:
    """Positions (n, 3) and triangles (m, 3) of all objects of a 3MF build.

    Raises
    ------
    ValueError
        If the file cannot be understood.
    InputError
        If it holds something other than triangles.
    """
    package = _Package(content)
    if package.main.unit not in _UNITS:
        raise ValueError(tr("its unit “{unit}” is unknown").format(unit=package.main.unit))
    unit, factor = _UNITS[package.main.unit]
    V, F, count = [np.empty((0, 3))], [np.empty((0, 3), dtype=np.int64)], 0
    shown: list[ModelObject] = []
    for each, matrix in package.placed():
        shown.append(each)
        if not len(each.F):  # the ends of beams
            continue
        if count + len(each.V) > _MOST_VERTICES:
            raise too_large_error(tr("all its components"))
        with np.errstate(all="ignore"):  # absurd positions are refused later
            V.append((each.V @ matrix[:3, :3].T + matrix[:3, 3]) * factor)
            mirrors = np.linalg.det(matrix[:3, :3]) < 0.0
        F.append((each.F[:, [0, 2, 1]] if mirrors else each.F) + count)
        count += len(each.V)
    return ParsedMesh(np.vstack(V), np.vstack(F), None, tuple(_remarks(shown, count > 0)), unit)


def _remarks(shown: list[ModelObject], has_triangles: bool) -> Iterator[str]:
    """Sentences on things not read; raise InputError if there is nothing else."""
    if not shown:
        raise ValueError(tr("its build places no object"))
    for there, alone, beside in (
        (
            any(each.has_beams for each in shown),
            tr("The file holds beam lattices and no triangles; export them as a mesh first."),
            tr("The beam lattices of the file are not read; its triangles are."),
        ),
        (
            any(each.has_slices for each in shown),
            tr("The file holds slices and no triangles; export the mesh that they were cut from."),
            tr("The slices of the file are not read; its triangles are."),
        ),
    ):
        if there and not has_triangles:
            raise InputError(alone)
        if there:
            yield beside


class _Package:
    """An archive with its model parts, each read once.

    Attributes
    ----------
    main : Model
        The part that the package begins with.
    """

    def __init__(self, content: bytes) -> None:
        try:
            self._archive = zipfile.ZipFile(io.BytesIO(content))
            entries = self._archive.infolist()
        except ARCHIVE_ERRORS as error:
            raise ValueError(tr("it is not an archive, or it is damaged")) from error
        size = sum(entry.file_size for entry in entries)
        if size > min(MOST_BYTES, largest_unpacked_size(len(content))):
            raise ValueError(tr("it would unpack to {size:,} bytes").format(size=size))
        # Names of parts are the same in small and large letters (ECMA-376, part 2, 6.2.2).
        self._names = {entry.filename.lower(): entry.filename for entry in entries}
        self._models: dict[str, Model] = {}
        self._main = self._start()
        self.main = self._model(self._main)

    def placed(self) -> Iterator[tuple[ModelObject, np.ndarray]]:
        """Objects of the build and of its components, each with its matrix (4, 4)."""
        todo = [
            (use, self._main, np.eye(4), frozenset[tuple[str, str]]())
            for use in reversed(self.main.build_items)
        ]
        left = MOST_OBJECT_USES
        while todo:
            use, home, matrix, above = todo.pop()
            path = _part_name(use.path) if use.path else home
            found, left = self._model(path).objects.get(use.object_id), left - 1
            if found is None:
                raise ValueError(
                    tr("its object {number} is missing from {part}").format(number=use.object_id, part=path)
                )
            if (path, use.object_id) in above or len(above) > _DEEPEST or left < 0:
                raise ValueError(tr("its components are nested without end"))
            with np.errstate(all="ignore"):  # absurd positions are refused later
                there = matrix @ use.matrix
            yield found, there
            below = above | {(path, use.object_id)}
            todo += [(component, path, there, below) for component in reversed(found.components)]

    def _start(self) -> str:
        """Name of the main part: the relationships of the package tell it."""
        targets: list[str] = []

        def begin(name: str, told: dict[str, str]) -> None:
            if name == _RELATIONSHIP and told.get("Type") == _START:
                targets.append(told.get("Target", ""))

        if "_rels/.rels" in self._names:
            read_xml(self._content("_rels/.rels"), begin)
        return _part_name(targets[0] if targets else _USUAL)

    def _model(self, name: str) -> Model:
        if name not in self._models:
            model = self._models[name] = Model(self._content(name))
            if model.unit != self._models[self._main].unit:
                raise ValueError(tr("its parts have different units"))
        return self._models[name]

    def _content(self, name: str) -> bytes:
        if name not in self._names:
            raise ValueError(tr("its part {part} is missing").format(part=name))
        try:
            return self._archive.read(self._names[name])
        except ARCHIVE_ERRORS as error:  # or its compression is unknown
            raise ValueError(tr("it is not an archive, or it is damaged")) from error


def _part_name(said: str) -> str:
    """Name of a part in small letters, without the slash at its beginning."""
    return posixpath.normpath("/" + unquote(said)).lstrip("/").lower()
