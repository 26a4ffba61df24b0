"""View settings as plain values, independent of a window."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import TypeAlias

import numpy as np

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.session.quantities.wall import NO_WALL, WallText

SESSION_SUFFIX = ".apd"  # suffix of session files

Point3: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True)
class CameraPose:
    """Position and direction of the camera.

    Attributes
    ----------
    position, focal, up : tuple of 3 floats
        Mesh units; ``up`` is a direction.
    angle : float
        Vertical opening angle, radians.
    """

    position: Point3
    focal: Point3
    up: Point3
    angle: float


@dataclass(frozen=True)
class View:
    """View settings of a session file.

    Attributes
    ----------
    camera : CameraPose or None
        None where nobody has looked yet: the mesh is shown whole.
    unit : str
        Value of a :class:`apd_viewer.session.quantities.units.Unit`: its symbol, with a question mark
        where it is a guess.
    wall : WallText
        What the surface is made of, as it was typed.
    overlay : str or None
        What the colours show, by the value of a :class:`Measure`; empty where they show
        what is painted, None where nothing is said of them.
    up_axis : UpAxis or None
        None where nothing is said of it.
    """

    camera: CameraPose | None = None
    unit: str = ""
    wall: WallText = NO_WALL
    overlay: str | None = None
    up_axis: UpAxis | None = None


# Front view directions right, up and towards the viewer; X points right if possible.
_FRAMES = {
    "+X": ((0, -1, 0), (1, 0, 0), (0, 0, 1)),
    "-X": ((0, 1, 0), (-1, 0, 0), (0, 0, 1)),
    "+Y": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "-Y": ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
    "+Z": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "-Z": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
}
# glTF prescribes +Y and 3MF +Z; meshes in other formats use either.
_PRESCRIBED = {".glb": "+Y", ".gltf": "+Y", ".3mf": "+Z"}


class UpAxis(Enum):
    """Mesh axis pointing up on the screen."""

    PLUS_Y = "+Y"
    PLUS_Z = "+Z"
    PLUS_X = "+X"
    MINUS_Y = "-Y"
    MINUS_Z = "-Z"
    MINUS_X = "-X"

    @classmethod
    def from_suffix(cls, suffix: str, default: UpAxis) -> UpAxis:
        """Up axis prescribed by a file format, or a default."""
        return cls(_PRESCRIBED.get(suffix.lower(), default))

    @classmethod
    def nearest(cls, direction: np.ndarray) -> UpAxis:
        """Up axis nearest to a direction (3,)."""
        return max(cls, key=lambda axis: float(axis.direction @ direction))

    @cached_property
    def frame(self) -> np.ndarray:
        """Unit vectors of the front view: right, up and towards the viewer, rows (3, 3)."""
        return frozen(np.array(_FRAMES[self.value], dtype=float))

    @property
    def direction(self) -> np.ndarray:
        """Unit vector pointing up, (3,)."""
        up: np.ndarray = self.frame[1]
        return up

    @property
    def index(self) -> int:
        """Coordinate index of the axis: 0, 1 or 2."""
        return "XYZ".index(self.value[1])

    @property
    def sign(self) -> int:
        """1 if the coordinate grows upwards, else -1."""
        return 1 if self.value[0] == "+" else -1
