"""Typed motions with their amounts on a mesh, and their poses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.pose.constraints import BASE, transform
from apd_viewer.geometry.pose.transforms import translation
from apd_viewer.language import tr
from apd_viewer.session.model import memo
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.motion_kind import MotionKind
from apd_viewer.session.posing.motion_text import MotionTextStep
from apd_viewer.session.posing.typed_motion import pose_after
from apd_viewer.session.quantities.expressions import parse_angle, parse_length, parse_number
from apd_viewer.session.quantities.units import Unit

_NAMES = dict.fromkeys("XYZLD", 1.0)


@dataclass(frozen=True)
class MotionStep:
    """A motion of one handle by known amounts.

    Attributes
    ----------
    handle : int
    word : str
    amounts : tuple of float
        Mesh units, radians, or a factor.
    axis : str
    """

    handle: int
    word: str
    amounts: tuple[float, ...]
    axis: str = ""

    @property
    def angle(self) -> float:
        """Angle of its rotation, radians, signed."""
        return self.amounts[0] if self.word in ("twist", "bend", "turn") else 0.0

    def pose_at(self, document: Document, share: float) -> np.ndarray:
        """Pose (4, 4) of the handle after a part of it; raises InputError."""
        k, before = self.handle, document.handles[self.handle].pose
        if self.word == "push":
            return _after(before, share * self.amounts[0] * _to_base(document, k))
        if self.word == "move":
            return _after(before, share * np.array(self.amounts))
        if self.word == "scale":
            return pose_after(document, k, MotionKind.SCALE, self.amounts[0] ** share)
        motion = MotionKind["_".join(filter(None, (self.word.upper(), self.axis)))]
        return pose_after(document, k, motion, share * self.amounts[0])


def _after(pose: np.ndarray, displacement: np.ndarray) -> np.ndarray:
    """The pose (4, 4) shifted by a way (3,)."""
    there: np.ndarray = translation(displacement) @ pose
    return there


def check_amounts(steps: Sequence[MotionTextStep], unit: Unit) -> None:
    """Raise InputError for amounts without meaning on any mesh."""
    for step in steps:
        _amounts(step, unit, _NAMES, 1.0)


def motion_steps(
    document: Document, steps: Sequence[MotionTextStep], names: Mapping[str, float], unit: Unit
) -> tuple[MotionStep, ...]:
    """Steps with their amounts on a mesh.

    Parameters
    ----------
    document : Document
    steps : tuple of MotionTextStep
    names : mapping of str to float
        Lengths that can be named, mesh units.
    unit : Unit
        Of the mesh.

    Raises
    ------
    InputError
        If an amount is none, or there is no such handle.
    """
    document, found = document.relative_to_rest, []
    for step in steps:
        k = step.handle
        if k >= len(document.handles):
            raise InputError(
                tr("There is no handle {number}; the mesh has {count}.").format(
                    number=k + 1, count=len(document.handles)
                )
            )
        whole = float(np.linalg.norm(_line(document, k))) if step.word == "push" else 0.0
        axis = step.axis or (_across(document, k) if step.word == "bend" else "")
        found.append(MotionStep(k, step.word, _amounts(step, unit, names, whole), axis))
    return tuple(found)


def _amounts(step: MotionTextStep, unit: Unit, names: Mapping[str, float], whole: float) -> tuple[float, ...]:
    first = step.amounts[0]
    if step.word == "move":
        return tuple(parse_length(each, unit, names) for each in step.amounts)
    if step.word == "push":
        if first.endswith("%"):
            return (whole * parse_number(first, {}),)
        return (parse_length(first, unit, names),)
    if step.word != "scale":
        return (parse_angle(first, names),)
    factor = parse_number(first, {})
    if not factor > 0.0:
        raise InputError(tr("A factor must be greater than 0; enter another one."))
    return (factor,)


def _line(document: Document, k: int) -> np.ndarray:
    """Vector from the centre of the handle's grip to the base's, (3,)."""
    centre = document.centre(k)
    if centre is None:
        raise InputError(tr("“{name}” is empty; paint it first.").format(name=document.handles[k].name))
    if not document.label_counts[BASE]:
        raise InputError(tr("Twisting and bending need a base; paint the part that stays in place."))
    line: np.ndarray = memo.label_centre(document.labels, document.grip, BASE) - centre
    return line


def _to_base(document: Document, k: int) -> np.ndarray:
    """Unit vector from the current centre of the handle to the base, (3,)."""
    base = memo.label_centre(document.labels, document.grip, BASE)
    centre = document.centre(k)
    assert centre is not None  # as the amount was found
    line = base - transform(document.handles[k].pose, centre[None])[0]
    size = float(np.linalg.norm(line))
    if size == 0.0:
        raise InputError(tr("Base and handle have the same centre, so there is no line to push along."))
    unit: np.ndarray = line / size
    return unit


def _across(document: Document, k: int) -> str:
    """Axis most nearly at right angles to the line to the base."""
    return "XYZ"[int(np.argmin(np.abs(_line(document, k)).round(12)))]
