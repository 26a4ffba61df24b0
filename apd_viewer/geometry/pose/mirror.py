"""Mirror planes: mirrored points and motions, and motions within the plane."""

from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.pose.constraints import transform
from apd_viewer.geometry.pose.transforms import linear_map_about, rigid_transform, rotation_about, translation

# Relative difference below which stretches count as a uniform scale.
_UNIFORM = 1e-9


class MirrorPlane(NamedTuple):
    """Mirror plane perpendicular to a coordinate axis.

    Attributes
    ----------
    axis : int
        0, 1 or 2.
    coordinate : float
        Coordinate along the axis at which it stands, mesh units.
    """

    axis: int
    coordinate: float

    @property
    def reflection(self) -> np.ndarray:
        """Matrix (4, 4) of the reflection."""
        reflection = np.eye(4)
        reflection[self.axis, self.axis] = -1.0
        reflection[self.axis, 3] = 2.0 * self.coordinate
        return reflection

    def image(self, X: np.ndarray) -> np.ndarray:
        """Mirror images of the points ``X`` (n, 3)."""
        images = X.copy()
        images[:, self.axis] = 2.0 * self.coordinate - images[:, self.axis]
        return images

    def mirrored_pose(self, pose: np.ndarray) -> np.ndarray:
        """Mirror image ``S P S`` (4, 4) of the motion ``P``."""
        S = self.reflection
        mirrored: np.ndarray = S @ pose @ S
        return mirrored

    def symmetric_motion(self, pose: np.ndarray, pivot: np.ndarray) -> np.ndarray:
        """Motion (4, 4) nearest to ``pose`` and equal to its own mirror image.

        Composed of the in-plane part of the pivot's displacement, the twist about the normal of the plane in
        a swing-twist decomposition of the rotation, and the symmetric part of a stretch.
        """
        normal = np.eye(3)[self.axis]
        left, sizes, right = np.linalg.svd(pose[:3, :3])
        rigid = np.eye(4)
        rigid[:3, :3] = left @ right
        turn = rigid_transform(rigid, np.zeros(3))
        half = turn.angle / 2.0
        angle = 2.0 * float(np.arctan2(np.sin(half) * turn.axis[self.axis], np.cos(half)))
        stretch = float(np.cbrt(np.linalg.det(pose[:3, :3]))) * np.eye(3)
        if sizes[0] - sizes[-1] > _UNIFORM * sizes[0]:
            stretch = (right.T * sizes) @ right
            across = np.not_equal.outer(normal, normal)
            stretch[across] = 0.0
        way = transform(pose, pivot[None])[0] - pivot
        way[self.axis] = 0.0
        linear = rotation_about(np.zeros(3), normal, angle)[:3, :3] @ stretch
        foot = np.where(normal > 0.0, self.coordinate, pivot)  # fixed point, on the mirror plane
        moved: np.ndarray = translation(way) @ linear_map_about(foot, linear)
        return moved
