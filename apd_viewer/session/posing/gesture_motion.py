"""The motion of one gesture as a document of its own."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np

from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import have_same_paint
from apd_viewer.session.model.handles_and_regions import IDENTITY, Handle
from apd_viewer.session.model.state import State


def gesture_motion(before: State, document: Document) -> Document | None:
    """The document with the motion of a gesture alone; None if there is none.

    Its base and handles are gripped at the shape before the gesture.

    Parameters
    ----------
    before : State
        At the beginning of the gesture.
    document : Document
        After it.

    Returns
    -------
    Document or None
        None if the gesture moved no handle, or did something else as well: painted, or opened another mesh.
        None too where obstacles have been moved, as these go along their whole way.
    """
    start = before.document
    same = document.mesh is start.mesh and document.grip is start.grip and have_same_paint(start, document)
    if not same or len(document.handles) != len(start.handles):
        return None
    if any(each.shift.any() for each in document.obstacles):
        return None
    pairs = list(zip(start.handles, document.handles, strict=True))
    if not any(has_moved(*pair) for pair in pairs):
        return None
    motion = replace(document, grip=before.frame.U)
    for k, pair in enumerate(pairs):
        motion = motion.with_handle(k, _rest_of_way(*pair))
    return motion


def has_moved(before: Handle, after: Handle) -> bool:
    """True if a handle has another pose, or came there another way."""
    return not np.array_equal(before.pose, after.pose) or len(before.waypoints) != len(after.waypoints)


def _rest_of_way(before: Handle, after: Handle) -> Handle:
    """Handle gripped where it was before, with its way from there to where it is.

    Back to where both ways part, and on from there: what is gone back along is taken off again.
    """
    gripped = replace(before.regripped(), earlier_poses=(), former_twist_axis=None)
    if not has_moved(before, after):
        return gripped
    shared, origin = _shared(before, after), np.linalg.inv(before.pose)
    parting = before.waypoints[shared - 1] if shared else IDENTITY
    for pose in (*reversed(before.waypoints[shared:]), parting, *after.waypoints[shared:], after.pose):
        gripped = gripped.moved_to(pose @ origin)
    return gripped


def _shared(before: Handle, after: Handle) -> int:
    """Number of common first waypoints."""
    pairs = zip(before.waypoints, after.waypoints, strict=False)
    return sum(1 for _ in itertools.takewhile(lambda pair: np.array_equal(*pair), pairs))
