"""Camera as a value: rays, projections and moves, without Qt and OpenGL."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from apd_viewer.session.model.up_axis import UpAxis

DEGREES_PER_PIXEL = 0.4
MARGIN = 1.15

# Opening angles, radians. The orthographic one is so narrow, and its camera so far away, that half the height
# of the picture in depth is a twentieth of a pixel aside: rays, projections, zoom, framing and saved views
# need no second kind of camera. A still narrower one would cost depth resolution.
PERSPECTIVE, ORTHOGRAPHIC = np.deg2rad([30.0, 0.02]).tolist()

# Where the camera stands, and which way is up in the picture, for a mesh with +Y up.
STANDPOINTS = {
    "front": ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0)),
    "side": ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    "top": ((0.0, 1.0, 0.0), (0.0, 0.0, -1.0)),
}


@dataclass(frozen=True, eq=False)
class Camera:
    """A perspective camera and the size of the picture it takes.

    Pixels are logical ones: (0, 0) is the upper left corner of the picture, y points down.

    Parameters
    ----------
    position, focal, up : (3,) float array
        ``focal`` is the point that stays in the middle when the camera orbits.
    angle : float
        Vertical opening angle, radians.
    width, height : float
        Logical pixels.
    up_axis : UpAxis
        Of the mesh: level when the camera orbits.
    """

    position: np.ndarray
    focal: np.ndarray
    up: np.ndarray
    angle: float
    width: float
    height: float
    up_axis: UpAxis = UpAxis.PLUS_Y

    @cached_property
    def axes(self) -> np.ndarray:
        """Unit vectors right, up and forward, as rows of a (3, 3) array."""
        forward = unit(self.focal - self.position)
        right = unit(np.cross(forward, self.up))
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
    def span(self) -> float:
        """Height of the picture at the focal point, mesh units."""
        return self.pixel_height * self.height * self.distance

    @property
    def is_orthographic(self) -> bool:
        """True for parallel lines of sight."""
        return bool(self.angle < (PERSPECTIVE * ORTHOGRAPHIC) ** 0.5)

    @property
    def key(self) -> tuple[float, ...]:
        """Key equal for cameras with the same picture."""
        return (*self.position, *self.focal, *self.up, self.angle, self.width, self.height)

    def depth(self, points: np.ndarray) -> np.ndarray:
        """Distance of points in front of the camera's plane; negative behind it."""
        return (points - self.position) @ self.axes[2]

    def ray(self, x: float, y: float) -> tuple[np.ndarray, np.ndarray]:
        """Origin and unit direction of the ray through a pixel position."""
        right, up, forward = self.axes
        aside = self.pixel_height * ((x - self.width / 2) * right + (self.height / 2 - y) * up)
        return self.position, unit(forward + aside)

    def project(self, points: np.ndarray) -> np.ndarray:
        """Pixel positions (k, 2) of points (k, 3); undefined behind the camera."""
        local = (points - self.position) @ self.axes.T
        scale = 1.0 / (self.pixel_height * np.maximum(local[:, 2], 1e-12 * self.distance))
        return np.column_stack([self.width / 2 + local[:, 0] * scale, self.height / 2 - local[:, 1] * scale])

    def world_per_pixel(self, point: np.ndarray) -> float:
        """Length of one pixel, in mesh units, at the depth of a point."""
        return self.pixel_height * max(float(self.depth(point)), 1e-12 * self.distance)

    def on_focal_plane(self, x: float, y: float) -> np.ndarray:
        """Point in the focal plane at a pixel position."""
        origin, direction = self.ray(x, y)
        return origin + direction * (self.distance / float(direction @ self.axes[2]))

    def orbited(self, dx: float, dy: float) -> Camera:
        """Camera orbited by a drag of (dx, dy) pixels; the horizon stays level."""
        # Upside down, a drag to the right must still push the front of the object to the right.
        up = self.up_axis.direction
        side = 1.0 if self.up @ up >= 0 else -1.0
        yaw = rotation(up, -side * np.deg2rad(DEGREES_PER_PIXEL * dx))
        pitch = rotation(yaw @ self.axes[0], -np.deg2rad(DEGREES_PER_PIXEL * dy))
        turn = pitch @ yaw
        return replace(
            self, position=self.focal + turn @ (self.position - self.focal), up=unit(turn @ self.axes[1])
        )

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
        """Camera with another opening angle; the focal plane keeps its size."""
        away = self.distance * np.tan(self.angle / 2) / np.tan(angle / 2)
        return replace(self, position=self.focal - away * self.axes[2], angle=angle)

    def framed(self, points: np.ndarray, padding: np.ndarray | float = 0.0) -> Camera:
        """Show all points as large as they fit, seen from the same direction.

        ``padding``, (k,) or one for all, is how many pixels must be free around each of the (k, 3) points.
        """
        rooms = np.broadcast_to(padding, len(points))
        least = float(rooms.min())
        # One look at all the points: how far they reach along the axes, and past each side of the picture.
        reach = np.vstack([np.eye(3), self._sides(least)]) @ points.T
        lowest, most = reach[:3].min(axis=1), reach.max(axis=1)
        centre = (lowest + most[:3]) / 2
        away = float((most[3:] - self._sides(least) @ centre).max())
        for k in np.flatnonzero(rooms > least):
            away = max(away, float((self._sides(float(rooms[k])) @ (points[k] - centre)).max()))
        if np.array_equal(lowest, most[:3]):
            away = 1.0  # a single point can be seen from anywhere
        return replace(self, position=centre - away * self.axes[2], focal=centre)

    def _sides(self, room: float) -> np.ndarray:
        """Planes of the view frustum reduced by ``room``, (4, 3)."""
        half = np.tan(self.angle / 2)
        # A tiny view cannot hold the room; there the points must do with a tenth of it.
        across, along = (max(1.0 - 2.0 * room / size, 0.1) for size in (self.width, self.height))
        wide = MARGIN / (half * self.width / self.height * across) * self.axes[0]
        tall = MARGIN / (half * along) * self.axes[1]
        return np.stack([wide, -wide, tall, -tall]) - self.axes[2]

    def looking_along(self, axis: str) -> Camera:
        """Camera along 'front', 'side' or 'top', or '-' for the opposite."""
        stand, up = (np.array(v) for v in STANDPOINTS[axis.removeprefix("-")])
        if axis.startswith("-"):
            stand, up = -stand, up if up[1] else -up
        return self.seen_from(stand @ self.up_axis.frame, up @ self.up_axis.frame)

    def seen_from(self, direction: np.ndarray, up: np.ndarray | None = None) -> Camera:
        """Camera in a direction (3,) from the focal point, level without ``up``."""
        up = self.up_axis.direction if up is None else up
        return replace(self, position=self.focal + self.distance * direction, up=up)


def unit(v: np.ndarray) -> np.ndarray:
    """``v`` scaled to length one."""
    return v / np.linalg.norm(v)


def rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rotation (3, 3) about a unit axis, radians, right-handed."""
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * (K @ K)
