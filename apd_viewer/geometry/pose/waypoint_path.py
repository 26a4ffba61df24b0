"""Paths beyond half a turn: waypoints, total rotation, segments.

A pose alone does not distinguish a turn by 311 degrees from one by -49. The path of a handle therefore has
waypoints, so close that the shortest rotation from one to the next is the rotation made.
"""

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.pose.constraints import transform
from apd_viewer.geometry.pose.screw_motion import RotationPath, ScrewPath, screw_path
from apd_viewer.geometry.pose.transforms import rigid_transform, rotation_about

# Radians. Three rotations by less than a third of a turn each cannot add up to a full turn: a waypoint
# within this angle of its neighbours can be dropped.
_FARTHEST = math.radians(115.0)
# Radians: the axis of a smaller rotation is determined by rounding.
_STRAIGHT = 1e-7
# Weight, in radians, of a path segment without rotation.
_LEAST_WEIGHT = 0.1
# Least cosine between a rotation vector and the axis of a twist.
_ALIGNED = math.cos(math.radians(1.0))
# Closer to half a turn, the sense of rotation is determined by rounding.
_HALF_TURN = math.pi - 1e-6
# Relative to the coordinates: smaller differences are rounding errors.
_SAME = 1e-9
# Significant digits of a rounded pose.
_DIGITS = 12


def extended_waypoints(
    waypoints: tuple[np.ndarray, ...], current_pose: np.ndarray, pose: np.ndarray
) -> tuple[np.ndarray, ...]:
    """Waypoints of a path continued by the shortest rotation to ``pose`` (4, 4).

    Moving back along the path removes waypoints.
    """
    if not (np.isfinite(current_pose).all() and np.isfinite(pose).all()):
        return ()
    passed = [np.eye(4), *waypoints, current_pose]
    while len(passed) > 1 and _is_redundant(passed[-2], passed[-1], pose):
        passed.pop()
    return tuple(frozen(np.array(each)) for each in passed[1:])


def _is_redundant(before: np.ndarray, between: np.ndarray, after: np.ndarray) -> bool:
    ways = (before, between), (between, after), (before, after)
    return max(_angle(*way) for way in ways) <= _FARTHEST


def rotation_vector(waypoints: Sequence[np.ndarray], pose: np.ndarray) -> np.ndarray:
    """Total rotation of a path as a vector (3,): unit axis times angle in radians.

    Of a path from rest along waypoints (4, 4) to ``pose`` (4, 4). Its angle is that of ``pose`` plus or
    minus full turns: as many as come nearest to the sum of the rotations from waypoint to waypoint.
    """
    made = summed_rotations(waypoints, pose)
    turn, total = (
        rigid_transform(rotation_pose(nearest_rotation(pose)), np.zeros(3)),
        float(np.linalg.norm(made)),
    )
    axis = made / total if turn.angle < _STRAIGHT and total > 0.0 else turn.axis
    turns = round((math.copysign(total, float(made @ axis)) - turn.angle) / (2.0 * math.pi))
    vector: np.ndarray = axis * (turn.angle + 2.0 * math.pi * turns)
    return vector


def summed_rotations(waypoints: Sequence[np.ndarray], pose: np.ndarray) -> np.ndarray:
    """Sum of the rotation vectors from waypoint to waypoint, (3,), radians.

    For a single axis it is the total rotation.
    """
    rotations = [nearest_rotation(each) for each in (np.eye(4), *waypoints, pose)]
    made: np.ndarray = np.sum(
        [_rotation_vector(after @ before.T) for before, after in itertools.pairwise(rotations)], axis=0
    )
    return made


def signed_angle(vector: np.ndarray) -> float:
    """Angle of a rotation vector (3,), with the sign of its largest coordinate.

    A turn about +y and its opposite thus differ only in sign.
    """
    return math.copysign(float(np.linalg.norm(vector)), float(vector[np.argmax(np.abs(vector))]))


def signed_angle_about(vector: np.ndarray, line: np.ndarray) -> tuple[float, bool]:
    """Signed angle of a rotation vector (3,), and whether it twists about ``line``.

    A twist has the sign of the rotation about the line.
    """
    angle, along = float(np.linalg.norm(vector)), float(vector @ line)
    twists = abs(along) > _ALIGNED * angle * float(np.linalg.norm(line))
    return (math.copysign(angle, along) if twists else signed_angle(vector)), twists


def has_half_turn(waypoints: Sequence[np.ndarray], pose: np.ndarray) -> bool:
    """True if a path to ``pose`` (4, 4) rotates by half a turn or more."""
    return bool(waypoints) and float(np.linalg.norm(rotation_vector(waypoints, pose))) >= _HALF_TURN


def rounded_pose(pose: np.ndarray, size: float) -> np.ndarray:
    """Pose (4, 4) rounded to the digits significant for a mesh of this size.

    Further digits differ between dragged and typed poses, and could change wrinkles after buckling.
    """
    found = np.round(pose, _DIGITS)
    found[:3, 3] = np.round(pose[:3, 3], _DIGITS - math.ceil(math.log10(size)))
    return found + 0.0


class WaypointPath(NamedTuple):
    """Path along waypoints, with a screw motion from each to the next.

    Attributes
    ----------
    poses : tuple of (4, 4) float arrays
        Pose at the start of each segment.
    segments : tuple of ScrewPath
        Screw motion from each of these poses.
    angle : float
        Of the whole turn, radians.
    """

    poses: tuple[np.ndarray, ...]
    segments: tuple[ScrewPath, ...]
    angle: float

    def pose_at(self, fraction: float) -> np.ndarray:
        """Pose (4, 4) at a fraction of the path, with segments weighted by rotation."""
        weights = np.cumsum([max(piece.angle, _LEAST_WEIGHT) for piece in self.segments])
        ends = weights / weights[-1]
        k = min(int(np.searchsorted(ends, fraction)), len(self.segments) - 1)
        start = ends[k - 1] if k else 0.0
        moved: np.ndarray = self.segments[k].pose_at((fraction - start) / (ends[k] - start)) @ self.poses[k]
        return moved

    @property
    def has_motion(self) -> bool:
        """True: the path rotates by at least half a turn."""
        return True

    @property
    def has_stretch(self) -> bool:
        """True if the motion is more than rotations and translations."""
        return any(piece.has_stretch for piece in self.segments)


HandlePath: TypeAlias = ScrewPath | RotationPath | WaypointPath


def handle_path(waypoints: Sequence[np.ndarray], pose: np.ndarray, pivot: npt.ArrayLike) -> HandlePath:
    """Path of a handle with its pivot (3,) from rest to ``pose`` (4, 4).

    Raises
    ------
    InputError
        If a part of it mirrors or flattens, or turns by half a turn without a waypoint.
    """
    if not has_half_turn(waypoints, pose):
        return screw_path(pose, pivot)
    steps = list(_pieces(waypoints, pose))
    vectors = [rotation_vector(waypoints[:k], end) for k, (_, end) in enumerate(steps)]
    angle = float(np.linalg.norm(vectors[-1]))
    turn = _turn(steps[0][1], vectors[0], vectors[-1] / angle, angle)
    if all(
        _is_same_pose(turn.pose_at(v @ turn.axis / angle), end)
        for v, (_, end) in zip(vectors, steps, strict=True)
    ):
        return turn
    centre = np.asarray(pivot, dtype=float)
    pieces = [
        screw_path(end @ np.linalg.inv(start), transform(start, centre[None])[0]) for start, end in steps
    ]
    return WaypointPath(tuple(start for start, _ in steps), tuple(pieces), angle)


def _turn(first: np.ndarray, vector: np.ndarray, axis: np.ndarray, angle: float) -> RotationPath:
    """Rotation about the unit axis (3,), on the rotation line of the first waypoint."""
    R = rotation_about(np.zeros(3), axis, float(vector @ axis))[:3, :3]
    point = np.linalg.lstsq(np.eye(3) - R, first[:3, 3], rcond=1e-6)[0]
    return RotationPath(point, axis, angle)


def _is_same_pose(one: np.ndarray, other: np.ndarray) -> bool:
    return bool(np.abs(one - other).max() <= _SAME * max(1.0, np.abs(other[:3, 3]).max()))


def _pieces(waypoints: Sequence[np.ndarray], pose: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    passed = [np.eye(4), *waypoints, pose]
    return itertools.pairwise(passed)


def _angle(one: np.ndarray, other: np.ndarray) -> float:
    """Angle of the shortest rotation between two poses, radians."""
    return rigid_transform(
        rotation_pose(nearest_rotation(other) @ nearest_rotation(one).T), np.zeros(3)
    ).angle


def nearest_rotation(pose: np.ndarray) -> np.ndarray:
    """Rotation (3, 3) nearest to the linear part of a pose."""
    left, _, right = np.linalg.svd(pose[:3, :3])
    rotation: np.ndarray = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
    return rotation


def rotation_pose(R: np.ndarray) -> np.ndarray:
    """Pose (4, 4) of a rotation (3, 3) about the origin."""
    pose = np.eye(4)
    pose[:3, :3] = R
    return pose


def _rotation_vector(R: np.ndarray) -> np.ndarray:
    """Rotation vector (3,) of a rotation (3, 3) by at most half a turn."""
    turn = rigid_transform(rotation_pose(R), np.zeros(3))
    return turn.angle * turn.axis
