"""Paths of typed motions, all amounts growing evenly together."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.pose.constraints import BASE
from apd_viewer.geometry.pose.screw_motion import RotationPath
from apd_viewer.geometry.pose.waypoint_path import HandlePath
from apd_viewer.language import tr
from apd_viewer.session.model import memo
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.handles_and_regions import IDENTITY
from apd_viewer.session.posing.motion_step import MotionStep
from apd_viewer.session.posing.typed_motion import MOST_TURNS

# Radians between two poses of a path that is written down by its waypoints.
_STEP = math.radians(60.0)


@dataclass(frozen=True, eq=False)
class MotionPath:
    """Path of a handle along typed motions, all at once.

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
        return any(step.word == "scale" for step in self.steps)


def motion_paths(document: Document, steps: Sequence[MotionStep]) -> tuple[HandlePath | MotionPath, ...]:
    """Path of each handle from its grip along a typed motion; raises InputError."""
    if any(abs(step.angle) > MOST_TURNS * 2.0 * math.pi for step in steps):
        raise InputError(tr("Enter at most {most} turns at a time.").format(most=MOST_TURNS))
    document = with_handles_at_grip(document)
    own = [tuple(step for step in steps if step.handle == k) for k in range(len(document.handles))]
    paths = tuple(_path(document, k, mine) for k, mine in enumerate(own))
    for path in paths:
        path.pose_at(1.0)  # what is impossible is said before anything is computed
    return paths


def _path(document: Document, k: int, steps: tuple[MotionStep, ...]) -> HandlePath | MotionPath:
    if len(steps) == 1 and steps[0].word == "twist":
        return _twist_path(document, k, steps[0].amounts[0])
    return MotionPath(document, k, steps)


def _twist_path(document: Document, k: int, amount: float) -> RotationPath:
    """Turn of handle ``k`` about the line from the centre of the base to its own.

    Parameters
    ----------
    document : Document
    k : int
    amount : float
        Radians, of any size.

    Raises
    ------
    InputError
        If there is no such line.
    """
    if not document.label_counts[BASE]:
        raise InputError(tr("There is no base to twist against: paint the part that stays in place as base."))
    base = memo.label_centre(document.labels, document.grip, BASE)
    centre = document.centre(k)
    if centre is None:
        raise InputError(tr("“{name}” is empty; paint it first.").format(name=document.handles[k].name))
    line: np.ndarray = centre - base
    if not line.any():
        raise InputError(
            tr("The centres of the base and the handle coincide, so there is no line to twist about.")
        )
    return RotationPath(base, line, amount)


def total_turn(path: HandlePath | MotionPath) -> float:
    """Sum of the angles of a path whatever their signs, radians: it turns by no more."""
    if isinstance(path, MotionPath):
        return sum(abs(step.angle) for step in path.steps)
    return abs(path.angle)


def with_handles_at_grip(document: Document) -> Document:
    """The document with its handles back at their grips."""
    return replace(document, handles=tuple(handle.with_pose(IDENTITY) for handle in document.handles))


def document_along(
    document: Document, paths: Sequence[HandlePath | MotionPath], share: float = 1.0
) -> Document:
    """The document with its handles moved along their paths, turns of any size kept."""
    document = with_handles_at_grip(document)
    for k, path in enumerate(paths):
        count = max(1, math.ceil(share * total_turn(path) / _STEP))
        for step in range(1, count + 1):
            document = document.with_handle_moved(k, path.pose_at(share * step / count))
    return document
