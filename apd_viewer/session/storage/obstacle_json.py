"""Obstacles to and from JSON, in sessions and in files of their own."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.selections.selection import default_name
from apd_viewer.files.storage.json_fields import JsonFields
from apd_viewer.files.storage.regular_files import read_bytes
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.language import tr
from apd_viewer.session.model.named_obstacle import MOST_OBSTACLES, NamedObstacle, ObstacleKind
from apd_viewer.session.storage.part_json import LEAST_POSITIVE

_KINDS = {kind.value: kind for kind in ObstacleKind}


def obstacle_to_json(obstacle: NamedObstacle) -> dict[str, Any]:
    """An obstacle as JSON."""
    return {
        "name": obstacle.name,
        "kind": obstacle.kind.value,
        "place": obstacle.place.tolist(),
        "axis": obstacle.axis.tolist(),
        "radius": float(obstacle.radius),
        "length": float(obstacle.length),
        "shift": obstacle.shift.tolist(),
    }


def obstacle_from_json(fields: JsonFields, name: str = "") -> NamedObstacle:
    """Obstacle restored from JSON; ``name`` is the default name.

    Fields that its kind does not have may be missing, and so may ``shift``.
    """
    kind = fields.text("kind")
    if kind not in _KINDS:
        raise ValueError(tr("the “kind” of an obstacle is unknown"))
    of_kind = _KINDS[kind]
    plate, cylinder = of_kind is ObstacleKind.PLATE, of_kind is ObstacleKind.CYLINDER
    if (plate or cylinder) and not fields.has_value("axis"):
        raise ValueError(tr("the “axis” of an obstacle is missing"))
    found = NamedObstacle(
        fields.text("name") if fields.has_value("name") or not name else name,
        of_kind,
        frozen(fields.numbers("place", 3)),
        radius=0.0 if plate else fields.number("radius", LEAST_POSITIVE),
        length=fields.number("length", LEAST_POSITIVE) if cylinder else 0.0,
        **{key: frozen(fields.numbers(key, 3)) for key in ("axis", "shift") if fields.has_value(key)},
    )
    try:
        found.to_obstacle(1.0)
    except InputError:
        raise ValueError(tr("the “axis” of an obstacle has no direction")) from None
    return found


def vectors_from_json(fields: JsonFields, key: str, count: int) -> np.ndarray:
    """A vector (3,) of each of ``count`` obstacles, (o, 3); (0, 3) without any."""
    if not fields.has_value(key):
        return frozen(np.zeros((0, 3)))
    return frozen(fields.numbers(key, count, 3))


def read_obstacles(path: Path) -> tuple[NamedObstacle, ...]:
    """Obstacles of a JSON file: a list in the form of a session.

    Raises
    ------
    InputError
        If it cannot be read; the message says why.
    """
    try:
        said = JsonFields({"obstacles": json.loads(read_bytes(path))}, "obstacles")
        each = said.nested_list("obstacles", MOST_OBSTACLES)
        return tuple(
            obstacle_from_json(one, default_name(tr("Obstacle"), k)) for k, one in enumerate(each, start=1)
        )
    except OSError as error:
        why = error.strerror or str(error)
    except (json.JSONDecodeError, UnicodeDecodeError, RecursionError):
        why = tr("it is not JSON")
    except ValueError as error:
        why = str(error)
    raise InputError(tr("{name} cannot be read as obstacles: {why}.").format(name=path.name, why=why))
