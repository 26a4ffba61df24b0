"""Handles, regions and named poses to and from the JSON of a session."""

from __future__ import annotations

from typing import Any

import numpy as np

from apd_viewer.files.storage.json_fields import JsonFields
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.pose.constraints import MOST_HANDLES
from apd_viewer.language import tr
from apd_viewer.session.model.handles_and_regions import (
    Handle,
    HandlePlacement,
    NamedPose,
    NamedRegion,
    PartFlags,
)

LARGEST_NUMBER = 1e9  # of a weight or a percentage
LEAST_POSITIVE = 1e-12  # smallest number accepted as positive
_MOST_WAYPOINTS = 10_000  # of a handle
_MOTIONLESS = [0.0, 0.0, 0.0, 1.0]  # the last row of a motion's matrix


def handle_to_json(handle: Handle) -> dict[str, Any]:
    """A handle as JSON."""
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
    """A named pose as JSON."""
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
    """The flags that are set: older programs ignore what they do not know."""
    return {name: on for name, on in flags._asdict().items() if on}


def flags_from_json(fields: JsonFields) -> PartFlags:
    """The flags again."""
    return PartFlags(**{name: fields.has_value(name) and fields.flag(name) for name in PartFlags._fields})


def number_to_json(value: float | None) -> float | None:
    """A number as JSON; None is null."""
    return None if value is None else float(value)


def handle_from_json(fields: JsonFields) -> Handle:
    """The handle again."""
    pose, waypoints = _path(fields)
    pivot = frozen(fields.numbers("pivot", 3)) if fields.has_value("pivot") else None
    falloff = fields.number("falloff", 0.0, LARGEST_NUMBER) if fields.has_value("falloff") else 0.0
    line = frozen(fields.numbers("line", 3)) if fields.has_value("line") else None
    return Handle(
        fields.text("name"), pose, pivot, falloff, waypoints, flags_from_json(fields), _earlier(fields), line
    )


def pose_from_json(fields: JsonFields) -> NamedPose:
    """The named pose again."""
    placed = fields.nested_list("handles", MOST_HANDLES)
    return NamedPose(
        fields.text("name"), tuple(HandlePlacement(each.text("name"), *_path(each)) for each in placed)
    )


def _path(fields: JsonFields) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
    """Pose of a handle, and the waypoints to it."""
    pose = frozen(fields.numbers("pose", 4, 4))
    waypoints = tuple(map(frozen, fields.grids("waypoints", _MOST_WAYPOINTS, 4, 4)))
    _check_affine(pose, *waypoints)
    return pose, waypoints


def _check_affine(*poses: np.ndarray) -> None:
    if any(not np.array_equal(each[3], _MOTIONLESS) for each in poses):
        raise ValueError(
            tr("the “pose” of a handle is not an affine transform: its last row must be 0 0 0 1")
        )


def _earlier(fields: JsonFields) -> tuple[np.ndarray, ...]:
    """Poses of a handle on its way until it was gripped."""
    poses = tuple(map(frozen, fields.grids("earlier", _MOST_WAYPOINTS, 4, 4)))
    _check_affine(*poses)
    if any(not np.linalg.det(each) for each in poses):
        raise ValueError(tr("an “earlier” pose of a handle flattens it"))
    return poses


def region_from_json(fields: JsonFields) -> NamedRegion:
    """The region again."""
    return NamedRegion(fields.text("name"), percent_from_json(fields, "area"), flags_from_json(fields))


def percent_from_json(fields: JsonFields, key: str) -> float | None:
    """Percentage, or None where the field is missing."""
    return fields.number(key, LEAST_POSITIVE, LARGEST_NUMBER) if fields.has_value(key) else None
