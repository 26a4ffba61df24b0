"""Layout of the gizmo's handles on the screen, and hit testing.

Handles are named ``x y z`` (arrows), ``yz zx xy`` (squares), ``rx ry rz`` (rings), ``centre`` and ``scale``.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np
import numpy.typing as npt

from apd_viewer.ui.scene.camera import Camera, unit

# Logical pixels.
SHAFT = (15.0, 92.0)
TIP = 110.0
TIP_RADIUS = 6.5
LABEL = 124.0
GIZMO_RADIUS = 136.0  # all of it, letters included, lies within this distance of the centre
RING_RADIUS = 76.0
SQUARE = (27.0, 43.0)
DOT_RADIUS = 5.0
SCALE = (86.0, -86.0)  # from the centre, across and down the picture
PICK_RADIUS = 8.0

ARROWS, SQUARES, RINGS = ("x", "y", "z"), ("yz", "zx", "xy"), ("rx", "ry", "rz")
ALL_HANDLES = frozenset({*ARROWS, *SQUARES, *RINGS, "centre", "scale"})
ALONG_VIEW = 0.96  # |cosine| beyond which an arrow, 16 degrees from the line of sight, cannot be dragged
EDGE_ON = 0.16  # |cosine| below which a square or a ring is a line
_TURN = np.linspace(0.0, 2 * np.pi, 73)


def axis_index(handle: str) -> int:
    """0, 1 or 2: the axis of an arrow or a ring, the normal of a square."""
    return {**{h: i for hs in (ARROWS, SQUARES, RINGS) for i, h in enumerate(hs)}}[handle]


class GizmoOrientation(Enum):
    """Axes of the gizmo."""

    WORLD = "world"
    HANDLE = "handle"
    VIEW = "view"


@dataclass(frozen=True, eq=False)
class GizmoFrame:
    """The gizmo as a camera sees it.

    Parameters
    ----------
    camera : Camera
    centre : (3,) float array
    axes : (3, 3) float array
        Unit axes, as rows.
    offered_handles : frozenset of str
        Handles that there are.
    """

    camera: Camera
    centre: np.ndarray
    axes: np.ndarray
    offered_handles: frozenset[str] = ALL_HANDLES

    @cached_property
    def pixel_length(self) -> float:
        """Length of a pixel at the centre, in mesh units."""
        return self.camera.world_per_pixel(self.centre)

    @cached_property
    def facing(self) -> np.ndarray:
        """Cosine between each axis and the direction to the camera."""
        return self.axes @ unit(self.camera.position - self.centre)

    @cached_property
    def screen_centre(self) -> np.ndarray:
        """Pixel position of the centre, (2,)."""
        place: np.ndarray = self.to_screen(np.zeros((1, 3)))[0]
        return place

    @property
    def corner(self) -> np.ndarray:
        """Pixel position (2,) of the scale handle."""
        return self.screen_centre + SCALE

    @property
    def is_visible(self) -> bool:
        """True if the centre is in front of the camera."""
        return float(self.camera.depth(self.centre)) > 1e-6 * self.camera.distance

    def is_usable(self, handle: str) -> bool:
        """True if the handle is offered and can be dragged from this side."""
        if handle not in self.offered_handles:
            return False
        if handle in ARROWS:
            return bool(abs(self.facing[axis_index(handle)]) < ALONG_VIEW)
        if handle in SQUARES:
            return bool(abs(self.facing[axis_index(handle)]) > EDGE_ON)
        return True

    def to_screen(self, offsets: npt.ArrayLike) -> np.ndarray:
        """Pixel positions, (k, 2), of points given in pixels along the axes, (k, 3)."""
        return self.camera.project(self.centre + self.pixel_length * (np.asarray(offsets) @ self.axes))

    def arrow(self, i: int) -> np.ndarray:
        """Both ends of the shaft, the tip and the place of the letter, (4, 2) pixels."""
        return self.to_screen(np.outer([*SHAFT, TIP, LABEL], np.eye(3)[i]))

    def tip(self, i: int) -> np.ndarray:
        """Outline (k, 2) of an arrow's cone in pixels, in no order."""
        circle = _circle(i, _TURN[::6]) * TIP_RADIUS + SHAFT[1] * np.eye(3)[i]
        return np.vstack([self.to_screen(circle), self.arrow(i)[2]])

    def square(self, i: int) -> np.ndarray:
        """Corners (4, 2) in pixels of the square with normal along axis ``i``."""
        a, b = np.delete(np.eye(3), i, axis=0)
        near, far = SQUARE
        return self.to_screen(
            np.array([near * (a + b), far * a + near * b, far * (a + b), near * a + far * b])
        )

    def ring(self, i: int) -> tuple[np.ndarray, np.ndarray]:
        """Points (73, 2) of a ring in pixels, and a mask of the near side."""
        circle = _circle(i, _TURN)
        towards = circle @ self.facing
        return self.to_screen(RING_RADIUS * circle), towards > -0.12

    def handle_at(self, x: float, y: float) -> str | None:
        """Handle at a pixel position, or None."""
        if not self.is_visible:
            return None
        cursor = np.array([x, y])
        if self.is_usable("centre") and np.linalg.norm(self.screen_centre - cursor) <= DOT_RADIUS + 4:
            return "centre"
        if self.is_usable("scale") and np.abs(self.corner - cursor).max() <= PICK_RADIUS:
            return "scale"
        for i, name in enumerate(SQUARES):
            if self.is_usable(name) and is_inside(self.square(i), cursor):
                return name
        # A ring is thin and an arrow ends in open space: the arrow wins where both are in reach.
        reach = [
            (self._arrow_distance(i, cursor) - 2.0, ARROWS[i]) for i in range(3) if self.is_usable(ARROWS[i])
        ]
        reach += [(self._ring_distance(i, cursor), RINGS[i]) for i in range(3) if self.is_usable(RINGS[i])]
        distance, name = min(reach, default=(np.inf, ""))
        return name if distance <= PICK_RADIUS else None

    def _arrow_distance(self, i: int, cursor: np.ndarray) -> float:
        start, end, tip, _ = self.arrow(i)
        shaft = distance_to_polyline(np.array([start, tip]), cursor)
        return min(shaft, distance_to_polyline(np.array([end, tip]), cursor) - TIP_RADIUS + 3.0)

    def _ring_distance(self, i: int, cursor: np.ndarray) -> float:
        points, near = self.ring(i)
        return distance_to_polyline(points, cursor, near[1:] & near[:-1])


def _circle(i: int, turn: np.ndarray) -> np.ndarray:
    """Unit circle around axis ``i``, counter-clockwise seen from its tip, (k, 3)."""
    a, b = np.eye(3)[(i + 1) % 3], np.eye(3)[(i + 2) % 3]
    return np.outer(np.cos(turn), a) + np.outer(np.sin(turn), b)


def is_inside(polygon: np.ndarray, point: np.ndarray) -> bool:
    """True if a point lies in a convex polygon (k, 2) of either orientation."""
    edge, to = np.roll(polygon, -1, axis=0) - polygon, point - polygon
    turn = edge[:, 0] * to[:, 1] - edge[:, 1] * to[:, 0]
    return bool((turn >= 0).all() or (turn <= 0).all())


def distance_to_polyline(points: np.ndarray, cursor: np.ndarray, mask: np.ndarray | None = None) -> float:
    """Distance of a point to the ``mask`` (k - 1,) bool of a polyline (k, 2)."""
    start, edge = points[:-1], np.diff(points, axis=0)
    t = np.einsum("ij,ij->i", cursor - start, edge) / np.maximum(np.einsum("ij,ij->i", edge, edge), 1e-12)
    distance = np.linalg.norm(start + np.clip(t, 0, 1)[:, None] * edge - cursor, axis=1)
    return float(np.min(distance, initial=np.inf, where=True if mask is None else mask))
