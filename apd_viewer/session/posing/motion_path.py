"""Motion steps by given amounts, and handle paths along them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.pose.screw_motion import RotationPath
from apd_viewer.geometry.pose.transforms import rigid_transform
from apd_viewer.geometry.pose.waypoint_path import HandlePath, summed_rotations
from apd_viewer.language import comma_separated, tr
from apd_viewer.notation import localized_number
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.handles_and_regions import IDENTITY
from apd_viewer.session.posing.mirror_partner import with_pair_moved
from apd_viewer.session.posing.motion import (
    MOVE,
    SCALE,
    TURN,
    TWIST,
    AmountKind,
    Motion,
    MotionKind,
    MotionReference,
)
from apd_viewer.session.quantities.units import Unit

MOST_TURNS = 100
_QUARTER = math.radians(90.0)  # largest rotation of a single move, so that full turns are kept
_ARC = math.radians(5.0)  # between intermediate documents: arcs drawn through them look smooth
_STEP = math.radians(60.0)  # largest rotation between the stored waypoints of a path
_ROUNDING = 1e-9  # tolerance of a pose; relative to the mesh diagonal for its translation


@dataclass(frozen=True, eq=False)
class MotionStep:
    """Motion of one handle by given amounts.

    Attributes
    ----------
    amounts : tuple of float
        Mesh units, radians, or a factor; by so much from where the handle is.
    line : (2, 3) float array or None
        Axis of a motion about a line.
    """

    handle: int
    motion: Motion
    amounts: tuple[float, ...]
    line: np.ndarray | None = None

    @property
    def angle(self) -> float:
        """Signed rotation angle, radians; 0 without a rotation."""
        return self.amounts[0] if self.motion.kind.amount is AmountKind.ANGLE else 0.0

    def check_turns(self) -> None:
        """Raise InputError for more than ``MOST_TURNS`` turns."""
        if abs(self.angle) > MOST_TURNS * 2.0 * math.pi:
            raise InputError(tr("Enter at most {most} turns at a time.").format(most=MOST_TURNS))

    def pose_at(self, document: Document, fraction: float) -> np.ndarray:
        """Pose (4, 4) of the handle at a fraction; raises InputError."""
        amount = self.motion.kind.amount
        return self._pose(document, [amount.amount_at(each, fraction) for each in self.amounts])

    def _pose(self, document: Document, amounts: Sequence[float]) -> np.ndarray:
        return self.motion.pose_after(MotionReference(document, self.handle, self.line), amounts)

    def documents(self, document: Document, count: int) -> list[Document]:
        """Documents at ``count`` equal steps of the motion; raises InputError."""
        amount = self.motion.kind.amount
        parts = [
            replace(self, amounts=tuple(amount.amount_at(each, n / count) for each in self.amounts))
            for n in range(1, count)
        ]
        return [part.end_document(document) for part in (*parts, self)]

    def intermediate_documents(self, document: Document) -> list[Document]:
        """Documents along the last turn of the motion, including its end.

        A stretch is not divided: only its end follows.
        """
        end = self.end_document(document)
        if self.motion.kind.stretches:
            return [end]
        turn = abs(self.angle)
        last = min(1.0, 2.0 * math.pi / turn) if turn else 1.0
        count = math.ceil(last * turn / _ARC) if turn else 1
        fractions = (1.0 - last + last * n / count for n in range(count))
        there = (
            with_pair_moved(document, self.handle, self.pose_at(document, fraction)) for fraction in fractions
        )
        return [*there, end]

    def end_document(self, document: Document) -> Document:
        """Document after the motion; raises InputError if it is impossible."""
        self.check_turns()
        end, before = document, document.handles[self.handle]
        pose, count = before.pose, max(1, math.ceil(abs(self.angle) / _QUARTER))
        for n in range(1, count + 1):
            pose = self._pose(document, [each * n / count for each in self.amounts])
            end = with_pair_moved(end, self.handle, pose)
        size = diagonal(document.mesh.V)
        if _are_equal_poses(before.pose, end.handles[self.handle].pose, size) and not _are_equal_poses(
            before.pose, pose, size
        ):
            sentence = tr("“{name}” is its own mirror image and cannot move out of the mirror plane.")
            raise InputError(sentence.format(name=before.name))
        return end


def _are_equal_poses(pose: np.ndarray, other: np.ndarray, size: float) -> bool:
    """True if two poses (4, 4) are equal up to rounding."""
    away = np.abs(other - pose)
    return bool(away[:, :3].max() <= _ROUNDING and away[:, 3].max() <= _ROUNDING * size)


@dataclass(frozen=True, eq=False)
class MotionPath:
    """Path of a handle along entered motions, all amounts growing together.

    Attributes
    ----------
    document : Document
        Document with its handles at their initial positions.
    steps : tuple of MotionStep
        Steps of this handle in order; none if it stays.
    """

    document: Document
    handle: int
    steps: tuple[MotionStep, ...]

    def pose_at(self, fraction: float) -> np.ndarray:
        """Pose (4, 4) at ``fraction`` of the path: 0 is rest, 1 the end."""
        document = self.document
        for step in self.steps:
            document = document.with_pose(self.handle, step.pose_at(document, fraction))
        return document.handles[self.handle].pose

    @property
    def angle(self) -> float:
        """Sum of the signed rotation angles, radians."""
        return sum(step.angle for step in self.steps)

    @property
    def has_motion(self) -> bool:
        """True if the path leads away from its start."""
        return not np.array_equal(self.pose_at(1.0), IDENTITY) or any(step.angle for step in self.steps)

    @property
    def has_stretch(self) -> bool:
        """True if a step includes more than rotations and translations."""
        return any(step.motion.kind.stretches for step in self.steps)


def motion_paths(document: Document, steps: Sequence[MotionStep]) -> tuple[HandlePath | MotionPath, ...]:
    """Path of each handle along a typed motion; raises InputError."""
    for step in steps:
        step.check_turns()
    document = _with_handles_unmoved(document)
    own = [tuple(step for step in steps if step.handle == k) for k in range(len(document.handles))]
    return tuple(_path(document, k, mine) for k, mine in enumerate(own))


def _path(document: Document, k: int, steps: tuple[MotionStep, ...]) -> HandlePath | MotionPath:
    path = MotionPath(document, k, steps)
    path.pose_at(1.0)  # raises InputError early for an impossible step
    if [step.motion.kind for step in steps] != [TWIST]:
        return path
    start = MotionReference(document, k)
    return RotationPath(start.base, start.centre - start.base, path.angle)


def total_turn(path: HandlePath | MotionPath) -> float:
    """Sum of a path's absolute angles, radians; an upper bound of its turn."""
    if isinstance(path, MotionPath):
        return sum(abs(step.angle) for step in path.steps)
    return abs(path.angle)


def _with_handles_unmoved(document: Document) -> Document:
    return replace(document, handles=tuple(handle.with_pose(IDENTITY) for handle in document.handles))


def document_along_paths(
    document: Document, paths: Sequence[HandlePath | MotionPath], fraction: float = 1.0
) -> Document:
    """Document with handles moved along their paths, keeping turns of any size."""
    document = _with_handles_unmoved(document)
    for k, path in enumerate(paths):
        count = max(1, math.ceil(fraction * total_turn(path) / _STEP))
        for step in range(1, count + 1):
            document = document.with_handle_moved(k, path.pose_at(fraction * step / count))
    return document


# Relative tolerance for rounding errors of a drag.
_SAME = 1e-9


def motion_title(motion: Motion, amount: float, handles: str, unit: Unit) -> str:
    """Title such as “Twist +60° (Handle 1)”, for radians, a length or a factor."""
    return _title(motion.title, motion.kind.amount.format(amount, unit), handles)


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
        return _title_along(MOVE, by[:3, 3], length, unit, names) or _title(tr("Move"), free, names)
    if np.abs(by[:3, :3] @ by[:3, :3].T - np.eye(3)).max() <= _SAME:
        turn = rigid_transform(by, np.zeros(3) if (pivot := before.pivot(k)) is None else pivot)
        if abs(float(turn.displacement @ turn.axis)) <= _SAME * diagonal(before.mesh.V):
            # Full turns are counted from the waypoints of the handles.
            made = summed_rotations(new.waypoints, new.pose) - summed_rotations(old.waypoints, old.pose)
            full = 2.0 * math.pi * round((float(made @ turn.axis) - turn.angle) / (2.0 * math.pi))
            free = TURN.amount.format(turn.angle + full, unit)
            titled = _title_along(TURN, turn.axis, turn.angle + full, unit, names)
            return titled or _title(tr("Rotate"), free, names)
    return tr("Move handle ({handle})").format(handle=names)


def moved_handle_names(before: Document, after: Document) -> str:
    """Names of the handles with different poses in two documents."""
    pairs = zip(before.handles, after.handles, strict=True)
    return comma_separated(new.name for old, new in pairs if old.pose is not new.pose)


def _title_along(kind: MotionKind, vector: np.ndarray, amount: float, unit: Unit, names: str) -> str:
    """Title of a motion along a vector (3,); empty unless parallel to an axis."""
    largest = int(np.argmax(np.abs(vector)))
    if np.abs(np.delete(vector, largest)).max() > _SAME * abs(vector[largest]):
        return ""
    signed = math.copysign(1.0, vector[largest]) * amount
    return motion_title(Motion(kind, "XYZ"[largest]), signed, names, unit)


def _title(motion: str, amount: str, handles: str) -> str:
    return tr("{motion} {amount} ({handle})").format(
        motion=motion, amount=amount.replace("-", "−"), handle=handles
    )
