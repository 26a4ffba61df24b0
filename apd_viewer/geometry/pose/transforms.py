"""Transforms (4, 4) acting on columns (x, y, z, 1); angles in radians.

Rotations are counter-clockwise seen from the tip of their axis.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from apd_viewer.errors import InputError
from apd_viewer.language import tr

# Relative to the coordinates: the direction between closer centres is determined by rounding.
_APART = 1e-12


class RigidTransform(NamedTuple):
    """Rigid transform as displayed: rotation about a centre, and displacement.

    Attributes
    ----------
    displacement : (3,) float array
        Way of the centre, mesh units.
    axis : (3,) float array
        Unit vector; (0, 0, 1) where nothing turns.
    angle : float
        From 0 to pi.
    """

    displacement: np.ndarray
    axis: np.ndarray
    angle: float


def translation(vector: npt.ArrayLike) -> np.ndarray:
    """Translation (4, 4) by ``vector`` (3,), mesh units."""
    pose = np.eye(4)
    pose[:3, 3] = vector
    return pose


def rotation_about(point: npt.ArrayLike, axis: npt.ArrayLike, angle: float) -> np.ndarray:
    """Rotation about the line through ``point`` (3,) along a nonzero ``axis`` (3,)."""
    return linear_map_about(point, _rotation(_direction(axis), angle))


def scaling_about(point: npt.ArrayLike, factors: npt.ArrayLike) -> np.ndarray:
    """Scaling about ``point`` (3,) by one factor, or by one factor per axis."""
    each = np.broadcast_to(np.asarray(factors, dtype=float), 3)
    if not np.isfinite(each).all() or not each.all():
        raise InputError(tr("A scale must be a finite number other than 0; give one such as 1.5."))
    return linear_map_about(point, np.diag(each))


def twist(base: npt.ArrayLike, handle: npt.ArrayLike, angle: float) -> np.ndarray:
    """Rotation about the line from the base's centre (3,) to the handle's."""
    start, end = np.asarray(base, dtype=float), np.asarray(handle, dtype=float)
    if np.abs(end - start).max() <= _APART * max(np.abs(start).max(), np.abs(end).max()):
        raise InputError(
            tr(
                "The centres of the base and the handle coincide, so there is no line to twist about; "
                "bend about an axis instead."
            )
        )
    return rotation_about(start, end - start, angle)


def shear(base: npt.ArrayLike, handle: npt.ArrayLike, axis: npt.ArrayLike, factor: float) -> np.ndarray:
    """Shear along ``axis`` (3,) by ``factor`` times the height over the base.

    The height is measured from the base's centre (3,) towards the handle's, perpendicular to the axis, so
    that volumes are preserved.
    """
    start, end, along = np.asarray(base, dtype=float), np.asarray(handle, dtype=float), _direction(axis)
    rise = (end - start) - ((end - start) @ along) * along
    if np.abs(rise).max() <= _APART * max(np.abs(start).max(), np.abs(end).max()):
        raise InputError(
            tr(
                "The axis is along the line from the base to the handle, so there is no height to shear by; "
                "choose another axis."
            )
        )
    return linear_map_about(start, np.eye(3) + factor * np.outer(along, _direction(rise)))


def rigid_transform(pose: np.ndarray, centre: npt.ArrayLike) -> RigidTransform:
    """Rigid ``pose`` (4, 4) as rotation about ``centre`` (3,) and displacement.

    The sign of the axis of half a turn is arbitrary.
    """
    start, R = np.asarray(centre, dtype=float), pose[:3, :3]
    w, *xyz = quaternion(R)
    half = np.array(xyz)
    axis = _direction(half) if half.any() else np.array([0.0, 0.0, 1.0])
    # (R - I) c is small for small angles; computing R c - c would add rounding errors to the displacement.
    displacement = (R - np.eye(3)) @ start + pose[:3, 3]
    return RigidTransform(displacement, axis, float(2.0 * np.arctan2(half @ axis, w)))


def linear_map_about(point: npt.ArrayLike, A: np.ndarray) -> np.ndarray:
    """Pose with linear part ``A`` (3, 3) and fixed point ``point`` (3,)."""
    place = np.asarray(point, dtype=float)
    pose = np.eye(4)
    pose[:3, :3] = A
    pose[:3, 3] = place - A @ place
    return pose


def _direction(axis: npt.ArrayLike) -> np.ndarray:
    """Unit vector along ``axis`` (3,)."""
    way = np.asarray(axis, dtype=float)
    longest = np.abs(way).max()
    if not 0.0 < longest < np.inf:
        raise InputError(tr("The axis has no direction; give three finite numbers that are not all 0."))
    # Scaled first, as the squares of numbers such as 1e-200 would underflow to 0.
    way = way / longest
    return way / np.linalg.norm(way)


def _rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rotation (3, 3) about a unit axis by Rodrigues' formula; identity at angle 0."""
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    # 1 - cos(angle) itself would lose the digits of small angles.
    versine = 2.0 * np.sin(angle / 2) ** 2
    return np.eye(3) + np.sin(angle) * K + versine * (K @ K)


def quaternion(R: np.ndarray) -> np.ndarray:
    """Unit quaternion (w, x, y, z), w >= 0, of a rotation (3, 3).

    ``4 q q^T`` is linear in R. Its row with the largest diagonal entry is accurate even at half a turn
    [Shepperd 1978, Quaternion from Rotation Matrix].
    """
    (a, b, c), (d, e, f), (g, h, i) = R
    rows = np.array(
        [
            [1 + a + e + i, h - f, c - g, d - b],
            [h - f, 1 + a - e - i, b + d, c + g],
            [c - g, b + d, 1 + e - a - i, f + h],
            [d - b, c + g, f + h, 1 + i - a - e],
        ]
    )
    q = rows[np.argmax(np.diag(rows))]
    return q / np.copysign(np.linalg.norm(q), q[0])


# Width over length below which points count as collinear, with no rotation about their line.
_LINE = 1e-6


def fitted_motion(X: np.ndarray, Y: np.ndarray) -> np.ndarray:
    """Least-squares similarity transform (4, 4) from ``X`` (k, 3) to ``Y``.

    [Umeyama 1991, Least-squares estimation of transformation parameters between two point patterns]. Points
    that coincide are only translated.
    """
    centre, target = X.mean(axis=0), Y.mean(axis=0)
    x, y = X - centre, Y - target
    left, sizes, right = np.linalg.svd(y.T @ x)
    signs = np.array([1.0, 1.0, np.linalg.det(left @ right)])
    spread = float((x * x).sum())
    scale = float(sizes @ signs) / spread if spread > 0.0 else 1.0
    linear = (left * signs) @ right
    fitted: np.ndarray = translation(target - centre) @ linear_map_about(centre, (scale or 1.0) * linear)
    return fitted


def fitted_rotation(X: np.ndarray, Y: np.ndarray) -> np.ndarray | None:
    """Least-squares rotation (3, 3) from ``X`` (k, 3) to ``Y``; None if collinear."""
    if len(X) < 3:
        return None
    sizes = np.linalg.svd(X - X.mean(axis=0), compute_uv=False)
    if sizes[1] <= _LINE * sizes[0]:
        return None
    linear = fitted_motion(X, Y)[:3, :3]
    rotation: np.ndarray = linear / np.cbrt(np.linalg.det(linear))
    return rotation
