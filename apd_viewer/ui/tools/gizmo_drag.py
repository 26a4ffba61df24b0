"""Drags of the gizmo as changes of a pose; angles in radians."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.geometry.pose.transforms import rotation_about, scaling_about, translation
from apd_viewer.presentation.number_format import format_grouped, format_signed
from apd_viewer.ui.scene.camera import unit
from apd_viewer.ui.tools.gizmo_layout import (
    ARROWS,
    EDGE_ON,
    RING_RADIUS,
    RINGS,
    SQUARES,
    GizmoFrame,
    axis_index,
)

if TYPE_CHECKING:
    from apd_viewer.ui.scene.camera import Camera

MOST_DRAG_RATIO = 4.0  # an arrow never moves the handle so many times farther than the cursor went
SNAP_ANGLE = np.deg2rad(15.0)
SNAP_PIXELS = 20.0
SNAP_SCALE = 0.1  # and no handle is made smaller than that


@dataclass(frozen=True, eq=False)
class GizmoDrag:
    """Drag under way, measured from its start to avoid drift.

    Parameters
    ----------
    handle : str
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
        What the drag does, in words and numbers.
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
        """Unit axis of the arrow or ring, or normal of the square or of the picture."""
        if self.handle == "centre":
            return self.frame.camera.axes[2]
        return self.frame.axes[axis_index(self.handle)]

    def moved_to(self, camera: Camera, x: float, y: float, snap: bool) -> GizmoDrag:
        """The drag after the cursor went to a pixel position."""
        frame = replace(self.frame, camera=camera)
        if self.handle in RINGS:
            return self._turned(frame, x, y, snap)
        if self.handle == "scale":
            return self._scaled(frame, x, y, snap)
        return self._shifted(frame, x, y, snap)

    def _turned(self, frame: GizmoFrame, x: float, y: float, snap: bool) -> GizmoDrag:
        i = axis_index(self.handle)
        angle = self.angle + cursor_rotation(frame, i, self.last, (x, y))
        shown = snapped(angle, SNAP_ANGLE) if snap else angle
        pose = rotated(self.start_pose, frame.centre, frame.axes[i], shown)
        text = f"{format_signed(np.rad2deg(shown), 1)}°"
        return replace(self, last=(x, y), pose=pose, angle=angle, snapped_angle=shown, text=text)

    def _scaled(self, frame: GizmoFrame, x: float, y: float, snap: bool) -> GizmoDrag:
        far, before = (float(np.linalg.norm(np.array(p) - frame.screen_centre)) for p in ((x, y), self.start))
        factor = far / before
        factor = max(SNAP_SCALE, snapped(factor, SNAP_SCALE) if snap else factor)
        pose = scaling_about(frame.centre, factor) @ self.start_pose
        return replace(self, last=(x, y), pose=pose, text=f"× {format_grouped(factor, 2)}")

    def _shifted(self, frame: GizmoFrame, x: float, y: float, snap: bool) -> GizmoDrag:
        directions, names = self._directions(frame)
        here, there = (self._offset(frame, *p) for p in ((x, y), self.start))
        if here is None or there is None:
            return self
        amounts = directions @ (here - there)
        if self.handle in ARROWS:
            # Towards the vanishing point of its axis the handle would run away.
            most = (
                MOST_DRAG_RATIO
                * self.frame.pixel_length
                * float(np.hypot(x - self.start[0], y - self.start[1]))
            )
            amounts = np.clip(amounts, -most, most)
        if snap:
            step = nice_step(SNAP_PIXELS * frame.pixel_length)
            amounts = np.array([snapped(a, step) for a in amounts])
        offset = amounts @ directions
        values = offset if self.handle == "centre" else amounts
        digits, one = max(0, int(np.ceil(-np.log10(frame.pixel_length)))), len(frame.offered_handles) == 1
        said = [
            ("" if one else f"Δ{n} ") + format_signed(v, digits) for n, v in zip(names, values, strict=True)
        ]
        return replace(self, last=(x, y), pose=translated(self.start_pose, offset), text="  ".join(said))

    def _directions(self, frame: GizmoFrame) -> tuple[np.ndarray, str]:
        """Unit directions of free motion, as rows, and the names of the amounts to show."""
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
    """Take a handle at a pixel position."""
    return GizmoDrag(handle, frame, pose.copy(), (x, y), (x, y), pose.copy())


def position_along_axis(frame: GizmoFrame, i: int, x: float, y: float) -> float | None:
    """Position of the cursor along axis ``i``, in mesh units from the centre.

    The cursor's ray is cut with the plane through the axis that faces the camera most. None when
    the ray passes that plane by.
    """
    axis = frame.axes[i]
    sight = unit(frame.centre - frame.camera.position)
    point = _on_plane(frame, sight - (sight @ axis) * axis, x, y)
    return None if point is None else float((point - frame.centre) @ axis)


def offset_in_plane(frame: GizmoFrame, normal: np.ndarray, x: float, y: float) -> np.ndarray | None:
    """Offset (3,) from the centre to the cursor's ray in a plane through it."""
    point = _on_plane(frame, normal, x, y)
    return None if point is None else point - frame.centre


def _on_plane(frame: GizmoFrame, normal: np.ndarray, x: float, y: float) -> np.ndarray | None:
    origin, direction = frame.camera.ray(x, y)
    slope = float(direction @ normal)
    if abs(slope) < 1e-3 * float(np.linalg.norm(normal)):
        return None
    t = float((frame.centre - origin) @ normal) / slope
    # Behind the camera, or so far that a pixel would be a leap.
    return origin + t * direction if 0 < t < 50 * frame.camera.distance else None


def cursor_rotation(
    frame: GizmoFrame, i: int, before: tuple[float, float], after: tuple[float, float]
) -> float:
    """Rotation about axis ``i`` by the cursor's motion, in radians.

    Seen from the side a ring is a line: there the way along the line counts.
    """
    axis = frame.axes[i]
    if abs(frame.facing[i]) < EDGE_ON:
        along = _tangent(frame, axis)
        return float((np.array(after) - before) @ along / (along @ along))
    p, q = offset_in_plane(frame, axis, *before), offset_in_plane(frame, axis, *after)
    if p is None or q is None:
        return 0.0
    return float(np.arctan2(np.cross(p, q) @ axis, p @ q))


def _tangent(frame: GizmoFrame, axis: np.ndarray) -> np.ndarray:
    """Motion in pixels (2,), per radian, of the ring's point nearest to the viewer."""
    towards = frame.camera.position - frame.centre
    radial = RING_RADIUS * frame.pixel_length * unit(towards - (towards @ axis) * axis)
    near, ahead = frame.camera.project(frame.centre + np.array([radial, radial + np.cross(axis, radial)]))
    return ahead - near


def snapped(value: float, step: float) -> float:
    """Multiple of ``step`` nearest to ``value``."""
    return round(value / step) * step


def nice_step(length: float) -> float:
    """1, 2 or 5 times a power of ten, nearest to ``length`` on a logarithmic scale."""
    power = 10.0 ** np.floor(np.log10(length))
    steps = power * np.array([1.0, 2.0, 5.0, 10.0])
    return float(steps[np.argmin(np.abs(np.log(steps / length)))])


def translated(pose: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """The (4, 4) pose followed by a translation."""
    return translation(offset) @ pose


def rotated(pose: np.ndarray, centre: np.ndarray, axis: np.ndarray, angle: float) -> np.ndarray:
    """The (4, 4) pose followed by a rotation about the unit axis through ``centre``."""
    return rotation_about(centre, axis, angle) @ pose
