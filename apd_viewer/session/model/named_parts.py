"""Named parts of a document: handles and regions, with the flags of all parts."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
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
    """

    name: str = field(metadata=NOT_FACTORED)
    pose: np.ndarray = field(default_factory=lambda: IDENTITY, metadata=NOT_FACTORED)
    pivot: np.ndarray | None = field(default=None, metadata=NOT_FACTORED)
    falloff: float = field(default=0.0, metadata=FACTORED)
    waypoints: tuple[np.ndarray, ...] = field(default=(), metadata=NOT_FACTORED)
    flags: PartFlags = field(default=NO_FLAGS, metadata=NOT_FACTORED)

    def at(self, pose: np.ndarray, waypoints: tuple[np.ndarray, ...] = ()) -> Handle:
        """The handle at ``pose`` (4, 4), reached along waypoints."""
        return replace(self, pose=frozen(np.array(pose, dtype=np.float64)), waypoints=waypoints)

    def moved(self, pose: np.ndarray) -> Handle:
        """The handle moved on to ``pose`` (4, 4), by the shortest rotation."""
        return self.at(pose, extended(self.waypoints, self.pose, pose))

    @property
    def rotation(self) -> np.ndarray:
        """Total rotation since it was gripped, (3,): unit axis times angle, radians."""
        return rotation_vector(self.waypoints, self.pose)

    @property
    def winds(self) -> bool:
        """True if it has turned by half a turn or more, which its pose does not tell."""
        return winds(self.waypoints, self.pose)

    def gripped(self) -> Handle:
        """The handle gripped at its current pose."""
        pivot = None if self.pivot is None else frozen(transform(self.pose, self.pivot[None])[0])
        return replace(self, pose=IDENTITY, waypoints=(), pivot=pivot)


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
