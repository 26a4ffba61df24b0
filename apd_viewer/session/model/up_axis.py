"""Up axis of a mesh: coordinates of its front view."""

from __future__ import annotations

from enum import Enum
from functools import cached_property

import numpy as np

from apd_viewer.geometry.mesh.arrays import frozen

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
    def from_suffix(cls, suffix: str) -> UpAxis | None:
        """Up axis prescribed by a file format; None if it prescribes none."""
        prescribed = _PRESCRIBED.get(suffix.lower())
        return None if prescribed is None else cls(prescribed)

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
