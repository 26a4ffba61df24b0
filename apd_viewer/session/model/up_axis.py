"""Up axis of a mesh: axes of its front view, and a guess from its flat bottom."""

from __future__ import annotations

from enum import Enum
from functools import cached_property

import numpy as np

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh

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
_FLAT = 0.005  # thickness of the bottom layer, as a fraction of the diagonal of the bounding box
_WIDE = 0.3  # least area of the bottom, as a fraction of the side of the bounding box that it lies on
_UNLIKE = 0.5  # largest area of the opposite end, as a fraction of that of the bottom
_MOST_FACES = 300_000  # larger meshes get no guess, as it would delay the window


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


def mesh_up_axis(mesh: Mesh, chosen: UpAxis | None = None) -> UpAxis:
    """Up axis chosen for a mesh, else that of its format, of its flat bottom, or +Y."""
    suffix = mesh.origin.suffix if mesh.origin else mesh.path.suffix if mesh.path else ""
    return chosen or UpAxis.from_suffix(suffix) or standing_axis(mesh) or UpAxis.PLUS_Y


def standing_axis(mesh: Mesh) -> UpAxis | None:
    """Up axis for which a mesh stands on a flat bottom; None if that is ambiguous.

    It is +Y or +Z. A box, a can and a sphere have none: a bottom is wide, and the opposite end is not.
    """
    if len(mesh.F) > _MOST_FACES:
        return None
    points = mesh.V[mesh.F]  # (m, 3, 3)
    across = 0.5 * np.abs(np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]))
    low, high = points.min(axis=(0, 1)), points.max(axis=(0, 1))
    depth = _FLAT * float(np.linalg.norm(high - low))
    at_low = (points <= low + depth).all(axis=1)  # (m, 3): triangles at the lower end of each axis
    at_high = (points >= high - depth).all(axis=1)
    ends = np.array([(across * at_low).sum(axis=0), (across * at_high).sum(axis=0)])
    sides = np.prod(high - low) / np.maximum(high - low, 1e-300)
    found = [
        axis
        for axis in (UpAxis.PLUS_Y, UpAxis.PLUS_Z)  # the up axis of nearly all files
        for bottom, top in [ends[:, axis.index]]
        if bottom >= _WIDE * sides[axis.index] > 0.0 and top <= _UNLIKE * bottom
    ]
    return found[0] if len(found) == 1 else None
