"""Plan of a typed motion: the document on its way and at its end."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.language import tr
from apd_viewer.session.posing.motion_titles import names_of_moved, title_of
from apd_viewer.session.posing.symmetry import moved
from apd_viewer.session.posing.typed_motion import amount_of, pose_after, poses_along, still_to_go

if TYPE_CHECKING:
    from apd_viewer.session.model.document import Document
    from apd_viewer.session.model.motions import TypedMotion
    from apd_viewer.session.model.state import State
    from apd_viewer.session.quantities.units import Unit

_ROUNDING = 1e-9  # of a pose; of the diagonal of the mesh for its translation
_ARC = math.radians(5.0)  # between two documents on the way: arcs drawn through them look round


@dataclass(frozen=True, eq=False)
class MotionPlan:
    """A typed motion of a handle, before it is made.

    Attributes
    ----------
    start : Document
    which : int
        The handle.
    motion : TypedMotion
    amount : float
        Mesh units, radians or a factor; by so much from where the handle is.
    line : (2, 3) float array or None
        What BEND_LINE bends about.
    """

    start: Document
    which: int
    motion: TypedMotion
    amount: float
    line: np.ndarray | None = None

    def at(self, part: float) -> Document:
        """The document at ``part`` of the motion: 0 is the start, 1 the end."""
        amount = part * self.amount
        pose = pose_after(self.start, self.which, self.motion, amount, self.line)
        return moved(self.start, self.which, pose)

    def on_the_way(self) -> list[Document]:
        """The document along a motion of at most a turn, with its end; else the last turn.

        Scaling is no way: there is its end only.
        """
        end = self.end()
        if self.motion.kind == "SCALE":
            return [end]
        last, steps = 1.0, 1
        if self.motion.kind != "MOVE" and self.amount:
            last = min(1.0, 2.0 * math.pi / abs(self.amount))
            steps = math.ceil(last * abs(self.amount) / _ARC)
        return [*(self.at(1.0 - last + last * step / steps) for step in range(steps)), end]

    def end(self) -> Document:
        """The document after the motion; raises InputError if it is impossible."""
        document, pose = self.start, self.start.handles[self.which].pose
        for pose in poses_along(self.start, self.which, self.motion, self.amount, self.line):
            document = moved(document, self.which, pose)
        if self._is_same(document.handles[self.which].pose) and not self._is_same(pose):
            name = self.start.handles[self.which].name
            sentence = tr("“{name}” is its own mirror image and cannot move out of the mirror plane.")
            raise InputError(sentence.format(name=name))
        return document

    def _is_same(self, pose: np.ndarray) -> bool:
        """True if the handle is at a pose (4, 4) before the motion, to rounding."""
        before, size = self.start.handles[self.which].pose, diagonal(self.start.mesh.V)
        away = np.abs(pose - before)
        return bool(away[:, :3].max() <= _ROUNDING and away[:, 3].max() <= _ROUNDING * size)

    def title(self, end: Document, unit: Unit) -> str:
        """Name in the undo history, with the end of the motion."""
        return title_of(self.motion, self.amount, names_of_moved(self.start, end), unit)


def planned(
    state: State,
    which: int,
    motion: TypedMotion,
    text: str,
    unit: Unit,
    line: np.ndarray | None = None,
    to: bool = False,
) -> MotionPlan:
    """Motion by a typed amount, or to that total; raises InputError with a sentence."""
    amount = amount_of(motion, text, state, unit)
    if to:
        amount = still_to_go(state.document, which, motion, amount, line)
    return MotionPlan(state.document, which, motion, amount, line)
