"""A model part of 3MF: its objects and its build, without those of other parts.

Section 4 of the 3MF Core Specification 1.3, and the extensions for production, beam lattices and slices.
"""

from __future__ import annotations

from array import array
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple
from xml.parsers import expat

import numpy as np

from apd_viewer.language import tr

if TYPE_CHECKING:
    from collections.abc import Callable

_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/"  # and the year
_PRODUCTION = "http://schemas.microsoft.com/3dmanufacturing/production/"
_BEAMS = "http://schemas.microsoft.com/3dmanufacturing/beamlattice/"
_SLICES = "http://schemas.microsoft.com/3dmanufacturing/slice/"
# What a model may require: read, said not to be read, or about looks.
_MAY_REQUIRE = (
    _CORE,
    _PRODUCTION,
    _BEAMS,
    _SLICES,
    "http://schemas.microsoft.com/3dmanufacturing/material/",
    "http://schemas.microsoft.com/3dmanufacturing/trianglesets/",
)


class ObjectUse(NamedTuple):
    """An object shown by a component or by the build.

    Attributes
    ----------
    path : str
        Part of the object; empty is the same part.
    object_id : str
        Of the object in its part.
    matrix : (4, 4) float array
        To where it is shown.
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

    @cached_property
    def V(self) -> np.ndarray:
        """Positions (n, 3)."""
        return np.array(self.coordinates, dtype=np.float64).reshape(-1, 3)

    @cached_property
    def F(self) -> np.ndarray:
        """Triangles (m, 3); ValueError if one refers to a missing vertex."""
        F = np.array(self.corners, dtype=np.int64).reshape(-1, 3)
        count = len(self.coordinates) // 3
        if len(F) and not 0 <= F.min() <= F.max() < count:
            raise ValueError(
                tr("a triangle refers to vertex {vertex:,} of {count:,}").format(
                    vertex=int(F.max() if F.max() >= count else F.min()), count=count
                )
            )
        return F


class Model:
    """A model part, read at once.

    Attributes
    ----------
    unit : str
        As the part names it.
    objects : dict
        By their numbers.
    build_items : list of ObjectUse
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
        self._object.has_slices = any(name.startswith(_SLICES) for name in attributes)

    def _read_vertex(self, attributes: dict[str, str]) -> None:
        try:
            self._object.coordinates.extend(
                (float(attributes["x"]), float(attributes["y"]), float(attributes["z"]))
            )
        except (KeyError, ValueError):
            raise ValueError(tr("a vertex has a coordinate that is not a number")) from None

    def _read_triangle(self, attributes: dict[str, str]) -> None:
        try:
            self._object.corners.extend((int(attributes["v1"]), int(attributes["v2"]), int(attributes["v3"])))
        except (KeyError, ValueError, OverflowError):
            raise ValueError(tr("a triangle has a vertex that is not a number")) from None

    def _read_component(self, attributes: dict[str, str]) -> None:
        self._object.components.append(_use(attributes))

    def _read_item(self, attributes: dict[str, str]) -> None:
        self.build_items.append(_use(attributes))


_ELEMENTS = {
    "model": Model._read_model,
    "object": Model._read_object,
    "vertex": Model._read_vertex,
    "triangle": Model._read_triangle,
    "component": Model._read_component,
    "item": Model._read_item,
}


def _use(attributes: dict[str, str]) -> ObjectUse:
    paths = [
        path for name, path in attributes.items() if name.startswith(_PRODUCTION) and name.endswith(" path")
    ]
    return ObjectUse(
        paths[0] if paths else "", _text(attributes, "objectid"), _transform(attributes.get("transform"))
    )


def _transform(said: str | None) -> np.ndarray:
    """Matrix (4, 4) of a transform: twelve numbers, four rows."""
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
    """Call ``on_element(name, attributes)`` for each; names are "namespace name".

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


def _refuse_entities(*_: object) -> None:
    raise ValueError(tr("a part of it declares XML entities, which 3MF does not allow"))
