"""Named parts of a document: handles and regions, with the flags of all parts."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.pose.constraints import BASE, HANDLE, transform
from apd_viewer.geometry.pose.winding import extended, rotation_vector, winds
from apd_viewer.session.model.factor_key import FACTORED, NOT_FACTORED

MOST_POSES = 100
IDENTITY = frozen(np.eye(4))


class PartFlags(NamedTuple):
    """Flags of a part.

    Attributes
    ----------
    locked : bool
        Its vertices are neither painted over nor added to.
    hidden : bool
        Its colour is not drawn; it holds all the same.
    """

    locked: bool = False
    hidden: bool = False


NO_FLAGS = PartFlags()


class CodeFlags(NamedTuple):
    """One of the flags by label, (256,) bool, and by region number, (256,) bool."""

    labels: np.ndarray
    regions: np.ndarray


class DocumentFlags(NamedTuple):
    """Flags of all parts of a document."""

    base: PartFlags
    handles: tuple[PartFlags, ...]
    regions: tuple[PartFlags, ...]

    @property
    def locked(self) -> CodeFlags:
        """Locked labels and region numbers."""
        return self._by_code("locked")

    @property
    def hidden(self) -> CodeFlags:
        """Hidden labels and region numbers."""
        return self._by_code("hidden")

    def _by_code(self, name: str) -> CodeFlags:
        found = CodeFlags(np.zeros(256, dtype=bool), np.zeros(256, dtype=bool))
        found.labels[BASE] = getattr(self.base, name)
        found.labels[HANDLE : HANDLE + len(self.handles)] = [getattr(each, name) for each in self.handles]
        found.regions[1 : 1 + len(self.regions)] = [getattr(each, name) for each in self.regions]
        return found


@dataclass(frozen=True, eq=False)
class Handle:
    """A part moved rigidly as one.

    Attributes
    ----------
    name : str
    pose : (4, 4) float array
        Its motion since it was gripped, read-only.
    waypoints : tuple of (4, 4) float arrays
        Poses on its way from the grip, by which a turn of more than half is known; read-only.
    pivot : (3,) float array or None
        What it turns about, where that was when it was gripped, read-only; None is its centre.
    falloff : float
        How far along the surface it draws free vertices along, mesh units.
    flags : PartFlags
    earlier : tuple of (4, 4) float arrays
        Poses from rest on its way until it was gripped, the last one at its grip; read-only.
    line : (3,) float array or None
        From the base to it before the base was painted otherwise: what a twist was about.
    """

    name: str = field(metadata=NOT_FACTORED)
    pose: np.ndarray = field(default_factory=lambda: IDENTITY, metadata=NOT_FACTORED)
    pivot: np.ndarray | None = field(default=None, metadata=NOT_FACTORED)
    falloff: float = field(default=0.0, metadata=FACTORED)
    waypoints: tuple[np.ndarray, ...] = field(default=(), metadata=NOT_FACTORED)
    flags: PartFlags = field(default=NO_FLAGS, metadata=NOT_FACTORED)
    earlier: tuple[np.ndarray, ...] = field(default=(), metadata=NOT_FACTORED)
    line: np.ndarray | None = field(default=None, metadata=NOT_FACTORED)

    def at(self, pose: np.ndarray, waypoints: tuple[np.ndarray, ...] = ()) -> Handle:
        """The handle at ``pose`` (4, 4), reached along waypoints."""
        return replace(self, pose=frozen(np.array(pose, dtype=np.float64)), waypoints=waypoints)

    def moved(self, pose: np.ndarray) -> Handle:
        """The handle moved on to ``pose`` (4, 4), by the shortest rotation."""
        return self.at(pose, extended(self.waypoints, self.pose, pose))

    @cached_property
    def rotation(self) -> np.ndarray:
        """Total rotation since it was gripped, (3,): unit axis times angle, radians."""
        return frozen(rotation_vector(self.waypoints, self.pose))

    @property
    def winds(self) -> bool:
        """True if it has turned by half a turn or more, which its pose does not tell."""
        return winds(self.waypoints, self.pose)

    @property
    def is_moved(self) -> bool:
        """True if it has been moved since it was gripped, by full turns too."""
        return bool(self.waypoints) or not np.array_equal(self.pose, IDENTITY)

    def gripped(self) -> Handle:
        """The handle gripped at its current pose; its motion from rest is kept."""
        whole = self.from_rest
        earlier = (*whole.waypoints, whole.pose) if whole.is_moved else ()
        return replace(self.at(IDENTITY), pivot=_carried(self.pivot, self.pose), earlier=earlier)

    @property
    def from_rest(self) -> Handle:
        """The handle as if gripped at rest: with its whole motion, and its pivot there."""
        if not self.earlier:
            return self
        whole, start = replace(self.at(self.earlier[-1], self.earlier[:-1]), earlier=()), self.earlier[-1]
        for pose in (*self.waypoints, self.pose) if self.is_moved else ():
            whole = whole.moved(pose @ start)
        return replace(whole, pivot=_carried(self.pivot, np.linalg.inv(start)))

    def placed(self, pose: np.ndarray, waypoints: tuple[np.ndarray, ...] = ()) -> Handle:
        """The handle at ``pose`` (4, 4) from rest, reached along waypoints."""
        if not self.earlier:
            return self.at(pose, waypoints)
        handle, back = self.at(IDENTITY), np.linalg.inv(self.earlier[-1])
        for each in (*reversed(self.earlier[:-1]), IDENTITY, *waypoints, pose):
            handle = handle.moved(each @ back)  # what both ways share is taken off
        return handle


def _carried(point: np.ndarray | None, pose: np.ndarray) -> np.ndarray | None:
    return None if point is None else frozen(transform(pose, point[None])[0])


class Placement(NamedTuple):
    """Place of a handle.

    Attributes
    ----------
    handle : str
        Its name.
    pose : (4, 4) float array
        Its motion from the rest shape, read-only.
    waypoints : tuple of (4, 4) float arrays
        On the way there; see :class:`Handle`.
    """

    handle: str
    pose: np.ndarray
    waypoints: tuple[np.ndarray, ...] = ()


@dataclass(frozen=True, eq=False)
class NamedPose:
    """Places of the handles, kept under a name.

    Attributes
    ----------
    name : str
    placements : tuple of Placement
    """

    name: str
    placements: tuple[Placement, ...]


@dataclass(frozen=True, eq=False)
class NamedRegion:
    """A part with its area measured, and kept if it has a target.

    Attributes
    ----------
    name : str
    area : float or None
        What its area should be, in percent of its area at rest; None only measures it.
    flags : PartFlags
    """

    name: str
    area: float | None = None
    flags: PartFlags = NO_FLAGS
