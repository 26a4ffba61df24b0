"""JSON conversion of handles, regions, poses, measurements and obstacles."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.selections.selection import default_name
from apd_viewer.files.storage.json_fields import JsonFields
from apd_viewer.files.storage.regular_files import read_bytes
from apd_viewer.geometry.measuring.measurement import Contents, Measurement, Plane
from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.geometry.measuring.surface_point import SurfacePoint
from apd_viewer.geometry.mesh.arrays import LARGEST_COORDINATE, frozen
from apd_viewer.geometry.pose.constraints import MOST_HANDLES
from apd_viewer.language import tr
from apd_viewer.session.model.handles_and_regions import (
    Handle,
    HandlePlacement,
    NamedPose,
    NamedRegion,
    PartFlags,
)
from apd_viewer.session.model.named_obstacle import MOST_OBSTACLES, NamedObstacle, ObstacleKind

LARGEST_NUMBER = 1e9  # largest weight or percentage
LEAST_POSITIVE = 1e-12  # smallest number accepted as positive
_MOST_WAYPOINTS = 10_000  # maximum number of waypoints of a handle
_MOTIONLESS = [0.0, 0.0, 0.0, 1.0]  # last row of an affine matrix


def handle_to_json(handle: Handle) -> dict[str, Any]:
    """JSON of a handle."""
    pivot = None if handle.pivot is None else handle.pivot.tolist()
    said = {"name": handle.name, "pose": handle.pose.tolist(), "pivot": pivot, **flags_to_json(handle.flags)}
    if handle.waypoints:
        said["waypoints"] = [each.tolist() for each in handle.waypoints]
    if handle.earlier_poses:
        said["earlier"] = [each.tolist() for each in handle.earlier_poses]
    if handle.former_twist_axis is not None:
        said["line"] = handle.former_twist_axis.tolist()
    return {**said, "falloff": number_to_json(handle.falloff)} if handle.falloff else said


def pose_to_json(pose: NamedPose) -> dict[str, Any]:
    """JSON of a named pose."""
    return {
        "name": pose.name,
        "handles": [
            {
                "name": each.handle,
                "pose": each.pose.tolist(),
                "waypoints": [waypoint.tolist() for waypoint in each.waypoints],
            }
            for each in pose.placements
        ],
    }


def flags_to_json(flags: PartFlags) -> dict[str, bool]:
    """JSON of the flags set; older programs ignore unknown ones."""
    return {name: on for name, on in flags._asdict().items() if on}


def flags_from_json(fields: JsonFields) -> PartFlags:
    """Flags from JSON."""
    return PartFlags(**{name: fields.has_value(name) and fields.flag(name) for name in PartFlags._fields})


def number_to_json(value: float | None) -> float | None:
    """JSON of a number; None becomes null."""
    return None if value is None else float(value)


def handle_from_json(fields: JsonFields) -> Handle:
    """Handle from JSON."""
    pose, waypoints = _path(fields)
    pivot = frozen(fields.array("pivot", 3)) if fields.has_value("pivot") else None
    falloff = fields.number("falloff", 0.0, LARGEST_COORDINATE) if fields.has_value("falloff") else 0.0
    line = frozen(fields.array("line", 3)) if fields.has_value("line") else None
    return Handle(
        fields.text("name"),
        pose,
        pivot,
        falloff,
        waypoints,
        flags_from_json(fields),
        _earlier_poses(fields),
        line,
    )


def pose_from_json(fields: JsonFields) -> NamedPose:
    """Named pose from JSON."""
    placed = fields.nested_list("handles", MOST_HANDLES)
    return NamedPose(
        fields.text("name"), tuple(HandlePlacement(each.text("name"), *_path(each)) for each in placed)
    )


def _path(fields: JsonFields) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
    """Pose of a handle, and the waypoints to it."""
    pose = frozen(fields.array("pose", 4, 4))
    waypoints = tuple(map(frozen, fields.arrays("waypoints", _MOST_WAYPOINTS, 4, 4)))
    _check_affine(pose, *waypoints)
    return pose, waypoints


def _check_affine(*poses: np.ndarray) -> None:
    if any(not np.array_equal(each[3], _MOTIONLESS) for each in poses):
        raise ValueError(
            tr("the “pose” of a handle is not an affine transform: its last row must be 0 0 0 1")
        )


def _earlier_poses(fields: JsonFields) -> tuple[np.ndarray, ...]:
    """Poses of a handle on its path from rest to its initial position."""
    poses = tuple(map(frozen, fields.arrays("earlier", _MOST_WAYPOINTS, 4, 4)))
    _check_affine(*poses)
    if any(not np.linalg.det(each) for each in poses):
        raise ValueError(tr("an “earlier” pose of a handle flattens it"))
    return poses


def region_from_json(fields: JsonFields) -> NamedRegion:
    """Region from JSON."""
    return NamedRegion(fields.text("name"), percent_from_json(fields, "area"), flags_from_json(fields))


def percent_from_json(fields: JsonFields, key: str) -> float | None:
    """Percentage; None if the field is missing."""
    return fields.number(key, LEAST_POSITIVE, LARGEST_NUMBER) if fields.has_value(key) else None


MOST_MEASUREMENTS = 100
_ROUNDING = 1e-9


def measurements_to_json(measurements: tuple[Measurement, ...]) -> dict[str, Any]:
    """JSON field of the measurements; empty if there is none."""
    return {"measurements": [_measurement_to_json(each) for each in measurements]} if measurements else {}


def _measurement_to_json(measurement: Measurement) -> dict[str, Any]:
    said: dict[str, Any] = {"name": measurement.name, "kind": measurement.kind.value}
    if measurement.plane is not None:
        return {
            **said,
            "plane": {"normal": list(measurement.plane.normal), "offset": measurement.plane.offset},
        }
    if measurement.contents is not None:
        return {
            **said,
            "contents": {"up": list(measurement.contents.up), "volume": measurement.contents.volume},
        }
    return {**said, "points": [{"face": p.face, "weights": list(p.weights)} for p in measurement.points]}


def measurements_from_json(fields: JsonFields, faces: int) -> tuple[Measurement, ...]:
    """Measurements from JSON, on ``faces`` faces; raises ValueError if damaged."""
    if not fields.has_value("measurements"):
        return ()
    return tuple(
        _measurement_from_json(part, faces) for part in fields.nested_list("measurements", MOST_MEASUREMENTS)
    )


def _measurement_from_json(fields: JsonFields, faces: int) -> Measurement:
    name, named = fields.text("name"), fields.text("kind")
    if named not in [each.value for each in MeasurementKind]:
        raise ValueError(tr("the “kind” of a measurement is unknown"))
    kind = MeasurementKind(named)
    if kind is MeasurementKind.SECTION:
        return Measurement(name, kind, plane=_plane(fields.nested_fields("plane")))
    if kind is MeasurementKind.FILL_LEVEL:
        return Measurement(name, kind, contents=_contents(fields.nested_fields("contents")))
    points = tuple(_point(part, faces) for part in fields.nested_list("points", kind.points))
    if len(points) < kind.points:
        raise ValueError(tr("its “points” are damaged"))
    return Measurement(name, kind, points)


def _point(fields: JsonFields, faces: int) -> SurfacePoint:
    face, weights = fields.count("face"), fields.array("weights", 3)
    if face >= faces or weights.min() < 0.0 or abs(weights.sum() - 1.0) > _ROUNDING:
        raise ValueError(tr("its “points” are damaged"))
    a, b, c = weights.tolist()
    return SurfacePoint(face, (a, b, c))


def _plane(fields: JsonFields) -> Plane:
    return Plane(_unit_vector(fields, "normal"), fields.number("offset"))


def _contents(fields: JsonFields) -> Contents:
    return Contents(_unit_vector(fields, "up"), fields.number("volume", 0.0))


def _unit_vector(fields: JsonFields, key: str) -> tuple[float, float, float]:
    vector = fields.array(key, 3)
    if abs(np.linalg.norm(vector) - 1.0) > _ROUNDING:
        raise ValueError(tr("its “{key}” is no direction").format(key=key))
    x, y, z = vector.tolist()
    return x, y, z


_KINDS = {kind.value: kind for kind in ObstacleKind}


def obstacle_to_json(obstacle: NamedObstacle) -> dict[str, Any]:
    """JSON of an obstacle."""
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
    """Obstacle from JSON; ``name`` is the default name.

    Fields without meaning for its kind may be missing, and so may ``shift``.
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
        frozen(fields.array("place", 3)),
        radius=0.0 if plate else fields.number("radius", LEAST_POSITIVE),
        length=fields.number("length", LEAST_POSITIVE) if cylinder else 0.0,
        **{key: frozen(fields.array(key, 3)) for key in ("axis", "shift") if fields.has_value(key)},
    )
    try:
        found.to_obstacle(1.0)
    except InputError:
        raise ValueError(tr("the “axis” of an obstacle has no direction")) from None
    return found


def vectors_from_json(fields: JsonFields, key: str, count: int) -> np.ndarray:
    """Vectors (o, 3) of ``count`` obstacles; (0, 3) if the field is missing."""
    if not fields.has_value(key):
        return frozen(np.zeros((0, 3)))
    return frozen(fields.array(key, count, 3))


def read_obstacles(path: Path) -> tuple[NamedObstacle, ...]:
    """Obstacles from a JSON file, in the form of a session.

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
