"""Immutable camera with rays, projections, moves and framing, without OpenGL."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from PySide6.QtCore import QRectF

from apd_viewer.session.model.up_axis import UpAxis

DEGREES_PER_PIXEL = 0.4
MARGIN = 1.15
_ROOMY, _LEAST_SCALE = 450.0, 0.5  # px: side of a view in which overlays have their full size

# Opening angles, radians. An orthographic view uses a perspective camera so narrow and distant that half the
# picture height in depth shifts a point by only a twentieth of a pixel. Rays, projections, zoom, framing and
# saved views thus need no second kind of camera. A still narrower angle would cost depth resolution.
PERSPECTIVE, ORTHOGRAPHIC = np.deg2rad([30.0, 0.02]).tolist()

# Direction from the mesh to the camera, and up direction of the picture, for a mesh with +Y up.
STANDPOINTS = {
    "front": ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0)),
    "side": ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    "top": ((0.0, 1.0, 0.0), (0.0, 0.0, -1.0)),
}


@dataclass(frozen=True, eq=False)
class Camera:
    """Perspective camera with the size of its picture.

    Pixels are logical ones: (0, 0) is the upper left corner of the picture, y points down.

    Parameters
    ----------
    position, focal, up : (3,) float array
        ``focal`` is the point that stays in the middle when the camera orbits.
    angle : float
        Vertical view angle, radians.
    width, height : float
        Lengths in logical pixels, unless noted.
    up_axis : UpAxis
        Of the mesh: level when the camera orbits.
    left : float
        Width of what covers the left edge; the focal point is in the middle of the rest.
    """

    position: np.ndarray
    focal: np.ndarray
    up: np.ndarray
    angle: float
    width: float
    height: float
    up_axis: UpAxis = UpAxis.PLUS_Y
    left: float = 0.0

    @cached_property
    def axes(self) -> np.ndarray:
        """Unit vectors right, up and forward, as rows of a (3, 3) array."""
        forward = unit_vector(self.focal - self.position)
        right = unit_vector(np.cross(forward, self.up))
        return np.array([right, np.cross(right, forward), forward])

    @property
    def distance(self) -> float:
        """Distance from the position to the focal point."""
        return float(np.linalg.norm(self.focal - self.position))

    @property
    def pixel_height(self) -> float:
        """Height of one pixel at depth one."""
        return 2.0 * float(np.tan(self.angle / 2)) / self.height

    @property
    def overlay_scale(self) -> float:
        """Size of overlays relative to their full size; less than 1 in a small view."""
        return max(_LEAST_SCALE, min(1.0, self.width / _ROOMY, self.height / _ROOMY))

    @property
    def span(self) -> float:
        """Height of the picture at the focal point, mesh units."""
        return self.pixel_height * self.height * self.distance

    @property
    def is_orthographic(self) -> bool:
        """True if the lines of sight are parallel."""
        return bool(self.angle < (PERSPECTIVE * ORTHOGRAPHIC) ** 0.5)

    @property
    def key(self) -> tuple[float, ...]:
        """Hashable key of the view, equal for cameras with identical pictures."""
        return (*self.position, *self.focal, *self.up, self.angle, self.width, self.height, self.left)

    @property
    def middle(self) -> np.ndarray:
        """Pixel position (2,) of the focal point."""
        return np.array([(self.left + self.width) / 2, self.height / 2])

    def depth(self, points: np.ndarray) -> np.ndarray:
        """Signed distance of points in front of the camera plane."""
        return (points - self.position) @ self.axes[2]

    def ray(self, x: float, y: float) -> tuple[np.ndarray, np.ndarray]:
        """Origin and unit direction of the ray through a pixel position."""
        (right, up, forward), (across, along) = self.axes, self.middle
        aside = self.pixel_height * ((x - across) * right + (along - y) * up)
        return self.position, unit_vector(forward + aside)

    def project(self, points: np.ndarray) -> np.ndarray:
        """Pixel positions (k, 2) of points (k, 3); undefined behind the camera."""
        local = (points - self.position) @ self.axes.T
        scale = 1.0 / (self.pixel_height * np.maximum(local[:, 2], 1e-12 * self.distance))
        across, along = self.middle
        return np.column_stack([across + local[:, 0] * scale, along - local[:, 1] * scale])

    def world_per_pixel(self, point: np.ndarray) -> float:
        """Length of one pixel, in mesh units, at the depth of a point."""
        return self.pixel_height * max(float(self.depth(point)), 1e-12 * self.distance)

    def point_on_focal_plane(self, x: float, y: float) -> np.ndarray:
        """Point in the focal plane at a pixel position."""
        origin, direction = self.ray(x, y)
        return origin + direction * (self.distance / float(direction @ self.axes[2]))

    def orbited(self, dx: float, dy: float) -> Camera:
        """Camera orbited by a drag of (dx, dy) pixels; the horizon stays level."""
        # Even upside down, a drag to the right must move the front of the object to the right.
        up = self.up_axis.direction
        side = 1.0 if self.up @ up >= 0 else -1.0
        yaw = rotation(up, -side * np.deg2rad(DEGREES_PER_PIXEL * dx))
        pitch = rotation(yaw @ self.axes[0], -np.deg2rad(DEGREES_PER_PIXEL * dy))
        return self._rotated(pitch @ yaw)

    def turned(self, degrees: float) -> Camera:
        """Camera turned about the up axis; seen from above, the mesh turns clockwise."""
        up = self.up_axis.direction
        sense = -1.0 if self.axes[2] @ up > 1e-9 else 1.0
        return self._rotated(rotation(up, sense * np.deg2rad(degrees)))

    def _rotated(self, turn: np.ndarray) -> Camera:
        """Camera rotated about the focal point by a (3, 3) matrix."""
        position = self.focal + turn @ (self.position - self.focal)
        return replace(self, position=position, up=unit_vector(turn @ self.axes[1]))

    def panned(self, dx: float, dy: float) -> Camera:
        """Camera panned by (dx, dy) pixels at the depth of the focal point."""
        right, up, _ = self.axes
        shift = self.pixel_height * self.distance * (dy * up - dx * right)
        return replace(self, position=self.position + shift, focal=self.focal + shift)

    def zoomed(self, point: np.ndarray, factor: float) -> Camera:
        """Camera ``factor`` times closer to a point fixed in the picture."""
        return replace(
            self,
            position=point + (self.position - point) / factor,
            focal=point + (self.focal - point) / factor,
        )

    def with_angle(self, angle: float) -> Camera:
        """Camera with a new view angle and an unchanged span."""
        away = self.distance * np.tan(self.angle / 2) / np.tan(angle / 2)
        return replace(self, position=self.focal - away * self.axes[2], angle=angle)

    def framed(self, points: np.ndarray, padding: np.ndarray | float = 0.0) -> Camera:
        """Camera framing all points as large as possible, in an unchanged direction.

        Their picture is in the middle of what is not covered. ``padding``, (k,) or one for all, is how many
        pixels must be free around each of the (k, 3) points.
        """
        rooms = np.broadcast_to(padding, len(points))
        least, local = float(rooms.min()), points @ self.axes.T
        lowest, most = local.min(axis=0), local.max(axis=0)
        if np.array_equal(lowest, most):
            at = lowest - [0.0, 0.0, 1.0]  # a single point fits at any distance
        else:
            slopes = self._slopes(least)
            # How far the points reach beyond the sides of a view from the origin.
            aside, ahead = slopes * local[:, :2], local[:, 2:]
            over, under = (aside - ahead).max(axis=0), (-aside - ahead).max(axis=0)
            aside, depth = (over - under) / (2.0 * slopes), float(-(over + under).max() / 2.0)
            for k in np.flatnonzero(rooms > least):
                reach = self._slopes(float(rooms[k])) * np.abs(local[k, :2] - aside)
                depth = min(depth, float(local[k, 2] - reach.max()))
            at = np.append(_centred_aside(local, aside, depth), depth)
        position = at @ self.axes
        away = (lowest[2] + most[2]) / 2 - at[2]
        return replace(self, position=position, focal=position + away * self.axes[2])

    def _slopes(self, room: float) -> np.ndarray:
        """Depth (2,) at which points 1 off the middle fit with ``room`` pixels."""
        half, free = np.tan(self.angle / 2), max(self.width - self.left, 1.0)
        # A tiny viewport cannot hold the padding; the points then get a tenth of its size.
        across, along = (max(1.0 - 2.0 * room / size, 0.1) for size in (free, self.height))
        return MARGIN / (half * np.array([free / self.height * across, along]))

    def standard_view(self, name: str) -> Camera:
        """Camera in the 'front', 'side' or 'top' view; prefix '-' gives the opposite."""
        stand, up = (np.array(v) for v in STANDPOINTS[name.removeprefix("-")])
        if name.startswith("-"):
            stand, up = -stand, up if up[1] else -up
        return self.seen_from(stand @ self.up_axis.frame, up @ self.up_axis.frame)

    def seen_from(self, direction: np.ndarray, up: np.ndarray | None = None) -> Camera:
        """Camera in a direction (3,) from the focal point, level if ``up`` is None."""
        up = self.up_axis.direction if up is None else up
        return replace(self, position=self.focal + self.distance * direction, up=up)


def _centred_aside(local: np.ndarray, aside: np.ndarray, depth: float) -> np.ndarray:
    """Lateral position (2,) that centres the picture of points (k, 3).

    ``aside`` is one to begin with, ``depth`` that of the camera.
    """
    nearness = 1.0 / (local[:, 2:] - depth)
    for _ in range(4):  # each step centres the outermost points of the step before
        picture = (local[:, :2] - aside) * nearness
        ends = np.stack([picture.argmin(axis=0), picture.argmax(axis=0)])
        near = nearness[ends, 0]
        aside = (local[ends, [0, 1]] * near).sum(axis=0) / near.sum(axis=0)
    return aside


def unit_vector(v: np.ndarray) -> np.ndarray:
    """Vector ``v`` scaled to length one."""
    return v / np.linalg.norm(v)


def rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    """Right-handed rotation matrix (3, 3) about a unit axis, angle in radians."""
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * (K @ K)


# Approximate number of vertices tested for visibility.
_SAMPLES = 32
# Fractions of the best visibility: enough to keep the camera, and enough to accept a nearer view.
_ENOUGH, _BEST = 0.4, 0.9
# Candidate views: number of azimuths, and elevations in radians.
_WAYS = 12
_HEIGHTS = np.deg2rad([0.0, 30.0, -30.0, 60.0, -60.0])
# Largest fraction of the points that may be covered.
_UNSEEN = 0.2
# Margin around the points, as a fraction of the mesh diagonal.
_AROUND = 0.08

# Function from ray origins and directions, (k, 3), to hit distances (k,).
RayDistances = Callable[[np.ndarray, np.ndarray], np.ndarray]


def unobstructed_camera(
    camera: Camera, points: np.ndarray, normals: np.ndarray, size: float, rays: RayDistances
) -> Camera:
    """Camera orbited until the surface does not hide the points.

    The camera is unchanged if it already sees enough of the visible part.

    Parameters
    ----------
    points, normals : (k, 3) float array
        Normals are of length one, or zero where there is no surface.
    size : float
        Of the mesh.
    """
    every = 1 + len(points) // _SAMPLES
    points, normals = points[::every], normals[::every]
    here = -camera.axes[2]
    now = _visible_fraction(points, normals, here, size, rays)
    if now >= _ENOUGH:
        return camera  # enough even if the best view shows all points
    stands = _candidate_directions(camera.up_axis.frame @ here) @ camera.up_axis.frame
    seen = np.array([_visible_fraction(points, normals, stand, size, rays) for stand in stands])
    if now >= _ENOUGH * seen.max():
        return camera
    stand = stands[np.flatnonzero(seen >= _BEST * seen.max())[0]]
    return camera.seen_from(stand)


def _candidate_directions(here: np.ndarray) -> np.ndarray:
    """Candidate directions (k, 3) with +Y up: level and near ones first."""
    turn, height = np.meshgrid(np.arange(_WAYS) * 2.0 * np.pi / _WAYS, _HEIGHTS)
    level = np.cos(height)
    stands = np.stack([level * np.sin(turn), np.sin(height), level * np.cos(turn)], axis=-1).reshape(-1, 3)
    return stands[np.argsort(np.abs(stands[:, 1]) - stands @ here, kind="stable")]


def _visible_fraction(
    points: np.ndarray, normals: np.ndarray, stand: np.ndarray, size: float, rays: RayDistances
) -> float:
    """Fraction of the surface at the points visible from direction ``stand``."""
    away = 2.0 * size
    met = rays(points + away * stand, np.tile(-stand, (len(points), 1)))
    faces = np.where(normals.any(axis=1), np.abs(normals @ stand), 1.0)
    return float((faces * (met > away - 1e-3 * size)).mean())


def is_in_view(camera: Camera, points: np.ndarray, covered: QRectF) -> bool:
    """True if all points are in view and most of them uncovered."""
    if (camera.depth(points) <= 0.0).any():
        return False
    x, y = camera.project(points).T
    across = (x > covered.left()) & (x < covered.right())
    under = across & (y > covered.top()) & (y < covered.bottom())
    inside = (x >= 0) & (x <= camera.width) & (y >= 0) & (y <= camera.height)
    return bool(inside.all() and under.mean() <= _UNSEEN)


def surrounding_box(points: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Corners (8, 3) of the points' bounding box, padded within the mesh bounds."""
    pad = _AROUND * float(np.linalg.norm(high - low))
    near, far = points.min(axis=0), points.max(axis=0)
    ends = np.array([np.maximum(near - pad, low), np.minimum(far + pad, high)])
    return np.array([[ends[i, 0], ends[j, 1], ends[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])


def centring_shift(camera: Camera, covered: QRectF) -> tuple[float, float]:
    """Shift in pixels, left or up, centring the view in the uncovered part.

    ``covered`` is a part at the lower right; the displayed mesh must have as many free pixels around it.
    """
    wide, tall = max(0.0, camera.width - covered.left()), max(0.0, camera.height - covered.top())
    beside, above = (camera.width - wide) * camera.height, (camera.height - tall) * camera.width
    return (-wide / 2, 0.0) if beside > above else (0.0, -tall / 2)
