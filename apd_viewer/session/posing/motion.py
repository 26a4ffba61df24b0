"""Handle motions: the table of motion kinds.

Words in texts and options, the motions offered in the window, titles, tips and study columns are all derived
from its rows.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.pose.constraints import transform
from apd_viewer.geometry.pose.transforms import rotation_about, scaling_about, shear, translation, twist
from apd_viewer.geometry.pose.waypoint_path import rotation_vector
from apd_viewer.language import tr
from apd_viewer.notation import localized_number
from apd_viewer.session.model.handles_and_regions import IDENTITY
from apd_viewer.session.quantities.expressions import parse_angle, parse_length, parse_number
from apd_viewer.session.quantities.units import Unit

if TYPE_CHECKING:
    from apd_viewer.session.model.document import Document

LINE = "LINE"
AXES = {"X": (1.0, 0.0, 0.0), "Y": (0.0, 1.0, 0.0), "Z": (0.0, 0.0, 1.0)}
_SAMPLE = math.radians(10.0)  # trial rotation for finding the axis of a motion


class MotionReference(NamedTuple):
    """Reference points of a motion; properties raise InputError for missing ones.

    Attributes
    ----------
    line : (2, 3) float array or None
        Axis of a motion about LINE: from its first point to its second.
    """

    document: Document
    handle: int
    line: np.ndarray | None = None

    @property
    def at_rest(self) -> MotionReference:
        """Reference with the handle in its rest pose."""
        document = self.document.relative_to_rest
        return self._replace(document=document.with_pose(self.handle, IDENTITY))

    @property
    def pivot(self) -> np.ndarray:
        """Current pivot of the handle, (3,)."""
        return self._carried_point(self.document.pivot(self.handle))

    @property
    def centre(self) -> np.ndarray:
        """Current centre of the handle, (3,)."""
        return self._carried_point(self.document.centre(self.handle))

    def _carried_point(self, point: np.ndarray | None) -> np.ndarray:
        handle = self.document.handles[self.handle]
        if point is None:
            raise InputError(tr("“{name}” is empty; paint it first.").format(name=handle.name))
        carried: np.ndarray = transform(handle.pose, point[None])[0]
        return carried

    @property
    def base(self) -> np.ndarray:
        """Centre of the base, (3,)."""
        centre = self.document.base_centre
        if centre is None:
            raise InputError(tr("The motion needs a base; paint the part that stays in place."))
        return centre


class AmountKind(Enum):
    """Kind of a motion amount; its value is its name on the command line."""

    ANGLE = "ANGLE"
    LENGTH = "LENGTH"
    LENGTH_OR_PERCENT = "AMOUNT"
    FACTOR = "FACTOR"
    NUMBER = "NUMBER"

    def parse(
        self, text: str, unit: Unit, names: Mapping[str, float], rest: MotionReference | None = None
    ) -> float:
        """Parse an amount into radians, mesh units or a factor; raises InputError.

        Percentages refer to the distance of base and handle at ``rest``; None stands for any mesh.
        """
        match self:
            case AmountKind.ANGLE:
                return parse_angle(text, names)
            case AmountKind.FACTOR | AmountKind.NUMBER:
                return parse_number(text, names)
            case AmountKind.LENGTH_OR_PERCENT if text.strip().endswith("%"):
                distance = float(np.linalg.norm(rest.base - rest.centre)) if rest else 1.0
                return distance * parse_number(text, {})
            case AmountKind.LENGTH | AmountKind.LENGTH_OR_PERCENT:
                return parse_length(text, unit, names)

    def format(self, amount: float, unit: Unit) -> str:
        """Text of an amount with a sign, and of a length with its unit."""
        match self:
            case AmountKind.ANGLE:
                return localized_number(f"{math.degrees(amount):+.4g}°")
            case AmountKind.FACTOR:
                return localized_number(f"×{amount:.4g}")
            case AmountKind.NUMBER:
                return localized_number(f"{amount:+.4g}")
            case AmountKind.LENGTH | AmountKind.LENGTH_OR_PERCENT:
                return unit.format_length(localized_number(f"{amount:+.4g}"))

    @property
    def is_factor(self) -> bool:
        """True if amounts are greater than 0 and grow geometrically."""
        match self:
            case AmountKind.FACTOR:
                return True
            case AmountKind.ANGLE | AmountKind.LENGTH | AmountKind.LENGTH_OR_PERCENT | AmountKind.NUMBER:
                return False

    def amount_at(self, amount: float, fraction: float) -> float:
        """Amount at a fraction of a motion."""
        return float(amount**fraction) if self.is_factor else fraction * amount

    def remaining_amount(self, total: float, motion: Motion, now: MotionReference) -> float:
        """Amount still missing to reach a total measured from rest.

        Totals are the parts of the rotation about, and of the displacement along, the axis of the motion.
        """
        handle, rest = now.document.handles[now.handle], now.at_rest
        match self:
            case AmountKind.ANGLE:
                there = motion.pose_after(now, (_SAMPLE,))
                made = rotation_vector((), there @ np.linalg.inv(handle.pose))
                return total - float(handle.rotation @ made) / _SAMPLE
            case AmountKind.FACTOR:
                return total / float(np.cbrt(np.linalg.det(handle.pose[:3, :3])))
            case AmountKind.NUMBER:
                unit_map = (motion.pose_after(rest, (1.0,)) - IDENTITY)[:3, :3]
                return total - float((unit_map * handle.pose[:3, :3]).sum())
            case AmountKind.LENGTH | AmountKind.LENGTH_OR_PERCENT:
                return total - float((now.centre - rest.centre) @ motion.pose_after(rest, (1.0,))[:3, 3])


@dataclass(frozen=True, eq=False)
class MotionKind:
    """Kind of handle motion, an entry of ``MOTION_KINDS``.

    Attributes
    ----------
    word, title : str
        Name in texts, options and study columns; title in headings.
    matrix : callable
        Function giving the motion (4, 4) of a handle for an axis and one amount, or one along each axis.
    tip, example, help : str
        Of an amount in the window, and of the option, with ``%`` doubled.
    axis_titles : mapping of str to str
        Titles of its motions by axis, if it has axes.
    preposition : str
        Before the axis in a text; empty if a text has no axis.
    may_omit_axis : bool
        The axis most nearly perpendicular to the line to the base is the default.
    has_all_axes : bool
        Whether its text has an amount along each axis.
    stretches : bool
        Whether it is more than rotations and translations.
    study : tuple of str, optional
        Note and ends of the range, where the window offers to vary it.
    """

    word: str
    title: str
    amount: AmountKind
    matrix: Callable[[MotionReference, str, Sequence[float]], np.ndarray]
    tip: str
    example: str
    help: str
    axis_titles: Mapping[str, str] = field(default_factory=dict)
    preposition: str = ""
    may_omit_axis: bool = False
    has_all_axes: bool = False
    stretches: bool = False
    study: tuple[str, str, str] | None = None

    @property
    def needs_axis(self) -> bool:
        """True if the text of the motion must name an axis."""
        return bool(self.preposition) and not self.may_omit_axis

    @property
    def takes_single_amount(self) -> bool:
        """True if the amount alone is a complete motion text."""
        return not (self.needs_axis or self.has_all_axes)


@dataclass(frozen=True)
class Motion:
    """Kind of motion with its axis: "X", "Y", "Z", LINE, or empty."""

    kind: MotionKind
    axis: str = ""

    @property
    def name(self) -> str:
        """Name such as "TWIST" or "MOVE_X"."""
        return "_".join(filter(None, (self.kind.word.upper(), self.axis)))

    @property
    def title(self) -> str:
        """Title in the panel and in the undo history."""
        return self.kind.axis_titles[self.axis] if self.axis else self.kind.title

    def pose_after(self, now: MotionReference, amounts: Sequence[float]) -> np.ndarray:
        """Pose (4, 4) of the handle after the motion; raises InputError if impossible."""
        _ = now.pivot  # raises InputError for an empty handle
        posed: np.ndarray = self.kind.matrix(now, self.axis, amounts) @ now.document.handles[now.handle].pose
        return posed


def _push_pose(at: MotionReference, _axis: str, amounts: Sequence[float]) -> np.ndarray:
    way = at.base - at.centre
    if not way.any():
        raise InputError(tr("Base and handle have the same centre, so there is no line to push along."))
    return translation(amounts[0] * (way / np.linalg.norm(way)))


def _bend_pose(at: MotionReference, axis: str, amounts: Sequence[float]) -> np.ndarray:
    if axis != LINE:
        return rotation_about(at.base, AXES[axis], amounts[0])
    if at.line is None:
        raise InputError(tr("There is no line to bend about yet; pick it with two clicks on the mesh."))
    if np.array_equal(at.line[0], at.line[1]):
        raise InputError(tr("Both ends of the line coincide; pick two different points."))
    return rotation_about(at.line[0], at.line[1] - at.line[0], amounts[0])


TWIST = MotionKind(
    word="twist",
    title=tr("Twist"),
    amount=AmountKind.ANGLE,
    matrix=lambda at, _, amounts: twist(at.base, at.centre, amounts[0]),
    tip=tr("About the line through the centres of base and handle: an angle such as 60deg"),
    example="60deg",
    help=tr("twist about the line through the centres of base and handle, such as 180deg"),
    study=(tr("about the line to the base"), "0deg", "180deg"),
)
PUSH = MotionKind(
    word="push",
    title=tr("Push"),
    amount=AmountKind.LENGTH_OR_PERCENT,
    matrix=_push_pose,
    tip=tr("Towards the base: a length, or a fraction of its distance such as 30%"),
    example="30%",
    help=tr("push towards the base: a length, or a fraction such as 30%% of the distance to it"),
    study=(tr("towards the base, in % or a length"), "0%", "40%"),
)
MOVE = MotionKind(
    word="move",
    title=tr("Move"),
    axis_titles={"X": tr("Move along x"), "Y": tr("Move along y"), "Z": tr("Move along z")},
    amount=AmountKind.LENGTH,
    matrix=lambda _, axis, amounts: translation(np.multiply(amounts, AXES[axis] if axis else 1.0)),
    tip=tr("Along an axis: a length such as 12, 0.15L or 5mm; L is the longest side of the mesh"),
    example="0.15L",
    help=tr("move along the axes, such as “0 2cm 0”"),
    has_all_axes=True,
)
TURN = MotionKind(
    word="turn",
    title=tr("Turn"),
    axis_titles={"X": tr("Rotate about x"), "Y": tr("Rotate about y"), "Z": tr("Rotate about z")},
    amount=AmountKind.ANGLE,
    matrix=lambda at, axis, amounts: rotation_about(at.pivot, AXES[axis], amounts[0]),
    tip=tr("About an axis through the centre of the handle: an angle such as 60deg or 1/6 turn"),
    example="60deg",
    help=tr("turn about an axis through the handle's centre, such as “30deg about x”"),
    preposition="about",
)
BEND = MotionKind(
    word="bend",
    title=tr("Bend"),
    axis_titles={
        "X": tr("Bend about x"),
        "Y": tr("Bend about y"),
        "Z": tr("Bend about z"),
        LINE: tr("Bend about a line"),
    },
    amount=AmountKind.ANGLE,
    matrix=_bend_pose,
    tip=tr("About an axis through the centre of the base: an angle such as 30deg"),
    example="60deg",
    help=tr("bend about an axis through the centre of the base; “20deg about x” names the axis"),
    preposition="about",
    may_omit_axis=True,
    study=(tr("about an axis through the base"), "0deg", "90deg"),
)
SCALE = MotionKind(
    word="scale",
    title=tr("Scale"),
    amount=AmountKind.FACTOR,
    matrix=lambda at, _, amounts: scaling_about(at.pivot, amounts[0]),
    tip=tr("About the centre of the handle: a factor such as 1.2 or 80%"),
    example="1.2",
    help=tr("scale about the handle's centre"),
    stretches=True,
)
SHEAR = MotionKind(
    word="shear",
    title=tr("Shear"),
    amount=AmountKind.NUMBER,
    matrix=lambda at, axis, amounts: shear(at.base, at.centre, AXES[axis], amounts[0]),
    tip=tr("Along an axis, in proportion to the height over the base: a number such as 0.3"),
    example="0.3",
    help=tr("shear along an axis, in proportion to the height over the base, such as “0.3 along x”"),
    axis_titles={"X": tr("Shear along x"), "Y": tr("Shear along y"), "Z": tr("Shear along z")},
    preposition="along",
    stretches=True,
)
MOTION_KINDS = {kind.word: kind for kind in (TWIST, PUSH, MOVE, TURN, BEND, SCALE, SHEAR)}
# Motions in their order in the window.
MOTIONS = {
    motion.name: motion
    for kind in MOTION_KINDS.values()
    for motion in (Motion(kind, axis) for axis in kind.axis_titles or ("",))
}
