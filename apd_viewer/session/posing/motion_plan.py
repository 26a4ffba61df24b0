"""Plan of a typed motion: the document on its way and at its end."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.motion_kind import MotionKind
from apd_viewer.session.model.state import State
from apd_viewer.session.posing.mirror_partner import with_pair_moved
from apd_viewer.session.posing.motion_titles import motion_title, moved_handle_names
from apd_viewer.session.posing.typed_motion import parse_amount, pose_after, poses_along, remaining_amount
from apd_viewer.session.quantities.units import Unit

_ROUNDING = 1e-9  # of a pose; of the diagonal of the mesh for its translation
_ARC = math.radians(5.0)  # between two documents on the way: arcs drawn through them look round


@dataclass(frozen=True, eq=False)
class MotionPlan:
    """A typed motion of a handle, before it is made.

    Attributes
    ----------
    start : Document
    handle : int
        The handle.
    motion : MotionKind
    amount : float
        Mesh units, radians or a factor; by so much from where the handle is.
    line : (2, 3) float array or None
        What BEND_LINE bends about.
    """

    start: Document
    handle: int
    motion: MotionKind
    amount: float
    line: np.ndarray | None = None

    def document_at(self, share: float) -> Document:
        """The document at ``share`` of the motion: 0 is the start, 1 the end."""
        amount = share * self.amount
        pose = pose_after(self.start, self.handle, self.motion, amount, self.line)
        return with_pair_moved(self.start, self.handle, pose)

    def intermediate_documents(self) -> list[Document]:
        """The document along a motion of at most a turn, with its end; else the last turn.

        Scaling is no way: there is its end only.
        """
        end = self.end_document()
        if self.motion.family == "SCALE":
            return [end]
        last, steps = 1.0, 1
        if self.motion.family != "MOVE" and self.amount:
            last = min(1.0, 2.0 * math.pi / abs(self.amount))
            steps = math.ceil(last * abs(self.amount) / _ARC)
        return [*(self.document_at(1.0 - last + last * step / steps) for step in range(steps)), end]

    def end_document(self) -> Document:
        """The document after the motion; raises InputError if it is impossible."""
        document, pose = self.start, self.start.handles[self.handle].pose
        for pose in poses_along(self.start, self.handle, self.motion, self.amount, self.line):
            document = with_pair_moved(document, self.handle, pose)
        if self._is_same(document.handles[self.handle].pose) and not self._is_same(pose):
            name = self.start.handles[self.handle].name
            sentence = tr("“{name}” is its own mirror image and cannot move out of the mirror plane.")
            raise InputError(sentence.format(name=name))
        return document

    def _is_same(self, pose: np.ndarray) -> bool:
        """True if the handle is at a pose (4, 4) before the motion, to rounding."""
        before, size = self.start.handles[self.handle].pose, diagonal(self.start.mesh.V)
        away = np.abs(pose - before)
        return bool(away[:, :3].max() <= _ROUNDING and away[:, 3].max() <= _ROUNDING * size)

    def title(self, end: Document, unit: Unit) -> str:
        """Name in the undo history, with the end of the motion."""
        return motion_title(self.motion, self.amount, moved_handle_names(self.start, end), unit)


def plan_motion(
    state: State,
    k: int,
    motion: MotionKind,
    text: str,
    unit: Unit,
    line: np.ndarray | None = None,
    is_total: bool = False,
) -> MotionPlan:
    """Motion by a typed amount, or to that total; raises InputError with a sentence."""
    amount = parse_amount(motion, text, state, unit)
    if is_total:
        amount = remaining_amount(state.document, k, motion, amount, line)
    return MotionPlan(state.document, k, motion, amount, line)
