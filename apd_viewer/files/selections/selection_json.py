"""Selections as JSON: complete, readable by people and scripts.

A vertex is named by its id in the order of the mesh's file, from 0, a run of them by the first and the last::

    {"format": "apd-selection", "version": 1,
     "mesh": {"vertices": 162, "faces": 320, "digest": "9f86d0…"},
     "base": [[0, 11], 17],
     "handles": [{"name": "Handle 1", "vertices": [[40, 52]]}],
     "regions": [{"name": "Label", "area": 100.0, "vertices": [[60, 99], 104]}]}

What is in none of the parts is free. ``digest`` is :attr:`Mesh.digest`; it may be left out, and so may empty
parts. An ``area`` that is null is only measured.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.selections.selection import MOST_REGIONS, Selection, check_vertex_count
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE, MOST_HANDLES
from apd_viewer.language import tr

_FORMAT, _VERSION = "apd-selection", 1


def selection_to_json(mesh: Mesh, selection: Selection) -> bytes:
    """The file of a selection, with a line for each part."""
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
    """Ids of chosen vertices (n,) bool: runs as [first, last], single ids alone."""
    edges = np.diff(chosen.astype(np.int8), prepend=0, append=0)
    first, last = np.flatnonzero(edges == 1).tolist(), (np.flatnonzero(edges == -1) - 1).tolist()
    return [a if a == b else [a, b] for a, b in zip(first, last, strict=True)]


def selection_from_json(content: bytes, mesh: Mesh) -> Selection:
    """Selection in a file; raises ValueError or InputError if not for ``mesh``."""
    said = _object(_loaded(content), tr("it"))
    if said.get("format") != _FORMAT:
        raise ValueError(tr("its format is not “{format}”").format(format=_FORMAT))
    if said.get("version") != _VERSION:
        raise InputError(tr("Its version is not supported; save it again as version 1."))
    same_mesh = _is_for(_object(said.get("mesh"), tr("its “mesh”")), mesh)
    n = len(mesh.V)
    handles = _parts(said, "handles", MOST_HANDLES)
    regions = _parts(said, "regions", MOST_REGIONS)
    held = [said.get("base", []), *(part.get("vertices") for part in handles)]
    inside = [part.get("vertices") for part in regions]
    return Selection.with_default_names(
        _codes(held, n, FREE, [BASE, *range(HANDLE, HANDLE + len(handles))]),
        _codes(inside, n, 0, list(range(1, 1 + len(regions)))),
        [part.get("name", "") for part in handles],
        [part.get("name", "") for part in regions],
        [part.get("area") for part in regions],
        same_mesh,
    )


def _loaded(content: bytes) -> object:
    try:
        return json.loads(content.decode("utf-8-sig"))
    except UnicodeDecodeError:
        raise ValueError(tr("it is not text in UTF-8")) from None
    except json.JSONDecodeError as error:
        raise ValueError(tr("line {line:,} is not valid JSON").format(line=error.lineno)) from None
    except (ValueError, RecursionError):  # numbers of thousands of digits, deeply nested brackets
        raise ValueError(tr("it is not valid JSON")) from None


def _object(value: object, what: str) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise ValueError(tr("{what} is not a JSON object").format(what=what))
    return value


def _parts(said: dict[str, Any], key: str, most: int) -> list[dict[str, Any]]:
    parts = said.get(key, [])
    if not isinstance(parts, list):
        raise ValueError(tr("its “{key}” are not a list").format(key=key))
    if len(parts) > most:
        raise InputError(
            tr("It has {n:,} {key}, but the limit is {most}; remove some.").format(
                n=len(parts), key=key, most=most
            )
        )
    return [_object(part, tr("one of its “{key}”").format(key=key)) for part in parts]


def _is_for(about: dict[str, Any], mesh: Mesh) -> bool:
    """True if made for this very mesh; raises InputError on other counts."""
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


def _codes(parts: list[object], n: int, other: int, codes: list[int]) -> np.ndarray:
    """Codes (n,) uint8: one for the vertices of each part, ``other`` elsewhere."""
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
    """Vertices (k,) int named by ids and runs of ids."""
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
    if lengths.sum() > n:  # before the ids exhaust the memory
        raise InputError(tr("One of its parts lists a vertex twice; correct it."))
    ends = np.cumsum(lengths)
    return np.arange(lengths.sum()) + np.repeat(last + 1 - ends, lengths)
