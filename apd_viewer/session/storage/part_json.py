"""Handles, regions and named poses to and from the JSON of a session."""

from __future__ import annotations

from typing import Any

import numpy as np

from apd_viewer.files.storage.json_fields import Fields
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.pose.constraints import MOST_HANDLES
from apd_viewer.language import tr
from apd_viewer.session.model.named_parts import Handle, NamedPose, NamedRegion, PartFlags, Placement

MOST = 1e9  # of a weight or a percentage
LEAST = 1e-12  # of what is more than zero
_MOST_WAYPOINTS = 10_000  # of a handle
_MOTIONLESS = [0.0, 0.0, 0.0, 1.0]  # the last row of a motion's matrix


def handle_said(handle: Handle) -> dict[str, Any]:
    """A handle as JSON."""
    pivot = None if handle.pivot is None else handle.pivot.tolist()
    said = {"name": handle.name, "pose": handle.pose.tolist(), "pivot": pivot, **flags_said(handle.flags)}
    if handle.waypoints:
        said["waypoints"] = [each.tolist() for each in handle.waypoints]
    if handle.earlier:
        said["earlier"] = [each.tolist() for each in handle.earlier]
    if handle.line is not None:
        said["line"] = handle.line.tolist()
    return {**said, "falloff": number_said(handle.falloff)} if handle.falloff else said


def pose_said(pose: NamedPose) -> dict[str, Any]:
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


def flags_said(flags: PartFlags) -> dict[str, bool]:
    """The flags that are set: older programs ignore what they do not know."""
    return {name: on for name, on in flags._asdict().items() if on}


def flags_of(said: Fields) -> PartFlags:
    """The flags again."""
    return PartFlags(**{name: said.says(name) and said.flag(name) for name in PartFlags._fields})


def number_said(value: float | None) -> float | None:
    """A number as JSON; None is null."""
    return None if value is None else float(value)


def handle_of(said: Fields) -> Handle:
    """The handle again."""
    pose, waypoints = _path(said)
    pivot = frozen(said.numbers("pivot", 3)) if said.says("pivot") else None
    falloff = said.number("falloff", 0.0, MOST) if said.says("falloff") else 0.0
    line = frozen(said.numbers("line", 3)) if said.says("line") else None
    return Handle(said.text("name"), pose, pivot, falloff, waypoints, flags_of(said), _earlier(said), line)


def pose_of(said: Fields) -> NamedPose:
    """The named pose again."""
    placed = said.parts("handles", MOST_HANDLES)
    return NamedPose(said.text("name"), tuple(Placement(each.text("name"), *_path(each)) for each in placed))


def _path(said: Fields) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
    """Pose of a handle, and the waypoints to it."""
    pose = frozen(said.numbers("pose", 4, 4))
    waypoints = tuple(map(frozen, said.stack("waypoints", _MOST_WAYPOINTS, 4, 4)))
    _check_affine(pose, *waypoints)
    return pose, waypoints


def _check_affine(*poses: np.ndarray) -> None:
    if any(not np.array_equal(each[3], _MOTIONLESS) for each in poses):
        raise ValueError(
            tr("the “pose” of a handle is not an affine transform: its last row must be 0 0 0 1")
        )


def _earlier(said: Fields) -> tuple[np.ndarray, ...]:
    """Poses of a handle on its way until it was gripped."""
    poses = tuple(map(frozen, said.stack("earlier", _MOST_WAYPOINTS, 4, 4)))
    _check_affine(*poses)
    if any(not np.linalg.det(each) for each in poses):
        raise ValueError(tr("an “earlier” pose of a handle flattens it"))
    return poses


def region_of(said: Fields) -> NamedRegion:
    """The region again."""
    return NamedRegion(said.text("name"), percent_of(said, "area"), flags_of(said))


def percent_of(said: Fields, key: str) -> float | None:
    """Percentage, or None where the field is missing."""
    return said.number(key, LEAST, MOST) if said.says(key) else None
