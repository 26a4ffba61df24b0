"""Kinds of typed motions of a handle, and their names."""

from __future__ import annotations

from enum import Enum, auto

from apd_viewer.language import tr


class MotionKind(Enum):
    """A way to move a handle by one number, in the order offered."""

    TWIST = auto()
    MOVE_X = auto()
    MOVE_Y = auto()
    MOVE_Z = auto()
    TURN_X = auto()
    TURN_Y = auto()
    TURN_Z = auto()
    BEND_X = auto()
    BEND_Y = auto()
    BEND_Z = auto()
    BEND_LINE = auto()
    SCALE = auto()

    @property
    def family(self) -> str:
        """Name without the axis."""
        return self.name.partition("_")[0]

    @property
    def title(self) -> str:
        """Name in the panel and in the undo history."""
        return _TITLES[self]


_TITLES = {
    MotionKind.MOVE_X: tr("Move along x"),
    MotionKind.MOVE_Y: tr("Move along y"),
    MotionKind.MOVE_Z: tr("Move along z"),
    MotionKind.TURN_X: tr("Rotate about x"),
    MotionKind.TURN_Y: tr("Rotate about y"),
    MotionKind.TURN_Z: tr("Rotate about z"),
    MotionKind.TWIST: tr("Twist"),
    MotionKind.BEND_X: tr("Bend about x"),
    MotionKind.BEND_Y: tr("Bend about y"),
    MotionKind.BEND_Z: tr("Bend about z"),
    MotionKind.BEND_LINE: tr("Bend about a line"),
    MotionKind.SCALE: tr("Scale"),
}
