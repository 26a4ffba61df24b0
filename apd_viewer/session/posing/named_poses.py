"""Named poses: stored handle poses relative to the rest shape.

They are relative to the rest shape, since initial positions change with every stroke and every reset.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from apd_viewer.geometry.mesh.arrays import diagonal, frozen
from apd_viewer.geometry.pose.constraints import HANDLE
from apd_viewer.geometry.pose.transforms import fitted_motion
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.handles_and_regions import IDENTITY, Handle, HandlePlacement, NamedPose
from apd_viewer.session.model.memo import memoised

# Tolerance of matrices and angles in radians; relative to the mesh diagonal for translations.
_SAME = 1e-7


@memoised
def _motion_to_initial_positions(
    V: np.ndarray, initial: np.ndarray, labels: np.ndarray, label: int
) -> np.ndarray:
    """Motion (4, 4) from rest to the initial positions of the vertices with a label."""
    mine = labels == label
    if initial is V or np.array_equal(V[mine], initial[mine]):
        return IDENTITY
    return frozen(fitted_motion(V[mine], initial[mine]))


_size = memoised(diagonal)


def _handle_with_earlier_motion(document: Document, k: int) -> Handle:
    """Handle ``k`` with its motion before its initial pose, estimated if not recorded."""
    handle = document.handles[k]
    if not handle.earlier_poses:
        arrays = document.mesh.V, document.initial_positions, document.labels
        motion = _motion_to_initial_positions(*arrays, HANDLE + k)
        handle = replace(handle, earlier_poses=() if motion is IDENTITY else (motion,))
    return handle


def handle_placements(document: Document) -> tuple[HandlePlacement, ...]:
    """Current placements of all handles with vertices."""
    found = [
        _handle_with_earlier_motion(document, k).relative_to_rest
        for k in range(len(document.handles))
        if document.label_counts[HANDLE + k]
    ]
    return tuple(HandlePlacement(handle.name, handle.pose, handle.waypoints) for handle in found)


def _placed_handles(document: Document, pose: NamedPose) -> Iterator[tuple[int, Handle]]:
    """Numbers of the handles in a named pose, and the handles placed as in it."""
    numbers = {
        handle.name: k for k, handle in enumerate(document.handles) if document.label_counts[HANDLE + k]
    }
    for placement in pose.placements:
        k = numbers.get(placement.handle)
        if k is not None:
            handle = _handle_with_earlier_motion(document, k)
            there = handle.with_pose_from_rest(placement.pose, placement.waypoints)
            yield k, document.handles[k].with_pose(there.pose, there.waypoints)


def with_named_pose(document: Document, pose: NamedPose) -> Document:
    """Document with its handles in a named pose; other handles are unchanged."""
    for k, handle in _placed_handles(document, pose):
        document = document.with_handle(k, handle)
    return document


def missing_handles(document: Document, pose: NamedPose) -> list[str]:
    """Names of the handles in a named pose missing from the document."""
    found = {document.handles[k].name for k, _ in _placed_handles(document, pose)}
    return [placement.handle for placement in pose.placements if placement.handle not in found]


def is_in_pose(document: Document, pose: NamedPose) -> bool:
    """True if all existing handles of a named pose are in it."""
    size, there = _size(document.mesh.V), list(_placed_handles(document, pose))
    return bool(there) and all(_are_equal_poses(document.handles[k], handle, size) for k, handle in there)


def _are_equal_poses(one: Handle, other: Handle, size: float) -> bool:
    apart = np.abs(one.pose - other.pose)
    if max(apart[:, :3].max(), apart[:, 3].max() / size) > _SAME:
        return False
    return bool(np.abs(one.rotation - other.rotation).max() <= _SAME)


def with_handle_renamed(document: Document, before: str, after: str) -> Document:
    """Document with a handle renamed in its named poses."""
    poses = tuple(
        replace(
            pose,
            placements=tuple(
                each._replace(handle=after) if each.handle == before else each for each in pose.placements
            ),
        )
        for pose in document.poses
    )
    return replace(document, poses=poses)


def rebased_poses(document: Document) -> tuple[NamedPose, ...]:
    """Named poses relative to the current handle poses as the new rest."""
    present = {each.handle: each for each in handle_placements(document)}
    return tuple(
        replace(
            pose,
            placements=tuple(
                _rebased_placement(each, present[each.handle]) if each.handle in present else each
                for each in pose.placements
            ),
        )
        for pose in document.poses
    )


def _rebased_placement(placement: HandlePlacement, present: HandlePlacement) -> HandlePlacement:
    """Placement relative to ``present``: back along its path, then to the placement."""
    handle = Handle(placement.handle, earlier_poses=(*present.waypoints, present.pose))
    there = handle.with_pose_from_rest(placement.pose, placement.waypoints)
    return HandlePlacement(there.name, there.pose, there.waypoints)
