"""Pose changes by drags of the gizmo; angles in radians.

Handles are named ``x y z`` (arrows), ``yz zx xy`` (squares), ``rx ry rz`` (rings), ``centre`` and ``scale``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property

import numpy as np
import numpy.typing as npt

from apd_viewer.geometry.pose.transforms import rotation_about, scaling_about, translation
from apd_viewer.presentation.number_format import format_grouped, format_signed
from apd_viewer.ui.scene.camera import Camera, unit_vector

MOST_DRAG_RATIO = 4.0  # an arrow moves the handle at most this many times as far as the cursor
SNAP_ANGLE = np.deg2rad(15.0)
SNAP_PIXELS = 20.0
SNAP_SCALE = 0.1  # step of a snapped scale, and smallest scale factor


@dataclass(frozen=True, eq=False)
class GizmoDrag:
    """Drag in progress, computed from its start to avoid drift.

    Parameters
    ----------
    frame : GizmoFrame
        The gizmo when the drag began.
    start_pose : (4, 4) float array
        The pose when the drag began.
    start, last : (float, float)
        Pixel positions of the cursor.
    pose : (4, 4) float array
        The pose now.
    angle : float
        Rotation by the cursor, before snapping; more than a turn if the cursor went round.
    snapped_angle : float
        Rotation after snapping.
    text : str
        Amount of the drag, in words and numbers.
    """

    handle: str
    frame: GizmoFrame
    start_pose: np.ndarray
    start: tuple[float, float]
    last: tuple[float, float]
    pose: np.ndarray
    angle: float = 0.0
    snapped_angle: float = 0.0
    text: str = ""

    @property
    def axis(self) -> np.ndarray:
        """Unit axis of the arrow or ring; normal of the square or the view plane."""
        if self.handle == "centre":
            return self.frame.camera.axes[2]
        return self.frame.axes[axis_index(self.handle)]

    def moved_to(self, camera: Camera, x: float, y: float, snap: bool) -> GizmoDrag:
        """Drag with the cursor moved to a pixel position."""
        frame = replace(self.frame, camera=camera)
        if self.handle in RINGS:
            return self._with_rotation(frame, x, y, snap)
        if self.handle == "scale":
            return self._with_scaling(frame, x, y, snap)
        return self._with_translation(frame, x, y, snap)

    def _with_rotation(self, frame: GizmoFrame, x: float, y: float, snap: bool) -> GizmoDrag:
        i = axis_index(self.handle)
        angle = self.angle + cursor_rotation(frame, i, self.last, (x, y))
        shown = snapped_value(angle, SNAP_ANGLE) if snap else angle
        pose = rotated_pose(self.start_pose, frame.centre, frame.axes[i], shown)
        text = f"{format_signed(np.rad2deg(shown), 1)}°"
        return replace(self, last=(x, y), pose=pose, angle=angle, snapped_angle=shown, text=text)

    def _with_scaling(self, frame: GizmoFrame, x: float, y: float, snap: bool) -> GizmoDrag:
        far, before = (float(np.linalg.norm(np.array(p) - frame.screen_centre)) for p in ((x, y), self.start))
        factor = far / before
        factor = max(SNAP_SCALE, snapped_value(factor, SNAP_SCALE) if snap else factor)
        pose = scaling_about(frame.centre, factor) @ self.start_pose
        return replace(self, last=(x, y), pose=pose, text=f"× {format_grouped(factor, 2)}")

    def _with_translation(self, frame: GizmoFrame, x: float, y: float, snap: bool) -> GizmoDrag:
        directions, names = self._directions(frame)
        here, there = (self._offset(frame, *p) for p in ((x, y), self.start))
        if here is None or there is None:
            return self
        amounts = directions @ (here - there)
        if self.handle in ARROWS:
            # Limit the motion, which would diverge towards the vanishing point of the axis.
            pixel = self.frame.camera.world_per_pixel(self.frame.centre)
            most = MOST_DRAG_RATIO * pixel * float(np.hypot(x - self.start[0], y - self.start[1]))
            amounts = np.clip(amounts, -most, most)
        if snap:
            step = nice_step(SNAP_PIXELS * frame.pixel_length)
            amounts = np.array([snapped_value(a, step) for a in amounts])
        offset = amounts @ directions
        values = offset if self.handle == "centre" else amounts
        digits, one = max(0, int(np.ceil(-np.log10(frame.pixel_length)))), len(frame.offered_handles) == 1
        said = [
            ("" if one else f"Δ{n} ") + format_signed(v, digits) for n, v in zip(names, values, strict=True)
        ]
        return replace(self, last=(x, y), pose=translated_pose(self.start_pose, offset), text="  ".join(said))

    def _directions(self, frame: GizmoFrame) -> tuple[np.ndarray, str]:
        """Unit directions of free motion, as rows, and names of their amounts."""
        if self.handle in ARROWS:
            return frame.axes[[axis_index(self.handle)]], self.handle
        if self.handle in SQUARES:
            free = [i for i in range(3) if i != axis_index(self.handle)]
            return frame.axes[free], "".join("xyz"[i] for i in free)
        return frame.camera.axes[:2], "xyz"

    def _offset(self, frame: GizmoFrame, x: float, y: float) -> np.ndarray | None:
        if self.handle in ARROWS:
            i = axis_index(self.handle)
            s = position_along_axis(frame, i, x, y)
            return None if s is None else s * frame.axes[i]
        normal = frame.camera.axes[2] if self.handle == "centre" else frame.axes[axis_index(self.handle)]
        return offset_in_plane(frame, normal, x, y)


def begin_drag(handle: str, frame: GizmoFrame, pose: np.ndarray, x: float, y: float) -> GizmoDrag:
    """Begin a drag of a gizmo handle at a pixel position."""
    return GizmoDrag(handle, frame, pose.copy(), (x, y), (x, y), pose.copy())


def position_along_axis(frame: GizmoFrame, i: int, x: float, y: float) -> float | None:
    """Position of the cursor along axis ``i``, in mesh units from the centre.

    The cursor's ray is intersected with the plane through the axis facing the camera most. None if the ray
    misses that plane.
    """
    axis = frame.axes[i]
    sight = unit_vector(frame.centre - frame.camera.position)
    point = _plane_point(frame, sight - (sight @ axis) * axis, x, y)
    return None if point is None else float((point - frame.centre) @ axis)


def offset_in_plane(frame: GizmoFrame, normal: np.ndarray, x: float, y: float) -> np.ndarray | None:
    """Offset (3,) from the centre to the cursor in a plane through the centre."""
    point = _plane_point(frame, normal, x, y)
    return None if point is None else point - frame.centre


def _plane_point(frame: GizmoFrame, normal: np.ndarray, x: float, y: float) -> np.ndarray | None:
    origin, direction = frame.camera.ray(x, y)
    slope = float(direction @ normal)
    if abs(slope) < 1e-3 * float(np.linalg.norm(normal)):
        return None
    t = float((frame.centre - origin) @ normal) / slope
    # Reject points behind the camera, or so distant that one pixel would be a large step.
    return origin + t * direction if 0 < t < 50 * frame.camera.distance else None


def cursor_rotation(
    frame: GizmoFrame, i: int, before: tuple[float, float], after: tuple[float, float]
) -> float:
    """Rotation about axis ``i`` by the cursor's motion, in radians.

    Seen edge-on, a ring is a line: the motion along it determines the rotation.
    """
    axis = frame.axes[i]
    if abs(frame.view_cosines[i]) < EDGE_ON:
        along = _tangent(frame, axis)
        return float((np.array(after) - before) @ along / (along @ along))
    p, q = offset_in_plane(frame, axis, *before), offset_in_plane(frame, axis, *after)
    if p is None or q is None:
        return 0.0
    return float(np.arctan2(np.cross(p, q) @ axis, p @ q))


def _tangent(frame: GizmoFrame, axis: np.ndarray) -> np.ndarray:
    """Pixel motion (2,) per radian of the ring point nearest to the viewer."""
    towards = frame.camera.position - frame.centre
    radial = RING_RADIUS * frame.pixel_length * unit_vector(towards - (towards @ axis) * axis)
    near, ahead = frame.camera.project(frame.centre + np.array([radial, radial + np.cross(axis, radial)]))
    return ahead - near


def snapped_value(value: float, step: float) -> float:
    """Multiple of ``step`` nearest to ``value``."""
    return round(value / step) * step


def nice_step(length: float) -> float:
    """1, 2 or 5 times a power of ten, nearest to ``length`` on a logarithmic scale."""
    power = 10.0 ** np.floor(np.log10(length))
    steps = power * np.array([1.0, 2.0, 5.0, 10.0])
    return float(steps[np.argmin(np.abs(np.log(steps / length)))])


def translated_pose(pose: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """The (4, 4) pose followed by a translation."""
    return translation(offset) @ pose


def rotated_pose(pose: np.ndarray, centre: np.ndarray, axis: np.ndarray, angle: float) -> np.ndarray:
    """The (4, 4) pose followed by a rotation about the unit axis through ``centre``."""
    return rotation_about(centre, axis, angle) @ pose


# Lengths in logical pixels of a large view, unless noted.
RING_RADIUS = 76.0
SHAFT = (15.0, 100.0)
OUTER_SHAFT = (RING_RADIUS + 9.0, SHAFT[1])  # with rings, which an arrow never meets outside of them
TIP = 118.0
TIP_RADIUS = 6.5
LABEL = 132.0
GIZMO_RADIUS = 144.0  # radius of a circle around the whole gizmo, letters included
SQUARE = (27.0, 43.0)
DOT_RADIUS = 5.0
SCALE = (86.0, -86.0)  # offset of the scale handle from the centre, right and down
PICK_RADIUS = 8.0

ARROWS, SQUARES, RINGS = ("x", "y", "z"), ("yz", "zx", "xy"), ("rx", "ry", "rz")
ALL_HANDLES = frozenset({*ARROWS, *SQUARES, *RINGS, "centre", "scale"})
ALONG_VIEW = 0.96  # |cosine| beyond which an arrow, within 16 degrees of the line of sight, cannot be dragged
EDGE_ON = 0.16  # |cosine| below which a square or a ring is a line
_TURN = np.linspace(0.0, 2 * np.pi, 73)


def axis_index(handle: str) -> int:
    """Axis (0, 1 or 2) of an arrow or ring, or of a square's normal."""
    return {**{h: i for hs in (ARROWS, SQUARES, RINGS) for i, h in enumerate(hs)}}[handle]


class GizmoOrientation(Enum):
    """Orientation of the gizmo's axes."""

    WORLD = "world"
    HANDLE = "handle"
    VIEW = "view"


@dataclass(frozen=True, eq=False)
class GizmoFrame:
    """Layout of the gizmo as seen by a camera.

    Parameters
    ----------
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
        """Length of a pixel of the gizmo at its centre, mesh units; less in a small view."""
        return self.camera.overlay_scale * self.camera.world_per_pixel(self.centre)

    @cached_property
    def view_cosines(self) -> np.ndarray:
        """Cosines (3,) between the axes and the direction to the camera."""
        return self.axes @ unit_vector(self.camera.position - self.centre)

    @cached_property
    def screen_centre(self) -> np.ndarray:
        """Pixel position of the centre, (2,)."""
        place: np.ndarray = self.to_screen(np.zeros((1, 3)))[0]
        return place

    @property
    def scale_corner(self) -> np.ndarray:
        """Pixel position (2,) of the scale handle."""
        return self.screen_centre + self.camera.overlay_scale * np.array(SCALE)

    @property
    def is_visible(self) -> bool:
        """True if the centre is in front of the camera."""
        return float(self.camera.depth(self.centre)) > 1e-6 * self.camera.distance

    def is_usable(self, handle: str) -> bool:
        """True if the gizmo handle is offered and can be dragged in this view."""
        if handle not in self.offered_handles:
            return False
        if handle in ARROWS:
            return bool(abs(self.view_cosines[axis_index(handle)]) < ALONG_VIEW)
        if handle in SQUARES:
            return bool(abs(self.view_cosines[axis_index(handle)]) > EDGE_ON)
        return True

    def to_screen(self, offsets: npt.ArrayLike) -> np.ndarray:
        """Pixel positions (k, 2) of offsets (k, 3) along the axes, in pixels."""
        return self.camera.project(self.centre + self.pixel_length * (np.asarray(offsets) @ self.axes))

    def arrow(self, i: int) -> np.ndarray:
        """Shaft ends, tip and letter position of an arrow, (4, 2) pixels."""
        shaft = SHAFT if self.offered_handles.isdisjoint(RINGS) else OUTER_SHAFT
        return self.to_screen(np.outer([*shaft, TIP, LABEL], np.eye(3)[i]))

    def stem_foot(self, i: int) -> np.ndarray:
        """Pixel position (2,) beside the centre where the stem of an arrow begins."""
        foot: np.ndarray = self.to_screen(SHAFT[0] * np.eye(3)[i : i + 1])[0]
        return foot

    def tip(self, i: int) -> np.ndarray:
        """Unordered outline points (k, 2) of an arrow's cone, in pixels."""
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
        towards = circle @ self.view_cosines
        return self.to_screen(RING_RADIUS * circle), towards > -0.12

    def handle_at(self, x: float, y: float) -> str | None:
        """Handle at a pixel position, or None."""
        if not self.is_visible:
            return None
        cursor = np.array([x, y])
        if self.is_usable("centre") and np.linalg.norm(self.screen_centre - cursor) <= DOT_RADIUS + 4:
            return "centre"
        if self.is_usable("scale") and np.abs(self.scale_corner - cursor).max() <= PICK_RADIUS:
            return "scale"
        for i, name in enumerate(SQUARES):
            if self.is_usable(name) and is_inside(self.square(i), cursor):
                return name
        # Favour arrows over rings by 2 pixels where both are in reach: arrow ends stand in open space.
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
    """Distance of a point to the segments in ``mask`` (k - 1,) of a polyline (k, 2)."""
    start, edge = points[:-1], np.diff(points, axis=0)
    t = np.einsum("ij,ij->i", cursor - start, edge) / np.maximum(np.einsum("ij,ij->i", edge, edge), 1e-12)
    distance = np.linalg.norm(start + np.clip(t, 0, 1)[:, None] * edge - cursor, axis=1)
    return float(np.min(distance, initial=np.inf, where=True if mask is None else mask))
