"""Operations on a painted part, named without loading their code."""

from __future__ import annotations

from enum import Enum

from apd_viewer.language import tr


class PartOperation(Enum):
    """An operation on a part; its value names the step of undo."""

    GROW = tr("Grow")
    SHRINK = tr("Shrink")
    SMOOTH = tr("Smooth boundary")
    INVERT = tr("Invert")
    CLEAR = tr("Clear")
    MIRROR_X = tr("Mirror along x")
    MIRROR_Y = tr("Mirror along y")
    MIRROR_Z = tr("Mirror along z")
