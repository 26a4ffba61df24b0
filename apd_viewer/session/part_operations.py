"""Changing a painted part as a whole: larger, smaller, smoother, inverted, mirrored."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np

from apd_viewer.geometry.picking.vertex_sets import grown, mirrored, shrunk, smoothed
from apd_viewer.language import tr

if TYPE_CHECKING:
    from apd_viewer.session.model.document import State
    from apd_viewer.session.model.painted_part import Part

Reshape: TypeAlias = "Callable[[State, np.ndarray], np.ndarray]"


class _Way(NamedTuple):
    title: str
    reshape: Reshape


def _mirrored_along(axis: int) -> Reshape:
    def reshape(state: State, member: np.ndarray) -> np.ndarray:
        # At rest: a mesh that is bent has no middle.
        V, named = state.document.mesh.V, state.skin.named
        centre = (V[named].min(axis=0) + V[named].max(axis=0)) / 2
        return member | mirrored(state.skin.start, state.skin.neighbour, V, member, axis, centre)

    return reshape


def _smoothed(state: State, member: np.ndarray) -> np.ndarray:
    return smoothed(state.skin.start, state.skin.neighbour, state.document.mesh.V, member)


class PartOperation(Enum):
    """A way to change a part; its value holds the name of the step of undo, and what it does."""

    GROW = _Way(tr("Grow"), lambda state, member: grown(state.skin.start, state.skin.neighbour, member))
    SHRINK = _Way(tr("Shrink"), lambda state, member: shrunk(state.skin.start, state.skin.neighbour, member))
    SMOOTH = _Way(tr("Smooth boundary"), _smoothed)
    INVERT = _Way(tr("Invert"), lambda _, member: ~member)
    MIRROR_X = _Way(tr("Mirror along x"), _mirrored_along(0))
    MIRROR_Y = _Way(tr("Mirror along y"), _mirrored_along(1))
    MIRROR_Z = _Way(tr("Mirror along z"), _mirrored_along(2))


def reshaped(state: State, part: Part, change: PartOperation) -> np.ndarray:
    """The vertices that should be in the part after a change, (n,) bool; it takes none from other parts."""
    document, skin = state.document, state.skin
    member = part.of(document)
    wanted = change.value.reshape(state, member)
    if len(skin.source):
        wanted = wanted[skin.source]
    codes = part.codes(document)
    return wanted & (member | (codes == part.nothing))
