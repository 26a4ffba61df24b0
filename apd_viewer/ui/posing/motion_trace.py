"""Axis and path of a handle's motion, for drawing."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.pose.constraints import transform
from apd_viewer.geometry.pose.transforms import rigid_transform

# Radians: slower is no rotation, and has no axis.
_STILL = 1e-9
# Of the speed of the fastest vertex: a slower centre is near the axis, and its path would be a dot.
_CENTRAL = 0.5
# A path on the surface of the handle would be hard to see.
_ASIDE = 1.6
# In radii of the handle.
_AXIS = 1.8


class MotionTrace(NamedTuple):
    """Path of a point of a handle, and the axis that it turns about.

    Attributes
    ----------
    path : (k, 3) float array
        Empty without a motion.
    axis : (2, 3) float array
        Its ends; (0, 3) without a rotation.
    """

    path: np.ndarray
    axis: np.ndarray


def motion_trace(grip: np.ndarray, poses: Sequence[np.ndarray]) -> MotionTrace:
    """Trace of a handle's centre, or of a point beside an axis through it.

    Parameters
    ----------
    grip : (n, 3) float array
        Vertices of the handle.
    poses : sequence of (4, 4) float arrays
        Along one rotation or one translation.
    """
    nothing = np.empty((0, 3))
    if len(poses) < 2:
        return MotionTrace(nothing, nothing)
    step = poses[1] @ np.linalg.inv(poses[0])
    path = np.array([transform(pose, _tracer(grip, poses[0], step)[None])[0] for pose in poses])
    size = float(np.linalg.norm(grip - grip.mean(axis=0), axis=1).max())
    return MotionTrace(path, _axis(step, path[0], _AXIS * size))


def _tracer(grip: np.ndarray, pose: np.ndarray, step: np.ndarray) -> np.ndarray:
    centre: np.ndarray = grip.mean(axis=0)
    points = np.vstack([centre, grip])
    now = transform(pose, points)
    speed = np.linalg.norm(transform(step, now) - now, axis=1)
    if speed[0] >= _CENTRAL * speed.max():
        return centre
    fastest: np.ndarray = points[int(speed.argmax())]
    return centre + _ASIDE * (fastest - centre)


def _axis(step: np.ndarray, point: np.ndarray, reach: float) -> np.ndarray:
    """Ends of the axis of a small rotation (4, 4), about its place nearest to a point."""
    rigid = rigid_transform(step, point)
    if rigid.angle < _STILL:
        return np.empty((0, 3))
    # The point goes along a chord, over whose middle the axis stands at cot(angle / 2) of half its length.
    across = rigid.displacement - (rigid.displacement @ rigid.axis) * rigid.axis
    middle = point + 0.5 * (across + np.cross(rigid.axis, across) / np.tan(rigid.angle / 2.0))
    return np.array([middle - reach * rigid.axis, middle + reach * rigid.axis])
