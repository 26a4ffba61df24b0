"""glTF documents: validated lookups, and nodes with their matrices.

Every look into the document asks first whether there is what the format promises, or says what is wrong.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from apd_viewer.language import tr

_MOST = 1 << 40  # bytes or numbers


def one(document: dict[str, Any], what: str, k: object) -> dict[str, Any]:
    """Element ``k`` of an array of the document; raises ValueError if missing."""
    things = a_list(document, what)
    if type(k) is not int or not 0 <= k < len(things) or not isinstance(things[k], dict):
        raise ValueError(tr("it refers to an entry that is missing from its {what}").format(what=what))
    return things[k]


def a_list(told: dict[str, Any], key: str) -> list[Any]:
    """List under a key; raises ValueError if it is none."""
    found = told.get(key, [])
    if not isinstance(found, list):
        raise ValueError(tr("its {key} are not a list").format(key=key))
    return found


def whole(told: dict[str, Any], key: str, default: int | None = None) -> int:
    """A number of bytes or things; raises ValueError if it is missing or absurd."""
    number = told.get(key, default)
    if isinstance(number, float) and number.is_integer():
        number = int(number)
    if type(number) is not int or not 0 <= number <= _MOST:
        raise ValueError(tr("a {key} in it is missing or out of range").format(key=key))
    return number


def parts(document: dict[str, Any], mesh: int) -> list[dict[str, Any]]:
    """The primitives of a mesh; all have attributes."""
    found = a_list(one(document, "meshes", mesh), "primitives")
    if not all(isinstance(part, dict) and isinstance(part.get("attributes"), dict) for part in found):
        raise ValueError(tr("a mesh primitive has no attributes"))
    return found


def placed(document: dict[str, Any]) -> dict[int, np.ndarray]:
    """Nodes of the scene with a mesh, and their world matrices (4, 4)."""
    found: dict[int, np.ndarray] = {}
    seen: set[int] = set()
    todo = [(root, np.eye(4)) for root in reversed(_roots(document))]
    while todo:
        k, above = todo.pop()
        node = one(document, "nodes", k)
        if k in seen:
            raise ValueError(tr("its nodes do not form a tree"))
        seen.add(k)
        with np.errstate(all="ignore"):  # absurd positions are refused later
            matrix = above @ _matrix(node)
        if "mesh" in node:
            found[k] = matrix
        todo += [(child, matrix) for child in reversed(a_list(node, "children"))]
    return found


def _roots(document: dict[str, Any]) -> list[Any]:
    if document.get("scenes"):
        return a_list(one(document, "scenes", document.get("scene", 0)), "nodes")
    count = len(a_list(document, "nodes"))
    below = [a_list(one(document, "nodes", k), "children") for k in range(count)]
    children = {child for some in below for child in some if isinstance(child, int)}
    return [k for k in range(count) if k not in children]


def _matrix(node: dict[str, Any]) -> np.ndarray:
    """The matrix (4, 4) of a node to the one above."""
    if "matrix" in node:
        return _numbers(node, "matrix", np.eye(4).ravel()).reshape(4, 4).T
    M = np.eye(4)
    x, y, z, w = _numbers(node, "rotation", [0, 0, 0, 1])
    R = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    M[:3, :3] = R * _numbers(node, "scale", [1, 1, 1])
    M[:3, 3] = _numbers(node, "translation", [0, 0, 0])
    return M


def _numbers(node: dict[str, Any], key: str, default: Any) -> np.ndarray:
    given = node.get(key, default)
    if given is not default:
        if not isinstance(given, list) or len(given) != len(default):
            raise ValueError(
                tr("the {key} of a node does not have {n} numbers").format(key=key, n=len(default))
            )
        if not all(isinstance(number, int | float) and _is_sane(number) for number in given):
            raise ValueError(tr("the {key} of a node contains something other than numbers").format(key=key))
    return np.array(given, dtype=np.float64)


def _is_sane(number: float) -> bool:
    return -1e100 < number < 1e100 and not math.isnan(number)


def carried(matrix: np.ndarray, local: np.ndarray) -> np.ndarray:
    """Positions (n, 3) transformed by the matrix."""
    with np.errstate(all="ignore"):  # absurd positions are refused later
        return local @ matrix[:3, :3].T + matrix[:3, 3]
