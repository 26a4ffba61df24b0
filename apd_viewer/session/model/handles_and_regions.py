"""Named parts of a document: handles and regions, with the flags of all parts.

An outdated factorization would silently give a wrong shape. Therefore each field of a document or handle
declares in its metadata whether the factorization depends on it; the key is derived from the declarations.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.pose.constraints import BASE, HANDLE, transform
from apd_viewer.geometry.pose.waypoint_path import extended_waypoints, has_half_turn, rotation_vector

FACTORED = MappingProxyType({"factored": True})
NOT_FACTORED = MappingProxyType({"factored": False})


def factored_fields(cls: type) -> tuple[str, ...]:
    """Names of the fields declared FACTORED; raises TypeError if any is undeclared."""
    undeclared = [each.name for each in fields(cls) if "factored" not in each.metadata]
    if undeclared:
        raise TypeError(f"{cls.__name__}.{undeclared[0]} is neither FACTORED nor NOT_FACTORED")
    return tuple(each.name for each in fields(cls) if each.metadata["factored"])


MOST_POSES = 100
IDENTITY = frozen(np.eye(4))


class PartFlags(NamedTuple):
    """Locked and hidden flags of a part.

    Attributes
    ----------
    locked : bool
        Whether its vertices are protected from painting, and no others can be added.
    hidden : bool
        Whether its colour is hidden; its vertices are held all the same.
    """

    locked: bool = False
    hidden: bool = False


NO_FLAGS = PartFlags()


class FlagsByCode(NamedTuple):
    """Values of a flag by label, (256,) bool, and by region number, (256,) bool."""

    labels: np.ndarray
    regions: np.ndarray


class DocumentFlags(NamedTuple):
    """Flags of all parts of a document."""

    base: PartFlags
    handles: tuple[PartFlags, ...]
    regions: tuple[PartFlags, ...]

    @property
    def locked(self) -> FlagsByCode:
        """Locked flags by label and by region number."""
        return self._by_code("locked")

    @property
    def hidden(self) -> FlagsByCode:
        """Hidden flags by label and by region number."""
        return self._by_code("hidden")

    def _by_code(self, name: str) -> FlagsByCode:
        found = FlagsByCode(np.zeros(256, dtype=bool), np.zeros(256, dtype=bool))
        found.labels[BASE] = getattr(self.base, name)
        found.labels[HANDLE : HANDLE + len(self.handles)] = [getattr(each, name) for each in self.handles]
        found.regions[1 : 1 + len(self.regions)] = [getattr(each, name) for each in self.regions]
        return found


@dataclass(frozen=True, eq=False)
class Handle:
    """Handle with its pose, waypoints, pivot and falloff.

    Attributes
    ----------
    pose : (4, 4) float array
        Motion from the initial position, read-only.
    waypoints : tuple of (4, 4) float arrays
        Poses on its path from the initial position, to represent turns of more than half; read-only.
    pivot : (3,) float array or None
        Centre of rotation in the initial position, read-only; None is the handle's centre.
    falloff : float
        Distance along the surface within which free vertices are pulled along, mesh units.
    earlier_poses : tuple of (4, 4) float arrays
        Poses on its path from rest to the initial position, including that; read-only.
    former_twist_axis : (3,) float array or None
        Direction from the former base to the handle, the axis of earlier twists.
    """

    name: str = field(metadata=NOT_FACTORED)
    pose: np.ndarray = field(default_factory=lambda: IDENTITY, metadata=NOT_FACTORED)
    pivot: np.ndarray | None = field(default=None, metadata=NOT_FACTORED)
    falloff: float = field(default=0.0, metadata=FACTORED)
    waypoints: tuple[np.ndarray, ...] = field(default=(), metadata=NOT_FACTORED)
    flags: PartFlags = field(default=NO_FLAGS, metadata=NOT_FACTORED)
    earlier_poses: tuple[np.ndarray, ...] = field(default=(), metadata=NOT_FACTORED)
    former_twist_axis: np.ndarray | None = field(default=None, metadata=NOT_FACTORED)

    def with_pose(self, pose: np.ndarray, waypoints: tuple[np.ndarray, ...] = ()) -> Handle:
        """Handle at ``pose`` (4, 4), reached along waypoints."""
        return replace(self, pose=frozen(np.array(pose, dtype=np.float64)), waypoints=waypoints)

    def moved_to(self, pose: np.ndarray) -> Handle:
        """Handle moved to ``pose`` (4, 4) by the shortest rotation."""
        return self.with_pose(pose, extended_waypoints(self.waypoints, self.pose, pose))

    def __getstate__(self) -> dict[str, object]:
        """Fields without cached values, which other threads may add during pickling."""
        return {each.name: getattr(self, each.name) for each in fields(self)}

    @cached_property
    def rotation(self) -> np.ndarray:
        """Total rotation from the initial position, (3,): unit axis times radians."""
        return frozen(rotation_vector(self.waypoints, self.pose))

    @property
    def has_half_turn(self) -> bool:
        """True if the handle has turned by half a turn or more along its waypoints."""
        return has_half_turn(self.waypoints, self.pose)

    @property
    def is_moved(self) -> bool:
        """True if the handle has moved from its initial position, also by full turns."""
        return bool(self.waypoints) or not np.array_equal(self.pose, IDENTITY)

    def with_restarted_motion(self) -> Handle:
        """Handle with its current position as the initial one; the rest pose is kept."""
        whole = self.relative_to_rest
        earlier = (*whole.waypoints, whole.pose) if whole.is_moved else ()
        return replace(
            self.with_pose(IDENTITY), pivot=_moved_point(self.pivot, self.pose), earlier_poses=earlier
        )

    @property
    def relative_to_rest(self) -> Handle:
        """Equivalent handle starting at rest, with its total motion and rest pivot."""
        if not self.earlier_poses:
            return self
        whole, start = (
            replace(self.with_pose(self.earlier_poses[-1], self.earlier_poses[:-1]), earlier_poses=()),
            self.earlier_poses[-1],
        )
        for pose in (*self.waypoints, self.pose) if self.is_moved else ():
            whole = whole.moved_to(pose @ start)
        return replace(whole, pivot=_moved_point(self.pivot, np.linalg.inv(start)))

    def with_pose_from_rest(self, pose: np.ndarray, waypoints: tuple[np.ndarray, ...] = ()) -> Handle:
        """Handle at ``pose`` (4, 4) relative to rest, reached along waypoints."""
        if not self.earlier_poses:
            return self.with_pose(pose, waypoints)
        handle, back = self.with_pose(IDENTITY), np.linalg.inv(self.earlier_poses[-1])
        for each in (*reversed(self.earlier_poses[:-1]), IDENTITY, *waypoints, pose):
            handle = handle.moved_to(each @ back)  # removes the common part of both paths
        return handle


def _moved_point(point: np.ndarray | None, pose: np.ndarray) -> np.ndarray | None:
    return None if point is None else frozen(transform(pose, point[None])[0])


class HandlePlacement(NamedTuple):
    """Pose of a named handle, and the waypoints leading to it.

    Attributes
    ----------
    handle : str
        Name of the handle.
    pose : (4, 4) float array
        Motion from the rest shape, read-only.
    waypoints : tuple of (4, 4) float arrays
        Waypoints to the pose; see :class:`Handle`.
    """

    handle: str
    pose: np.ndarray
    waypoints: tuple[np.ndarray, ...] = ()


@dataclass(frozen=True, eq=False)
class NamedPose:
    """Poses of the handles, stored under a name."""

    name: str
    placements: tuple[HandlePlacement, ...]


@dataclass(frozen=True, eq=False)
class NamedRegion:
    """Region with a measured area, preserved if it has a target.

    Attributes
    ----------
    area : float or None
        Target area in percent of the area at rest; None only measures it.
    """

    name: str
    area: float | None = None
    flags: PartFlags = NO_FLAGS
