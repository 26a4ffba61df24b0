"""Selection on a mesh: base, handles and named regions, without motion.

Vertices are given by ids in the order of the mesh file, from 0; runs of ids by the first and the last one::

    {"format": "apd-selection", "version": 1,
     "mesh": {"vertices": 162, "faces": 320, "digest": "9f86d0…"},
     "base": [[0, 11], 17],
     "handles": [{"name": "Handle 1", "vertices": [[40, 52]]}],
     "regions": [{"name": "Label", "area": 100.0, "vertices": [[60, 99], 104]}]}

All other vertices are free. ``digest`` is :attr:`Mesh.digest`; it can be omitted, and so can empty parts.
A region with the ``area`` null is only measured.
"""

from __future__ import annotations

import json
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE, MOST_HANDLES
from apd_viewer.language import tr

MOST_REGIONS = 8
# Limits of a region's target area in percent, as in geometry.goals.goals.
LEAST_AREA, MOST_AREA = 1.0, 1000.0
# Unicode categories refused in names: control characters and lone surrogates.
_UNFIT = ("Cc", "Cs")


class _NameErrors(NamedTuple):
    """Error sentences about names of handles or regions."""

    many: str
    nameless: str
    unfit: str
    twice: str


_HANDLES = _NameErrors(
    tr("It has {n:,} handles, but the limit is {most}; remove some."),
    tr("One of its handles has no name; name all handles."),
    tr("The name of a handle has invalid characters; correct it."),
    tr("Two of its handles have the same name; rename one."),
)
_REGIONS = _NameErrors(
    tr("It has {n:,} regions, but the limit is {most}; remove some."),
    tr("One of its regions has no name; name all regions."),
    tr("The name of a region has invalid characters; correct it."),
    tr("Two of its regions have the same name; rename one."),
)


def default_name(kind: str, number: int) -> str:
    """Default name of a handle or region, from its kind and number."""
    return tr("{kind} {number}").format(kind=kind, number=number)


@dataclass(frozen=True, eq=False)
class Selection:
    """Labels and region memberships of mesh vertices, with handle and region names.

    Attributes
    ----------
    labels : (n,) uint8 array of BASE, FREE, and HANDLE + k for ``handles[k]``, read-only
    member : (n,) uint8 array, read-only
        k + 1 for the vertices of ``regions[k]``, 0 for those in none.
    handles : tuple of str, never empty
        Names; a handle may hold no vertex.
    regions : tuple of str
        Names; a region may hold no vertex.
    areas : tuple of float or None, one for each region
        Target area in percent of the area at rest; None only measures it.
    is_for_same_mesh : bool
        False if its file says that it was made for other positions or triangles than those of the mesh that
        it was read for, although for as many: for another shape of the mesh, as a rule.
    """

    labels: np.ndarray
    member: np.ndarray
    handles: tuple[str, ...]
    regions: tuple[str, ...] = ()
    areas: tuple[float | None, ...] = ()
    is_for_same_mesh: bool = True

    def __post_init__(self) -> None:
        _check_names(_HANDLES, self.handles, MOST_HANDLES)
        _check_names(_REGIONS, self.regions, MOST_REGIONS)
        if len(self.areas) != len(self.regions) or not all(map(_is_area, self.areas)):
            raise InputError(
                tr("The area of a region is not a percentage from {least:g} to {most:g}; correct it.").format(
                    least=LEAST_AREA, most=MOST_AREA
                )
            )
        if not self.handles or _largest_code(self.labels) >= HANDLE + len(self.handles):
            raise InputError(_HANDLES.nameless)
        if _largest_code(self.member) > len(self.regions):
            raise InputError(_REGIONS.nameless)
        for name in ("labels", "member"):
            array = getattr(self, name)
            object.__setattr__(self, name, frozen(array.copy()) if array.flags.writeable else array)

    @classmethod
    def with_default_names(
        cls,
        labels: np.ndarray,
        member: np.ndarray | None = None,
        handles: Sequence[str] = (),
        regions: Sequence[str] = (),
        areas: Sequence[float | None] = (),
        is_for_same_mesh: bool = True,
    ) -> Selection:
        """Selection with default names for unnamed handles and regions."""
        if member is None:
            member = np.zeros(len(labels), dtype=np.uint8)
        count = max(1, _largest_code(labels) - HANDLE + 1)
        handles = handles or [default_name(tr("Handle"), k + 1) for k in range(count)]
        regions = regions or [default_name(tr("Region"), k + 1) for k in range(_largest_code(member))]
        areas = areas or [None] * len(regions)
        return cls(labels, member, tuple(handles), tuple(regions), tuple(areas), is_for_same_mesh)


def checked_labels(numbers: np.ndarray, n: int) -> np.ndarray:
    """Labels (n,) uint8 from a file's numbers; raises InputError on invalid ones."""
    last = HANDLE + MOST_HANDLES - 1
    otherwise = tr("It has a label other than 0 (base), 1 (free) and 2 to {last} (handles); correct it.")
    return _codes(numbers, n, last, otherwise.format(last=last))


def checked_member(numbers: np.ndarray, n: int) -> np.ndarray:
    """Regions (n,) uint8 from a file's numbers; raises InputError on invalid ones."""
    otherwise = tr("It has a region other than 0 (none) and 1 to {last}; correct it.")
    return _codes(numbers, n, MOST_REGIONS, otherwise.format(last=MOST_REGIONS))


def check_vertex_count(found: int, n: int) -> None:
    """Raise InputError unless the vertex count ``found`` in a file equals ``n``."""
    if found != n:
        raise InputError(
            tr(
                "It is for a mesh of {found:,} vertices, but this mesh has {n:,}; choose the file made "
                "for this mesh."
            ).format(found=found, n=n)
        )


def _codes(numbers: np.ndarray, n: int, last: int, otherwise: str) -> np.ndarray:
    if numbers.ndim != 1 or numbers.dtype.kind not in "iuf":
        raise ValueError(tr("it does not have one number per vertex"))
    check_vertex_count(len(numbers), n)
    if not np.isin(numbers, np.arange(last + 1)).all():
        raise InputError(otherwise)
    return numbers.astype(np.uint8)


def _largest_code(codes: np.ndarray) -> int:
    return int(codes.max(initial=0))


def _is_area(area: object) -> bool:
    if area is None:
        return True
    return isinstance(area, int | float) and not isinstance(area, bool) and LEAST_AREA <= area <= MOST_AREA


def _check_names(refusals: _NameErrors, names: Sequence[str], most: int) -> None:
    if len(names) > most:
        raise InputError(refusals.many.format(n=len(names), most=most))
    for name in names:
        if not isinstance(name, str) or not name.strip():
            raise InputError(refusals.nameless)
        if any(unicodedata.category(sign) in _UNFIT for sign in name):
            raise InputError(refusals.unfit)
    if len(set(names)) < len(names):
        raise InputError(refusals.twice)


_FORMAT, _VERSION = "apd-selection", 1


def selection_to_json(mesh: Mesh, selection: Selection) -> bytes:
    """JSON file content of a selection, with one line per handle and region."""
    labels, member = selection.labels, selection.member
    about = {"vertices": len(mesh.V), "faces": len(mesh.F), "digest": mesh.digest}
    handles = [
        {"name": name, "vertices": _runs(labels == HANDLE + k)} for k, name in enumerate(selection.handles)
    ]
    regions = [
        {"name": name, "area": area, "vertices": _runs(member == k)}
        for k, (name, area) in enumerate(zip(selection.regions, selection.areas, strict=True), start=1)
    ]
    lines = [
        f'{{"format": "{_FORMAT}", "version": {_VERSION},',
        f' "mesh": {_text(about)},',
        f' "base": {_text(_runs(labels == BASE))},',
        f' "handles": {_list(handles)},',
        f' "regions": {_list(regions)}}}\n',
    ]
    return "\n".join(lines).encode()


def _text(value: object) -> str:
    return json.dumps(value, ensure_ascii=False)


def _list(parts: Sequence[Mapping[str, object]]) -> str:
    return "[" + ",\n  ".join(map(_text, parts)) + "]"


def _runs(chosen: np.ndarray) -> list[int | list[int]]:
    """Ids of the vertices in a mask (n,), with consecutive ids as [first, last]."""
    edges = np.diff(chosen.astype(np.int8), prepend=0, append=0)
    first, last = np.flatnonzero(edges == 1).tolist(), (np.flatnonzero(edges == -1) - 1).tolist()
    return [a if a == b else [a, b] for a, b in zip(first, last, strict=True)]


def selection_from_json(content: bytes, mesh: Mesh) -> Selection:
    """Parse a selection; raises ValueError or InputError if it does not fit ``mesh``."""
    document = _object(_parsed_json(content), tr("it"))
    if document.get("format") != _FORMAT:
        raise ValueError(tr("its format is not “{format}”").format(format=_FORMAT))
    if document.get("version") != _VERSION:
        raise InputError(tr("Its version is not supported; save it again as version 1."))
    is_for_same_mesh = _is_for_mesh(_object(document.get("mesh"), tr("its “mesh”")), mesh)
    n = len(mesh.V)
    handles = _parts(document, "handles", MOST_HANDLES)
    regions = _parts(document, "regions", MOST_REGIONS)
    held = [document.get("base", []), *(part.get("vertices") for part in handles)]
    inside = [part.get("vertices") for part in regions]
    return Selection.with_default_names(
        _member_codes(held, n, FREE, [BASE, *range(HANDLE, HANDLE + len(handles))]),
        _member_codes(inside, n, 0, list(range(1, 1 + len(regions)))),
        [part.get("name", "") for part in handles],
        [part.get("name", "") for part in regions],
        [part.get("area") for part in regions],
        is_for_same_mesh,
    )


def _parsed_json(content: bytes) -> object:
    try:
        return json.loads(content.decode("utf-8-sig"))
    except UnicodeDecodeError:
        raise ValueError(tr("it is not text in UTF-8")) from None
    except json.JSONDecodeError as error:
        raise ValueError(tr("line {line:,} is not valid JSON").format(line=error.lineno)) from None
    except (ValueError, RecursionError):  # integers of thousands of digits, or deeply nested brackets
        raise ValueError(tr("it is not valid JSON")) from None


def _object(value: object, what: str) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise ValueError(tr("{what} is not a JSON object").format(what=what))
    return value


def _parts(fields: dict[str, Any], key: str, most: int) -> list[dict[str, Any]]:
    parts = fields.get(key, [])
    if not isinstance(parts, list):
        raise ValueError(tr("its “{key}” are not a list").format(key=key))
    if len(parts) > most:
        raise InputError(
            tr("It has {n:,} {key}, but the limit is {most}; remove some.").format(
                n=len(parts), key=key, most=most
            )
        )
    return [_object(part, tr("one of its “{key}”").format(key=key)) for part in parts]


def _is_for_mesh(about: dict[str, Any], mesh: Mesh) -> bool:
    """True if the digest matches ``mesh``; raises InputError on different counts."""
    n, m, digest = about.get("vertices"), about.get("faces"), about.get("digest", mesh.digest)
    if type(n) is not int or type(m) is not int or not isinstance(digest, str):
        raise ValueError(tr("the numbers of vertices and faces of its mesh are missing"))
    check_vertex_count(n, len(mesh.V))
    if m != len(mesh.F):
        raise InputError(
            tr(
                "It is for a mesh of {found:,} triangles, but this mesh has {n:,}; choose the file made"
                " for this mesh."
            ).format(found=m, n=len(mesh.F))
        )
    return digest == mesh.digest


def _member_codes(parts: list[object], n: int, other: int, codes: list[int]) -> np.ndarray:
    """Codes (n,) uint8: one per part for its vertices, ``other`` elsewhere."""
    result = np.full(n, other, dtype=np.uint8)
    taken = np.zeros(n, dtype=bool)
    for part, code in zip(parts, codes, strict=True):
        ids = _ids(part, n)
        if taken[ids].any():
            raise InputError(
                tr("Vertex {vertex} is in two parts that cannot overlap; remove it from one.").format(
                    vertex=ids[taken[ids]][0]
                )
            )
        taken[ids] = True
        result[ids] = code
    return result


def _ids(runs: object, n: int) -> np.ndarray:
    """Vertex ids (k,) from a list of single ids and [first, last] runs."""
    if not isinstance(runs, list):
        raise ValueError(tr("one of its parts has no list of vertices"))
    pairs = [run if isinstance(run, list) else [run, run] for run in runs]
    if not all(len(pair) == 2 and type(pair[0]) is int and type(pair[1]) is int for pair in pairs):
        raise ValueError(tr("its vertices must be IDs or pairs of IDs"))
    if not all(0 <= first <= last < n for first, last in pairs):
        raise InputError(
            tr("It refers to a vertex that does not exist (IDs run from 0 to {last:,}); correct it.").format(
                last=n - 1
            )
        )
    first, last = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    lengths = last - first + 1
    if lengths.sum() > n:  # checked before expansion, to bound the memory
        raise InputError(tr("One of its parts lists a vertex twice; correct it."))
    ends = np.cumsum(lengths)
    return np.arange(lengths.sum()) + np.repeat(last + 1 - ends, lengths)
