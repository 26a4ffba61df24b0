"""3MF: objects of a build, placed by transforms of build items and components.

Object numbers are local to their part (3MF Core Specification 1.3 and Production Extension 1.1).

Section 4 of the 3MF Core Specification 1.3, and the extensions for production, beam lattices and slices.
"""

from __future__ import annotations

import io
import posixpath
import zipfile
from array import array
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple
from urllib.parse import unquote
from xml.parsers import expat

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.formats.polygon_mesh import ParsedMesh
from apd_viewer.files.storage.archive import ARCHIVE_ERRORS, largest_unpacked_size
from apd_viewer.files.storage.regular_files import LARGEST_FILE, too_large_error
from apd_viewer.language import tr

MOST_BYTES = 1 << 31  # unpacked bytes; a larger archive is broken or malicious
_MOST_VERTICES = LARGEST_FILE // 24  # 24 bytes per vertex: three doubles
MOST_OBJECT_USES = 1 << 16  # maximum number of object references, to bound the work for nested components
_START = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
_RELATIONSHIP = "http://schemas.openxmlformats.org/package/2006/relationships Relationship"
_USUAL = "3D/3dmodel.model"  # default name of the main part
# For each 3MF unit, the mesh unit and the conversion factor to it.
_UNITS = {
    "micron": ("mm", 1e-3),
    "millimeter": ("mm", 1.0),
    "centimeter": ("cm", 1.0),
    "inch": ("in", 1.0),
    "foot": ("ft", 1.0),
    "meter": ("m", 1.0),
}
_DEEPEST = 100  # largest nesting depth of components


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
    V, F, count, left = [np.empty((0, 3))], [np.empty((0, 3), dtype=np.int64)], 0, _MOST_VERTICES
    shown: list[ModelObject] = []
    for each, matrix in package.placed_objects():
        shown.append(each)
        if each.is_support or not len(each.F):  # a beam lattice has vertices but no triangles
            continue
        left -= len(each.F)
        if count + len(each.V) > _MOST_VERTICES or left < 0:
            raise too_large_error(tr("all its components"))
        with np.errstate(all="ignore"):  # invalid positions are rejected later
            V.append((each.V @ matrix[:3, :3].T + matrix[:3, 3]) * factor)
            mirrors = np.linalg.det(matrix[:3, :3]) < 0.0
        F.append((each.F[:, [0, 2, 1]] if mirrors else each.F) + count)
        count += len(each.V)
    return ParsedMesh(np.vstack(V), np.vstack(F), None, tuple(_remarks(shown, count > 0)), unit)


def _remarks(shown: list[ModelObject], has_triangles: bool) -> Iterator[str]:
    """Remarks on unread beams and slices; raises InputError without triangles."""
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
    if any(each.has_appearance for each in shown):
        yield tr("The colours and materials of the file are not read.")
    if any(each.is_support for each in shown):
        yield tr("The support structures of the file are left out.")


class _Package:
    """3MF archive with its model parts, each parsed once.

    Attributes
    ----------
    main : PackageModel
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
        # Part names are case-insensitive (ECMA-376, part 2, 6.2.2).
        self._names = {_part_name(entry.filename): entry.filename for entry in entries}
        self._models: dict[str, PackageModel] = {}
        self._main = self._start()
        self.main = self._model(self._main)

    def placed_objects(self) -> Iterator[tuple[ModelObject, np.ndarray]]:
        """Objects of the build and its components, with their world matrices (4, 4)."""
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
            with np.errstate(all="ignore"):  # invalid positions are rejected later
                there = matrix @ use.matrix
            yield found, there
            below = above | {(path, use.object_id)}
            todo += [(component, path, there, below) for component in reversed(found.components)]

    def _start(self) -> str:
        """Name of the main model part, from the relationships of the package."""
        targets: list[str] = []

        def begin(name: str, told: dict[str, str]) -> None:
            if name == _RELATIONSHIP and told.get("Type") == _START:
                targets.append(told.get("Target", ""))

        if "_rels/.rels" in self._names:
            read_xml(self._content("_rels/.rels"), begin)
        return _part_name(targets[0] if targets else _USUAL)

    def _model(self, name: str) -> PackageModel:
        if name not in self._models:
            model = self._models[name] = PackageModel(self._content(name))
            if model.unit != self._models[self._main].unit:
                raise ValueError(tr("its parts have different units"))
        return self._models[name]

    def _content(self, name: str) -> bytes:
        if name not in self._names:
            raise ValueError(tr("its part {part} is missing").format(part=name))
        try:
            return self._archive.read(self._names[name])
        except ARCHIVE_ERRORS as error:  # damaged, or compressed by an unknown method
            raise ValueError(tr("it is not an archive, or it is damaged")) from error


def _part_name(said: str) -> str:
    """Part name in lower case, without the leading slash."""
    return posixpath.normpath("/" + unquote(said)).lstrip("/").lower()


_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/"  # the specification's year follows
_PRODUCTION = "http://schemas.microsoft.com/3dmanufacturing/production/"
_BEAMS = "http://schemas.microsoft.com/3dmanufacturing/beamlattice/"
_SLICES = "http://schemas.microsoft.com/3dmanufacturing/slice/"
# Accepted required extensions: read, reported as unread, or only about appearance.
_MAY_REQUIRE = (
    _CORE,
    _PRODUCTION,
    _BEAMS,
    _SLICES,
    "http://schemas.microsoft.com/3dmanufacturing/material/",
    "http://schemas.microsoft.com/3dmanufacturing/trianglesets/",
)


class ObjectUse(NamedTuple):
    """Reference to an object by a component or a build item.

    Attributes
    ----------
    path : str
        Part of the object; empty is the same part.
    object_id : str
        Of the object in its part.
    matrix : (4, 4) float array
        Matrix to the coordinates of the build.
    """

    path: str
    object_id: str
    matrix: np.ndarray


@dataclass
class ModelObject:
    """Vertices, triangles and components of one object."""

    coordinates: array[float] = field(default_factory=lambda: array("d"))
    corners: array[int] = field(default_factory=lambda: array("q"))
    components: list[ObjectUse] = field(default_factory=list)
    has_beams: bool = False
    has_slices: bool = False
    has_appearance: bool = False
    is_support: bool = False

    @cached_property
    def V(self) -> np.ndarray:
        """Vertex positions (n, 3)."""
        return np.array(self.coordinates, dtype=np.float64).reshape(-1, 3)

    @cached_property
    def F(self) -> np.ndarray:
        """Triangles (m, 3); raises ValueError if one refers to a missing vertex."""
        F = np.array(self.corners, dtype=np.int64).reshape(-1, 3)
        count = len(self.coordinates) // 3
        if len(F) and not 0 <= F.min() <= F.max() < count:
            raise ValueError(
                tr("a triangle refers to vertex {vertex:,} of {count:,}").format(
                    vertex=int(F.max() if F.max() >= count else F.min()), count=count
                )
            )
        return F


class PackageModel:
    """Parsed model part: its unit, objects and build items.

    Attributes
    ----------
    unit : str
        As the part names it.
    objects : dict
        By their numbers.
    """

    def __init__(self, content: bytes) -> None:
        self.unit = "millimeter"
        self.objects: dict[str, ModelObject] = {}
        self.build_items: list[ObjectUse] = []
        self._object = ModelObject()  # receives elements outside any object
        self._spaces: dict[str, str] = {}
        read_xml(content, self._begin, self._declare)

    def _declare(self, prefix: str | None, space: str | None) -> None:
        self._spaces[prefix or ""] = space or ""

    def _begin(self, name: str, attributes: dict[str, str]) -> None:
        space, _, element = name.rpartition(" ")
        if space.startswith(_CORE):
            if element in _ELEMENTS:
                _ELEMENTS[element](self, attributes)
        elif space.startswith(_BEAMS) and element == "beam":
            self._object.has_beams = True

    def _read_model(self, attributes: dict[str, str]) -> None:
        self.unit = attributes.get("unit", self.unit)
        for prefix in attributes.get("requiredextensions", "").split():
            space = self._spaces.get(prefix, prefix)
            if not space.startswith(_MAY_REQUIRE):
                raise ValueError(
                    tr("it requires {extension}, which is not supported").format(extension=space)
                )

    def _read_object(self, attributes: dict[str, str]) -> None:
        number = _text(attributes, "id")
        if number in self.objects:
            raise ValueError(tr("two objects of one part have the number {number}").format(number=number))
        self._object = self.objects[number] = ModelObject()
        self._object.is_support = attributes.get("type") in ("support", "solidsupport")
        self._object.has_appearance = "pid" in attributes
        self._object.has_slices = any(name.startswith(_SLICES) for name in attributes)

    def _read_vertex(self, attributes: dict[str, str]) -> None:
        try:
            self._object.coordinates.extend(
                (float(attributes["x"]), float(attributes["y"]), float(attributes["z"]))
            )
        except (KeyError, ValueError):
            raise ValueError(tr("a vertex has a coordinate that is not a number")) from None

    def _read_triangle(self, attributes: dict[str, str]) -> None:
        self._object.has_appearance |= "pid" in attributes
        try:
            self._object.corners.extend((int(attributes["v1"]), int(attributes["v2"]), int(attributes["v3"])))
        except (KeyError, ValueError, OverflowError):
            raise ValueError(tr("a triangle has a vertex that is not a number")) from None

    def _read_component(self, attributes: dict[str, str]) -> None:
        self._object.components.append(_use(attributes))

    def _read_item(self, attributes: dict[str, str]) -> None:
        self.build_items.append(_use(attributes))


_ELEMENTS = {
    "model": PackageModel._read_model,
    "object": PackageModel._read_object,
    "vertex": PackageModel._read_vertex,
    "triangle": PackageModel._read_triangle,
    "component": PackageModel._read_component,
    "item": PackageModel._read_item,
}


def _use(attributes: dict[str, str]) -> ObjectUse:
    paths = [
        path for name, path in attributes.items() if name.startswith(_PRODUCTION) and name.endswith(" path")
    ]
    return ObjectUse(
        paths[0] if paths else "", _text(attributes, "objectid"), _transform(attributes.get("transform"))
    )


def _transform(said: str | None) -> np.ndarray:
    """Matrix (4, 4) of a transform attribute of twelve numbers."""
    M = np.eye(4)
    if said is not None:
        try:
            M[:3] = np.array([float(word) for word in said.split()]).reshape(4, 3).T
        except ValueError:
            raise ValueError(tr("a transform does not have twelve numbers")) from None
    return M


def _text(attributes: dict[str, str], name: str) -> str:
    if name not in attributes:
        raise ValueError(tr("an object of it has no number"))
    return attributes[name].strip()


def read_xml(
    content: bytes,
    on_element: Callable[[str, dict[str, str]], None],
    on_namespace: Callable[[str | None, str | None], None] | None = None,
) -> None:
    """Call ``on_element(name, attributes)`` per element, named "namespace name".

    Raises
    ------
    ValueError
        If it is damaged, or declares entities.
    """
    parser = expat.ParserCreate(namespace_separator=" ")
    parser.StartElementHandler = on_element
    parser.StartNamespaceDeclHandler = on_namespace
    parser.StartDoctypeDeclHandler = _refuse_entities
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        raise ValueError(
            tr("its XML is damaged at line {line:,}, column {column:,}").format(
                line=error.lineno, column=error.offset + 1
            )
        ) from None
    except LookupError:
        raise ValueError(tr("the encoding of its XML is not supported")) from None


def _refuse_entities(*_: object) -> None:
    raise ValueError(tr("a part of it declares XML entities, which 3MF does not allow"))
