"""Kinds of typed motions of a handle, and their names."""

from __future__ import annotations

from enum import Enum, auto

from apd_viewer.language import tr


class TypedMotion(Enum):
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
    def kind(self) -> str:
        """Name without the axis."""
        return self.name.partition("_")[0]

    @property
    def title(self) -> str:
        """Name in the panel and in the undo history."""
        return _TITLES[self]


_TITLES = {
    TypedMotion.MOVE_X: tr("Move along x"),
    TypedMotion.MOVE_Y: tr("Move along y"),
    TypedMotion.MOVE_Z: tr("Move along z"),
    TypedMotion.TURN_X: tr("Rotate about x"),
    TypedMotion.TURN_Y: tr("Rotate about y"),
    TypedMotion.TURN_Z: tr("Rotate about z"),
    TypedMotion.TWIST: tr("Twist"),
    TypedMotion.BEND_X: tr("Bend about x"),
    TypedMotion.BEND_Y: tr("Bend about y"),
    TypedMotion.BEND_Z: tr("Bend about z"),
    TypedMotion.BEND_LINE: tr("Bend about a line"),
    TypedMotion.SCALE: tr("Scale"),
}
