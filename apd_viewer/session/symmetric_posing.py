"""Symmetric posing: switched on and off, and a handle painted for the other side."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from apd_viewer.geometry.pose.constraints import HANDLE, MOST_HANDLES
from apd_viewer.language import tr
from apd_viewer.session.gestures import Gestures
from apd_viewer.session.handle_editor import HandleEditor
from apd_viewer.session.listener import Listener
from apd_viewer.session.model.document_parts import next_name
from apd_viewer.session.model.handles_and_regions import Handle
from apd_viewer.session.model.painted_part import PaintedPart
from apd_viewer.session.model.state import State
from apd_viewer.session.posing.mirror_partner import mirrored_handle
from apd_viewer.session.selecting.part_operations import PartOperation, members_after
from apd_viewer.session.state_store import StateStore

_MIRRORS = PartOperation.MIRROR_X, PartOperation.MIRROR_Y, PartOperation.MIRROR_Z


class SymmetricPosing:
    """Moves handles together with their mirror images, or each by itself.

    Parameters
    ----------
    store : StateStore
    gestures : Gestures
    handles : HandleEditor
    listener : Listener
    """

    def __init__(
        self, store: StateStore, gestures: Gestures, handles: HandleEditor, listener: Listener
    ) -> None:
        self._store = store
        self._gestures = gestures
        self._handles = handles
        self._listener = listener

    def mirror_along(self, axis: int | None) -> None:
        """Move handles symmetrically along an axis, 0, 1 or 2; None moves each by itself."""
        state = self._gestures.state_without_gesture()
        if axis != state.document.mirror_axis:
            self._gestures.record(tr("Change symmetry"), state)
            self._store.set_document(replace(state.document, mirror_axis=axis))

    def paint_partner(self, k: int) -> None:
        """Paint a handle on the mirror image of handle ``k``, in the mirrored pose."""
        state = self._gestures.state_without_gesture()
        document = state.document.relative_to_rest
        ids = _unpainted_image(state, k)
        if len(document.handles) >= MOST_HANDLES:
            sentence = tr("The limit is {most} handles; remove one first.").format(most=MOST_HANDLES)
            self._listener.failed(sentence)
        elif not len(ids):
            self._listener.failed(
                tr("The other side has no free vertices there; choose another axis or erase paint.")
            )
        else:
            handle = document.handles[k]
            name = next_name(tr("Handle"), [each.name for each in document.handles])
            partner = mirrored_handle(document, handle, Handle(name, falloff=handle.falloff))
            self._gestures.record(tr("Paint mirror handle"), state)
            document = document.with_handle(len(document.handles), partner)
            self._handles.solve_poses(document.with_label(ids, HANDLE + len(document.handles) - 1))


def _unpainted_image(state: State, k: int) -> np.ndarray:
    """Free vertices at the mirror image of handle ``k``."""
    document, part = state.document, PaintedPart(HANDLE + k)
    if document.mirror_axis is None:
        return np.empty(0, dtype=int)
    both = members_after(state, part, _MIRRORS[document.mirror_axis])
    return np.flatnonzero(both & ~part.mask(document))
