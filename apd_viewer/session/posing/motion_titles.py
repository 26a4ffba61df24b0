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
from apd_viewer.session.posing.motion import MOVE, SCALE, TURN, Motion, MotionKind
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
        length = float(np.linalg.norm(by[:3, 3]))
        free = unit.format_length(localized_number(f"{length:.4g}"))
        return _title_along(MOVE, by[:3, 3], length, unit, names) or _titled(tr("Move"), free, names)
    if np.abs(by[:3, :3] @ by[:3, :3].T - np.eye(3)).max() <= _SAME:
        turn = rigid_transform(by, np.zeros(3) if (pivot := before.pivot(k)) is None else pivot)
        if abs(float(turn.displacement @ turn.axis)) <= _SAME * diagonal(before.mesh.V):
            # The handles tell its full turns.
            made = summed_rotations(new.waypoints, new.pose) - summed_rotations(old.waypoints, old.pose)
            full = 2.0 * math.pi * round((float(made @ turn.axis) - turn.angle) / (2.0 * math.pi))
            free = TURN.amount.format(turn.angle + full, unit)
            titled = _title_along(TURN, turn.axis, turn.angle + full, unit, names)
            return titled or _titled(tr("Rotate"), free, names)
    return tr("Move handle ({handle})").format(handle=names)


def moved_handle_names(before: Document, after: Document) -> str:
    """Names of the handles with other poses."""
    pairs = zip(before.handles, after.handles, strict=True)
    return comma_separated(new.name for old, new in pairs if old.pose is not new.pose)


def _title_along(kind: MotionKind, vector: np.ndarray, amount: float, unit: Unit, names: str) -> str:
    """Title of a motion along a vector (3,); empty if that is along no axis."""
    largest = int(np.argmax(np.abs(vector)))
    if np.abs(np.delete(vector, largest)).max() > _SAME * abs(vector[largest]):
        return ""
    signed = math.copysign(1.0, vector[largest]) * amount
    return motion_title(Motion(kind, "XYZ"[largest]), signed, names, unit)


def _titled(motion: str, amount: str, handles: str) -> str:
    return tr("{motion} {amount} ({handle})").format(
        motion=motion, amount=amount.replace("-", "−"), handle=handles
    )
