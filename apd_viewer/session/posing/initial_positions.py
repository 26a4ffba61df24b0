"""Handle motions that start from the displayed shape."""

import itertools
from dataclasses import replace

import numpy as np

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.pose.constraints import HANDLE, transform
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.pose.transforms import fitted_motion
from apd_viewer.geometry.pose.waypoint_path import rotation_vector
from apd_viewer.session.model import memo
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import have_same_paint
from apd_viewer.session.model.handles_and_regions import IDENTITY, Handle
from apd_viewer.session.model.state import State


def document_with_restarted_motions(before: Document, document: Document, frame: Frame) -> Document:
    """Document with the shape of a frame as its initial positions.

    A handle keeps its motion from rest as long as it keeps one of its earlier vertices.

    Parameters
    ----------
    before : Document
        Document before its paint was changed.
    """
    numbers = {handle.name: k for k, handle in enumerate(before.handles)}
    handles = []
    for label, handle in enumerate(document.handles, HANDLE):
        j = numbers.get(handle.name)
        kept = np.empty(0, dtype=int)
        if j is not None:
            kept = np.flatnonzero((before.labels == HANDLE + j) & (document.labels == label))
        if j is None or not len(kept):
            handles.append(replace(handle.with_restarted_motion(), earlier_poses=(), former_twist_axis=None))
            continue
        there = reached_handle(before, j, frame, kept).with_restarted_motion()
        pivot = None if handle.pivot is None else there.pivot
        axis = (
            _base_to_handle(before, j)
            if there.former_twist_axis is None and there.earlier_poses
            else there.former_twist_axis
        )
        handles.append(
            replace(
                handle.with_pose(IDENTITY),
                earlier_poses=there.earlier_poses,
                pivot=pivot,
                former_twist_axis=axis,
            )
        )
    return replace(document, initial_positions=frame.U, handles=tuple(handles))


def _base_to_handle(document: Document, k: int) -> np.ndarray | None:
    """Vector from the base to handle ``k``, (3,); None without a base."""
    centre, base = document.centre(k), document.base_centre
    if centre is None or base is None:
        return None
    return frozen(transform(document.handles[k].pose, centre[None])[0] - base)


def reached_handle(document: Document, k: int, frame: Frame, ids: np.ndarray | None = None) -> Handle:
    """Handle ``k`` at the pose reached by the shape of a frame.

    Parameters
    ----------
    ids : (m,) int array, optional
        Vertices of the handle used for the fit, at least one; all by default.
    """
    handle = document.handles[k]
    ids = np.flatnonzero(document.labels == HANDLE + k) if ids is None else ids
    X, Y = document.initial_positions[ids], frame.U[ids]
    away = np.abs(transform(handle.pose, X) - Y).max(initial=0.0)
    if away <= memo.in_place_tolerance(document.mesh.V, document.mesh.weld):
        return handle
    pose = fitted_motion(X, Y)
    paths = [handle.waypoints[:count] for count in range(len(handle.waypoints) + 1)]
    # A pose does not include full turns; the fraction of the path determines them.
    wanted = frame.share_reached * handle.rotation
    nearest = min(paths, key=lambda path: float(np.linalg.norm(rotation_vector(path, pose) - wanted)))
    return handle.with_pose(pose, nearest)


def gesture_motion(before: State, document: Document) -> Document | None:
    """Document with the motion of a gesture alone; None if there is none.

    Its initial positions are the shape before the gesture.

    Parameters
    ----------
    before : State
        State at the start of the gesture.
    document : Document
        After it.

    Returns
    -------
    Document or None
        None if the gesture moved no handle, or did something else as well: painted, or opened another mesh.
        Also None if obstacles have been moved, since these always follow their whole path.
    """
    start = before.document
    same = (
        document.mesh is start.mesh
        and document.initial_positions is start.initial_positions
        and have_same_paint(start, document)
    )
    if not same or len(document.handles) != len(start.handles):
        return None
    if any(each.shift.any() for each in document.obstacles):
        return None
    pairs = list(zip(start.handles, document.handles, strict=True))
    if not any(has_moved(*pair) for pair in pairs):
        return None
    motion = replace(document, initial_positions=before.frame.U)
    for k, pair in enumerate(pairs):
        motion = motion.with_handle(k, _remaining_motion(*pair))
    return motion


def has_moved(before: Handle, after: Handle) -> bool:
    """True if a handle has a different pose or number of waypoints."""
    return not np.array_equal(before.pose, after.pose) or len(before.waypoints) != len(after.waypoints)


def _remaining_motion(before: Handle, after: Handle) -> Handle:
    """Handle starting at its previous pose, with the path from there to its new one.

    The path first returns to the last common waypoint, which removes the waypoints retraced.
    """
    moved = replace(before.with_restarted_motion(), earlier_poses=(), former_twist_axis=None)
    if not has_moved(before, after):
        return moved
    shared, origin = _common_count(before, after), np.linalg.inv(before.pose)
    parting = before.waypoints[shared - 1] if shared else IDENTITY
    for pose in (*reversed(before.waypoints[shared:]), parting, *after.waypoints[shared:], after.pose):
        moved = moved.moved_to(pose @ origin)
    return moved


def _common_count(before: Handle, after: Handle) -> int:
    """Number of common leading waypoints."""
    pairs = zip(before.waypoints, after.waypoints, strict=False)
    return sum(1 for _ in itertools.takewhile(lambda pair: np.array_equal(*pair), pairs))
