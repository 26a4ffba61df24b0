"""Steps of motions by known amounts, and the paths of handles along them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.pose.screw_motion import RotationPath
from apd_viewer.geometry.pose.waypoint_path import HandlePath
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.handles_and_regions import IDENTITY
from apd_viewer.session.posing.mirror_partner import with_pair_moved
from apd_viewer.session.posing.motion import TWIST, AmountKind, Motion, MotionReference

MOST_TURNS = 100
_QUARTER = math.radians(90.0)  # between two poses that the window takes
_ARC = math.radians(5.0)  # between two documents on the way: arcs drawn through them look round
_STEP = math.radians(60.0)  # between two poses of a path that is written down by its waypoints
_ROUNDING = 1e-9  # of a pose; of the diagonal of the mesh for its translation


@dataclass(frozen=True, eq=False)
class MotionStep:
    """A motion of one handle by known amounts.

    Attributes
    ----------
    handle : int
    motion : Motion
    amounts : tuple of float
        Mesh units, radians, or a factor; by so much from where the handle is.
    line : (2, 3) float array or None
        What the motion is about, if it is about a line.
    """

    handle: int
    motion: Motion
    amounts: tuple[float, ...]
    line: np.ndarray | None = None

    @property
    def angle(self) -> float:
        """Angle of its rotation, radians, signed."""
        return self.amounts[0] if self.motion.kind.amount is AmountKind.ANGLE else 0.0

    def check_turns(self) -> None:
        """Raise InputError for too many turns."""
        if abs(self.angle) > MOST_TURNS * 2.0 * math.pi:
            raise InputError(tr("Enter at most {most} turns at a time.").format(most=MOST_TURNS))

    def pose_at(self, document: Document, share: float) -> np.ndarray:
        """Pose (4, 4) of the handle after a part of it; raises InputError."""
        amount = self.motion.kind.amount
        return self._pose(document, [amount.at(each, share) for each in self.amounts])

    def _pose(self, document: Document, amounts: Sequence[float]) -> np.ndarray:
        return self.motion.pose_after(MotionReference(document, self.handle, self.line), amounts)

    def intermediate_documents(self, document: Document) -> list[Document]:
        """The document along a motion of at most a turn, with its end; else the last turn.

        A stretch is no way: there is its end only.
        """
        end = self.end_document(document)
        if self.motion.kind.stretches:
            return [end]
        turn = abs(self.angle)
        last = min(1.0, 2.0 * math.pi / turn) if turn else 1.0
        count = math.ceil(last * turn / _ARC) if turn else 1
        shares = (1.0 - last + last * n / count for n in range(count))
        there = (with_pair_moved(document, self.handle, self.pose_at(document, share)) for share in shares)
        return [*there, end]

    def end_document(self, document: Document) -> Document:
        """The document after the motion; raises InputError if it is impossible."""
        self.check_turns()
        end, before = document, document.handles[self.handle]
        pose, count = before.pose, max(1, math.ceil(abs(self.angle) / _QUARTER))
        for n in range(1, count + 1):
            pose = self._pose(document, [each * n / count for each in self.amounts])
            end = with_pair_moved(end, self.handle, pose)
        size = diagonal(document.mesh.V)
        if _are_alike(before.pose, end.handles[self.handle].pose, size) and not _are_alike(
            before.pose, pose, size
        ):
            sentence = tr("“{name}” is its own mirror image and cannot move out of the mirror plane.")
            raise InputError(sentence.format(name=before.name))
        return end


def _are_alike(pose: np.ndarray, other: np.ndarray, size: float) -> bool:
    """True if two poses (4, 4) are the same to rounding."""
    away = np.abs(other - pose)
    return bool(away[:, :3].max() <= _ROUNDING and away[:, 3].max() <= _ROUNDING * size)


@dataclass(frozen=True, eq=False)
class MotionPath:
    """Path of a handle along typed motions, all amounts growing together.

    Attributes
    ----------
    document : Document
        With its handles at their grips.
    handle : int
    steps : tuple of MotionStep
        Of this handle, in their order; none where it stays.
    """

    document: Document
    handle: int
    steps: tuple[MotionStep, ...]

    def pose_at(self, share: float) -> np.ndarray:
        """Pose (4, 4) at ``share`` of the path: 0 is rest, 1 the end."""
        document = self.document
        for step in self.steps:
            document = document.with_pose(self.handle, step.pose_at(document, share))
        return document.handles[self.handle].pose

    @property
    def angle(self) -> float:
        """Sum of the angles, radians."""
        return sum(step.angle for step in self.steps)

    @property
    def has_motion(self) -> bool:
        """True if the path leads away from its start."""
        return not np.array_equal(self.pose_at(1.0), IDENTITY) or any(step.angle for step in self.steps)

    @property
    def has_stretch(self) -> bool:
        """True if there is more than rotations and translations."""
        return any(step.motion.kind.stretches for step in self.steps)


def motion_paths(document: Document, steps: Sequence[MotionStep]) -> tuple[HandlePath | MotionPath, ...]:
    """Path of each handle from its grip along a typed motion; raises InputError."""
    for step in steps:
        step.check_turns()
    document = _at_grip(document)
    own = [tuple(step for step in steps if step.handle == k) for k in range(len(document.handles))]
    return tuple(_path(document, k, mine) for k, mine in enumerate(own))


def _path(document: Document, k: int, steps: tuple[MotionStep, ...]) -> HandlePath | MotionPath:
    path = MotionPath(document, k, steps)
    path.pose_at(1.0)  # what is impossible is said before anything is computed
    if [step.motion.kind for step in steps] != [TWIST]:
        return path
    start = MotionReference(document, k)
    return RotationPath(start.base, start.centre - start.base, path.angle)


def total_turn(path: HandlePath | MotionPath) -> float:
    """Sum of the angles of a path whatever their signs, radians: it turns by no more."""
    if isinstance(path, MotionPath):
        return sum(abs(step.angle) for step in path.steps)
    return abs(path.angle)


def _at_grip(document: Document) -> Document:
    return replace(document, handles=tuple(handle.with_pose(IDENTITY) for handle in document.handles))


def document_along(
    document: Document, paths: Sequence[HandlePath | MotionPath], share: float = 1.0
) -> Document:
    """The document with its handles moved along their paths, turns of any size kept."""
    document = _at_grip(document)
    for k, path in enumerate(paths):
        count = max(1, math.ceil(share * total_turn(path) / _STEP))
        for step in range(1, count + 1):
            document = document.with_handle_moved(k, path.pose_at(share * step / count))
    return document
