"""Obstacles of a document: plates, spheres and cylinders."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import Enum

import numpy as np

from apd_viewer.geometry.contact.contact_obstacles import Obstacle, capsule, plate, sphere
from apd_viewer.geometry.mesh.arrays import checked_direction, diagonal, frozen
from apd_viewer.language import tr, trc

MOST_OBSTACLES = 20
_UP = frozen(np.array([0.0, 1.0, 0.0]))
_NO_SHIFT = frozen(np.zeros(3))


class ObstacleKind(Enum):
    """Shape of an obstacle."""

    PLATE = "plate"
    SPHERE = "sphere"
    CYLINDER = "cylinder"

    @property
    def title(self) -> str:
        """Title of the kind, used in names of new obstacles."""
        return _TITLES[self]

    @property
    def word(self) -> str:
        """Word for the kind within a sentence."""
        return _WORDS[self]


_TITLES = {
    ObstacleKind.PLATE: tr("Plate"),
    ObstacleKind.SPHERE: tr("Sphere"),
    ObstacleKind.CYLINDER: tr("Cylinder"),
}
_WORDS = {
    ObstacleKind.PLATE: trc("sentence", "plate"),
    ObstacleKind.SPHERE: trc("sentence", "sphere"),
    ObstacleKind.CYLINDER: trc("sentence", "cylinder"),
}


@dataclass(frozen=True, eq=False)
class NamedObstacle:
    """Named obstacle with its displacement.

    Attributes
    ----------
    place : (3,) float array
        Initial position: a point of a plate, the centre of a sphere or cylinder; mesh units, read-only.
    axis : (3,) float array
        Unit normal of a plate, to the side that stays free; unit axis of a cylinder; read-only.
    radius : float
        Of a sphere or cylinder, mesh units; 0 of a plate.
    length : float
        Of a cylinder, between the centres of its round ends, mesh units; 0 of others.
    shift : (3,) float array
        Displacement from the initial position, mesh units, read-only.
    """

    name: str
    kind: ObstacleKind
    place: np.ndarray
    axis: np.ndarray = field(default_factory=lambda: _UP)
    radius: float = 0.0
    length: float = 0.0
    shift: np.ndarray = field(default_factory=lambda: _NO_SHIFT)

    def to_obstacle(self, extent: float) -> Obstacle:
        """Obstacle at its initial position, blocking a shape of size ``extent``.

        Parameters
        ----------
        extent : float
            Extent of all that a plate is to stop, mesh units.

        Raises
        ------
        InputError
            If it has no extent or direction.
        """
        if self.kind is ObstacleKind.PLATE:
            return plate(self.place, self.axis, extent)
        if self.kind is ObstacleKind.SPHERE:
            return sphere(self.place, self.radius)
        half = 0.5 * self.length * checked_direction(self.axis)
        return capsule(self.place - half, self.place + half, self.radius)

    def with_shift(self, shift: np.ndarray) -> NamedObstacle:
        """Obstacle displaced by ``shift`` (3,) from its initial position."""
        return replace(self, shift=frozen(np.array(shift, dtype=np.float64)))

    def with_shift_applied(self, shift: np.ndarray) -> NamedObstacle:
        """Obstacle with its initial position moved by ``shift`` (3,) and no displacement."""
        return replace(self, place=frozen(self.place + shift), shift=_NO_SHIFT)

    @property
    def centre(self) -> np.ndarray:
        """Current position, (3,)."""
        return self.place + self.shift


def carried_shifts(
    before: Sequence[NamedObstacle], shifts: np.ndarray, after: Sequence[NamedObstacle]
) -> np.ndarray:
    """Displacements (o, 3) after a change of obstacles, kept for unchanged ones.

    Parameters
    ----------
    before, after : sequences of NamedObstacle
        Obstacles with the same place array are the same; new ones keep their own displacement.
    shifts : (p, 3) float array
        Displacements of the obstacles before; empty if unknown, as is then the result.
    """
    if len(shifts) != len(before):
        return frozen(np.zeros((0, 3)))
    known = {id(each.place): shift for each, shift in zip(before, shifts, strict=True)}
    return frozen(np.array([known.get(id(each.place), each.shift) for each in after]).reshape(-1, 3))


def geometric_obstacles(obstacles: Sequence[NamedObstacle], V: np.ndarray) -> tuple[Obstacle, ...]:
    """Geometric obstacles for a mesh with vertices ``V`` (n, 3)."""
    return tuple(each.to_obstacle(plate_extent(each, V)) for each in obstacles)


def plate_extent(obstacle: NamedObstacle, V: np.ndarray) -> float:
    """Extent of a plate large enough to block a mesh with vertices ``V`` (n, 3)."""
    middle = 0.5 * (V.min(axis=0) + V.max(axis=0))
    # A distant plate needs a larger extent.
    return diagonal(V) + float(np.linalg.norm(obstacle.place - middle))
