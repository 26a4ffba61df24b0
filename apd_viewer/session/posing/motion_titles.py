"""Titles of motions with their amounts, for the undo history."""

from __future__ import annotations

import math

import numpy as np

from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.pose.transforms import rigid_transform
from apd_viewer.geometry.pose.waypoint_path import summed_rotations
from apd_viewer.language import comma_separated, tr
from apd_viewer.notation import localized_number
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.handles_and_regions import Handle
from apd_viewer.session.posing.motion import MOVE, SCALE, TURN, Motion
from apd_viewer.session.quantities.units import Unit

# Relative: what a drag computes in floating point is equal within this.
_SAME = 1e-9


def motion_title(motion: Motion, amount: float, handles: str, unit: Unit) -> str:
    """Title such as “Twist +60° (Handle 1)”; radians, a length or a factor."""
    return _titled(motion.title, motion.kind.amount.format(amount, unit), handles)


def motion_title_between(before: Document, after: Document, k: int, unit: Unit) -> str:
    """Title of the motion of handle ``k`` from one document to another.

    About or along an axis of the mesh it is that of the typed motion. A motion of several kinds has
    no amount.
    """
    old, new, names = before.handles[k], after.handles[k], moved_handle_names(before, after)
    by = new.pose @ np.linalg.inv(old.pose)
    if not np.isfinite(by).all():
        return tr("Move handle ({handle})").format(handle=names)
    factor = float(np.cbrt(np.linalg.det(by[:3, :3])))
    if np.abs(by[:3, :3] - factor * np.eye(3)).max() <= _SAME * abs(factor):
        if abs(factor - 1.0) > _SAME:
            return motion_title(Motion(SCALE), factor, names, unit)
        return _title_of_displacement(by[:3, 3], names, unit)
    if np.abs(by[:3, :3] @ by[:3, :3].T - np.eye(3)).max() <= _SAME:
        turn = rigid_transform(by, np.zeros(3) if (pivot := before.pivot(k)) is None else pivot)
        if abs(float(turn.displacement @ turn.axis)) <= _SAME * diagonal(before.mesh.V):
            return _title_of_turn(turn.axis, turn.angle, (old, new), names, unit)
    return tr("Move handle ({handle})").format(handle=names)


def moved_handle_names(before: Document, after: Document) -> str:
    """Names of the handles with other poses."""
    pairs = zip(before.handles, after.handles, strict=True)
    return comma_separated(new.name for old, new in pairs if old.pose is not new.pose)


def _title_of_displacement(displacement: np.ndarray, names: str, unit: Unit) -> str:
    along = _axis(displacement)
    if along is None:
        length = localized_number(f"{float(np.linalg.norm(displacement)):.4g}")
        return _titled(MOVE.title, unit.format_length(length), names)
    return motion_title(Motion(MOVE, "XYZ"[along]), float(displacement[along]), names, unit)


def _title_of_turn(
    axis: np.ndarray, angle: float, handles: tuple[Handle, Handle], names: str, unit: Unit
) -> str:
    """Title of a rotation; the handles, before and after, tell its full turns."""
    old, new = (summed_rotations(handle.waypoints, handle.pose) for handle in handles)
    angle += 2.0 * math.pi * round((float((new - old) @ axis) - angle) / (2.0 * math.pi))
    along = _axis(axis)
    if along is None:
        return _titled(tr("Rotate"), TURN.amount.format(angle, unit), names)
    return motion_title(Motion(TURN, "XYZ"[along]), math.copysign(1.0, axis[along]) * angle, names, unit)


def _axis(vector: np.ndarray) -> int | None:
    """Number of the axis of the mesh along a vector (3,); None along none."""
    largest = int(np.argmax(np.abs(vector)))
    aside = np.abs(np.delete(vector, largest)).max()
    return largest if aside <= _SAME * abs(vector[largest]) else None


def _titled(motion: str, amount: str, handles: str) -> str:
    return tr("{motion} {amount} ({handle})").format(
        motion=motion, amount=amount.replace("-", "−"), handle=handles
    )
