"""Changing a painted part as a whole: larger, smaller, smoother, inverted, mirrored."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.geometry.selecting import grown, mirrored, shrunk, smoothed
from apd_viewer.language import tr

if TYPE_CHECKING:
    from apd_viewer.session.document import State
    from apd_viewer.session.part import Part

    Reshape = Callable[[State, np.ndarray], np.ndarray]


class Change(Enum):
    """A way to change a part; its value names the step of undo in English."""

    GROW = "Grow"
    SHRINK = "Shrink"
    SMOOTH = "Smooth the border"
    INVERT = "Invert"
    MIRROR_X = "Mirror along x"
    MIRROR_Y = "Mirror along y"
    MIRROR_Z = "Mirror along z"


# A table beside the enum: two words that are one in another language would make one of two members.
CHANGES = {
    Change.GROW: tr("Grow"),
    Change.SHRINK: tr("Shrink"),
    Change.SMOOTH: tr("Smooth the border"),
    Change.INVERT: tr("Invert"),
    Change.MIRROR_X: tr("Mirror along x"),
    Change.MIRROR_Y: tr("Mirror along y"),
    Change.MIRROR_Z: tr("Mirror along z"),
}


def reshaped(state: State, part: Part, change: Change) -> np.ndarray:
    """The vertices that should be in the part after a change, (n,) bool; it takes none from other parts."""
    document, skin = state.document, state.skin
    member = part.of(document)
    wanted = _RESHAPES[change](state, member)
    if len(skin.source):
        wanted = wanted[skin.source]
    codes = part.codes(document)
    return wanted & (member | (codes == part.nothing))


def _mirrored_along(axis: int) -> Reshape:
    def reshape(state: State, member: np.ndarray) -> np.ndarray:
        # At rest: a mesh that is bent has no middle.
        V, named = state.document.mesh.V, state.skin.named
        centre = (V[named].min(axis=0) + V[named].max(axis=0)) / 2
        return member | mirrored(state.skin.start, state.skin.neighbour, V, member, axis, centre)

    return reshape


_RESHAPES: dict[Change, Reshape] = {
    Change.GROW: lambda state, member: grown(state.skin.start, state.skin.neighbour, member),
    Change.SHRINK: lambda state, member: shrunk(state.skin.start, state.skin.neighbour, member),
    Change.SMOOTH: lambda state, member: smoothed(
        state.skin.start, state.skin.neighbour, state.document.mesh.V, member
    ),
    Change.INVERT: lambda _, member: ~member,
    Change.MIRROR_X: _mirrored_along(0),
    Change.MIRROR_Y: _mirrored_along(1),
    Change.MIRROR_Z: _mirrored_along(2),
}
