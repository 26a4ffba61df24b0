"""Operations on a painted part: grow, shrink, smooth, invert, mirror, clear."""

from collections.abc import Callable
from enum import Enum
from typing import TypeAlias

import numpy as np

from apd_viewer.geometry.picking.vertex_sets import grown_set, mirrored_set, shrunk_set, smoothed_set
from apd_viewer.language import tr
from apd_viewer.session.model.document_parts import PaintedPart
from apd_viewer.session.model.state import State
from apd_viewer.session.posing.mirror_partner import mirror_plane


class PartOperation(Enum):
    """Operation on a part; its value is the name of the undo step."""

    GROW = tr("Grow")
    SHRINK = tr("Shrink")
    SMOOTH = tr("Smooth boundary")
    INVERT = tr("Invert")
    CLEAR = tr("Clear")
    MIRROR_X = tr("Mirror along x")
    MIRROR_Y = tr("Mirror along y")
    MIRROR_Z = tr("Mirror along z")


MemberOperation: TypeAlias = "Callable[[State, np.ndarray], np.ndarray]"


def _mirror_along(axis: int) -> MemberOperation:
    def reshape(state: State, member: np.ndarray) -> np.ndarray:
        mesh, skin = state.document.mesh, state.surface_index
        return member | mirrored_set(skin.start, skin.neighbour, mesh.V, member, mirror_plane(mesh, axis))

    return reshape


def _smooth_boundary(state: State, member: np.ndarray) -> np.ndarray:
    return smoothed_set(
        state.surface_index.start, state.surface_index.neighbour, state.document.mesh.V, member
    )


_OPERATIONS: dict[PartOperation, MemberOperation] = {
    PartOperation.GROW: lambda state, member: grown_set(
        state.surface_index.start, state.surface_index.neighbour, member
    ),
    PartOperation.SHRINK: lambda state, member: shrunk_set(
        state.surface_index.start, state.surface_index.neighbour, member
    ),
    PartOperation.SMOOTH: _smooth_boundary,
    PartOperation.INVERT: lambda _, member: ~member,
    PartOperation.CLEAR: lambda _, member: np.zeros_like(member),
    PartOperation.MIRROR_X: _mirror_along(0),
    PartOperation.MIRROR_Y: _mirror_along(1),
    PartOperation.MIRROR_Z: _mirror_along(2),
}


def members_after(state: State, part: PaintedPart, operation: PartOperation) -> np.ndarray:
    """Members (n,) bool of a part after an operation, without those of other parts."""
    document, skin = state.document, state.surface_index
    member = part.mask(document)
    wanted = _OPERATIONS[operation](state, member)
    if len(skin.source):
        wanted = wanted[skin.source]
    codes = part.codes(document)
    return wanted & (member | (codes == part.unpainted_code))
