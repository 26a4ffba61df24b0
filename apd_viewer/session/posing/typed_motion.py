"""Typed motions of a handle: along an axis, about its centre, a twist, a bend."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.pose.constraints import BASE, transform
from apd_viewer.geometry.pose.transforms import bend, rotation_about, scaling_about, translation, twist
from apd_viewer.geometry.pose.waypoint_path import rotation_vector
from apd_viewer.language import tr
from apd_viewer.session.model import memo
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.motion_kind import MotionKind
from apd_viewer.session.model.state import State
from apd_viewer.session.quantities.expressions import parse_angle, parse_length, parse_number
from apd_viewer.session.quantities.units import Unit

MOST_TURNS = 100
_LARGEST_STEP = math.radians(90.0)
_SAMPLE = math.radians(10.0)  # by which the axis of a motion is found
_AXES = {"X": (1.0, 0.0, 0.0), "Y": (0.0, 1.0, 0.0), "Z": (0.0, 0.0, 1.0)}


def named_lengths(state: State) -> dict[str, float]:
    """Lengths of the mesh at rest by name: sides X, Y, Z, longest L, diagonal D."""
    size = state.inspection.size
    sides = dict(zip("XYZ", map(float, size), strict=True))
    return {**sides, "L": float(max(size)), "D": float(np.linalg.norm(size))}


def parse_amount(motion: MotionKind, text: str, state: State, unit: Unit) -> float:
    """Typed length, angle in radians or factor; raises InputError with a sentence."""
    names = named_lengths(state)
    if motion.family == "MOVE":
        return parse_length(text, unit, names)
    return parse_number(text, names) if motion is MotionKind.SCALE else parse_angle(text, names)


def poses_along(
    document: Document, k: int, motion: MotionKind, amount: float, line: np.ndarray | None = None
) -> Iterator[np.ndarray]:
    """Poses (4, 4) on the way of a motion, each from the last by a quarter turn."""
    turns = motion.family not in ("MOVE", "SCALE")
    if turns and abs(amount) > MOST_TURNS * 2.0 * math.pi:
        raise InputError(tr("Enter at most {most} turns at a time.").format(most=MOST_TURNS))
    steps = max(1, math.ceil(abs(amount) / _LARGEST_STEP)) if turns else 1
    for step in range(1, steps + 1):
        yield pose_after(document, k, motion, amount * step / steps, line)


def remaining_amount(
    document: Document, k: int, motion: MotionKind, amount: float, line: np.ndarray | None = None
) -> float:
    """Amount of a motion left to a total from rest.

    The total of a rotation is its part about the axis of the motion.
    """
    document = document.relative_to_rest
    handle, gripped = document.handles[k], document.centre(k)
    if gripped is None:
        return amount
    if motion.family == "MOVE":
        way = transform(handle.pose, gripped[None])[0] - gripped
        return amount - float(way @ _AXES[motion.name[-1]])
    if motion is MotionKind.SCALE:
        return amount / float(np.cbrt(np.linalg.det(handle.pose[:3, :3])))
    made = rotation_vector((), pose_after(document, k, motion, _SAMPLE, line) @ np.linalg.inv(handle.pose))
    return amount - float(handle.rotation @ made) / _SAMPLE


def pose_after(
    document: Document, k: int, motion: MotionKind, amount: float, line: np.ndarray | None = None
) -> np.ndarray:
    """Pose (4, 4) of handle ``k`` after a motion; raises InputError if impossible.

    ``line`` (2, 3) is what BEND_LINE bends about: from its first point to its second.
    """
    gripped = document.pivot(k)
    if gripped is None:
        raise InputError(tr("“{name}” is empty; paint it first.").format(name=document.handles[k].name))
    pose = document.handles[k].pose
    centre = transform(pose, gripped[None])[0]
    kind, letter = motion.family, motion.name[-1]
    if kind == "MOVE":
        by = translation(amount * np.array(_AXES[letter]))
    elif kind == "TURN":
        by = rotation_about(centre, _AXES[letter], amount)
    elif kind == "SCALE":
        by = scaling_about(centre, amount)
    elif motion is MotionKind.BEND_LINE:
        by = _about_line(line, amount)
    else:
        base = _base_centre(document)
        centre = _centre(document, k)
        by = twist(base, centre, amount) if kind == "TWIST" else bend(base, _AXES[letter], amount)
    posed: np.ndarray = by @ pose
    return posed


def _about_line(line: np.ndarray | None, angle: float) -> np.ndarray:
    if line is None:
        raise InputError(tr("There is no line to bend about yet; pick it with two clicks on the mesh."))
    if np.array_equal(line[0], line[1]):
        raise InputError(tr("Both ends of the line coincide; pick two different points."))
    return rotation_about(line[0], line[1] - line[0], angle)


def _centre(document: Document, k: int) -> np.ndarray:
    """Current centre of a handle, (3,)."""
    gripped = document.centre(k)
    assert gripped is not None
    place: np.ndarray = transform(document.handles[k].pose, gripped[None])[0]
    return place


def _base_centre(document: Document) -> np.ndarray:
    if not document.label_counts[BASE]:
        raise InputError(tr("Twisting and bending need a base; paint the part that stays in place."))
    return memo.label_centre(document.labels, document.grip, BASE)
