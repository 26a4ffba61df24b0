"""Screw motions: interpolation of handle poses.

A rigid motion follows a screw [Chasles 1830]: uniform rotation about a line with uniform translation along
it, so that equal fractions are equal motions and distances from the line are constant. A stretch grows by
equal factors in equal fractions.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from apd_viewer.errors import InputError
from apd_viewer.geometry.pose.constraints import transform
from apd_viewer.geometry.pose.transforms import linear_map_about, rigid_transform, rotation_about, translation
from apd_viewer.language import tr

# Radians from half a turn within which rounding decides the sense of rotation.
_HALF_TURN = 1e-6
# Fraction of the largest stretch below which a stretch flattens the object.
_FLAT = 1e-9
# Half of the angle, in radians, below which the path of the pivot is straight.
_STRAIGHT = 1e-9


class ScrewPath(NamedTuple):
    """Path of an affine motion: a stretch about a pivot, then a screw motion.

    Attributes
    ----------
    pivot : (3,) float array
    axis : (3,) float array
        Unit vector along the screw.
    angle : float
        Of the whole turn, radians, less than half a turn.
    along, across : (3,) float array
        Displacement of the pivot along the axis, and perpendicular to it.
    stretches : (3,) float array
        Factors along the columns of ``directions`` (3, 3), which are orthonormal.
    directions : (3, 3) float array
    """

    pivot: np.ndarray
    axis: np.ndarray
    angle: float
    along: np.ndarray
    across: np.ndarray
    stretches: np.ndarray
    directions: np.ndarray

    def pose_at(self, fraction: float) -> np.ndarray:
        """Pose (4, 4) at a fraction of the path, from 0 (rest) to 1 (end)."""
        stretch = linear_map_about(
            self.pivot, (self.directions * self.stretches**fraction) @ self.directions.T
        )
        # Arc of the pivot; without rotation it is a line, with its centre at infinity.
        half = self.angle / 2
        chord = np.sin(fraction * half) / np.sin(half) if half > _STRAIGHT else fraction
        arc = chord * rotation_about(np.zeros(3), self.axis, (fraction - 1.0) * half)[:3, :3] @ self.across
        way = translation(fraction * self.along + arc)
        moved: np.ndarray = way @ rotation_about(self.pivot, self.axis, fraction * self.angle) @ stretch
        return moved

    @property
    def has_motion(self) -> bool:
        """True if the end of the path differs from its start."""
        return self.angle != 0.0 or self.has_stretch or bool(self.along.any() or self.across.any())

    @property
    def has_stretch(self) -> bool:
        """True if the motion is more than a rotation and a translation."""
        return bool(np.abs(np.log(self.stretches)).max() > _FLAT)


class RotationPath(NamedTuple):
    """Path of a rotation about a line by any angle, including full turns.

    Attributes
    ----------
    point : (3,) float array
        Point on the axis.
    axis : (3,) float array
        Direction of the axis, of any length but zero.
    angle : float
        Of the whole turn, radians.
    """

    point: np.ndarray
    axis: np.ndarray
    angle: float

    def pose_at(self, fraction: float) -> np.ndarray:
        """Pose (4, 4) at a fraction of the rotation."""
        return rotation_about(self.point, self.axis, fraction * self.angle)

    @property
    def has_motion(self) -> bool:
        """True if the angle is not zero."""
        return self.angle != 0.0

    @property
    def has_stretch(self) -> bool:
        """False: a rotation does not stretch."""
        return False


def screw_path(pose: np.ndarray, pivot: npt.ArrayLike, allows_half_turn: bool = False) -> ScrewPath:
    """Screw path to ``pose`` (4, 4) about ``pivot`` (3,), by less than half a turn.

    Parameters
    ----------
    pose : (4, 4) float array
    pivot : (3,) float array
    allows_half_turn : bool, optional
        Go half a turn as well: to the right about the axis whose largest coordinate is positive.

    Raises
    ------
    InputError
        If the matrix mirrors or flattens, or turns by half a turn: that has two ways round.
    """
    centre = np.asarray(pivot, dtype=float)
    left, sizes, right = np.linalg.svd(pose[:3, :3])
    R = left @ right
    if sizes[-1] <= _FLAT * sizes[0] or np.linalg.det(R) < 0:
        raise InputError(
            tr("The motion mirrors or flattens the handle, so no path leads there; give another motion.")
        )
    rigid = np.eye(4)
    rigid[:3, :3] = R
    rigid[:3, 3] = transform(pose, centre[None])[0] - R @ centre
    motion = rigid_transform(rigid, centre)
    if np.pi - motion.angle < _HALF_TURN:
        if not allows_half_turn:
            raise InputError(
                tr("The motion is a half turn, whose direction is ambiguous; give it as a twist of 180deg.")
            )
        sign = np.sign(motion.axis[np.abs(motion.axis).argmax()])
        motion = motion._replace(axis=sign * motion.axis, angle=np.pi)
    along = (motion.displacement @ motion.axis) * motion.axis
    across = motion.displacement - along
    return ScrewPath(centre, motion.axis, motion.angle, along, across, sizes, right.T)
