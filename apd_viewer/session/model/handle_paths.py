"""Handle paths of a document, and intermediate documents along them."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.pose.held_turn import LEAST_TURN, HandleTurns
from apd_viewer.geometry.pose.waypoint_path import HandlePath, handle_path, rounded_pose
from apd_viewer.session.model.document import Document

# Radians per step: the shape follows the turn, and a full turn takes a second on the samples.
_STEP = math.radians(45.0)


class PosePath(Protocol):
    """Handle pose as a function of the fraction of its path."""

    def pose_at(self, fraction: float, /) -> np.ndarray:
        """Pose (4, 4) at ``fraction`` of the path."""


def handle_paths(document: Document) -> tuple[HandlePath, ...]:
    """Path of each handle from its initial position; raises InputError."""
    pivots = [document.pivot(k) for k in range(len(document.handles))]
    return tuple(
        handle_path((), np.eye(4), np.zeros(3))
        if pivot is None
        else handle_path(handle.waypoints, handle.pose, pivot)
        for handle, pivot in zip(document.handles, pivots, strict=True)
    )


def handle_pose_sequences(document: Document) -> tuple[tuple[np.ndarray, ...], ...]:
    """Waypoints and current pose (4, 4) of each handle, from its initial position."""
    return tuple((*handle.waypoints, handle.pose) for handle in document.handles)


def handle_turns(document: Document) -> HandleTurns | None:
    """Handle poses from rest, for measuring turns; None if no turn is large."""
    if not all(np.isfinite(handle.pose).all() for handle in document.handles):
        return None
    document = document.relative_to_rest
    if not any(float(np.linalg.norm(handle.rotation)) >= LEAST_TURN for handle in document.handles):
        return None
    return HandleTurns(document.initial_positions, document.labels, handle_pose_sequences(document))


def document_at(document: Document, paths: Sequence[PosePath], fraction: float) -> Document:
    """Document with handles and obstacles at a fraction of their paths."""
    there = tuple(each.with_shift(fraction * each.shift) for each in document.obstacles)
    document = replace(document, obstacles=there)
    for k, path in enumerate(paths):
        document = document.with_pose(k, path.pose_at(fraction))
    return document


def intermediate_documents(document: Document) -> Iterator[Document]:
    """Documents at steps along paths of half a turn or more, without the end."""
    if not document.has_half_turn:
        return
    paths = handle_paths(document)
    steps = math.ceil(max(path.angle for path in paths) / _STEP)
    for step in range(1, steps):
        stop = document_at(document, paths, step / steps)
        yield _with_rounded_poses(stop, [True] * len(paths))


def with_rounded_poses(document: Document) -> Document:
    """Document with rounded numbers in the poses of handles turned by 180° or more."""
    return _with_rounded_poses(document, [handle.has_half_turn for handle in document.handles])


def _with_rounded_poses(document: Document, which: Sequence[bool]) -> Document:
    size = diagonal(document.mesh.V)
    for k, handle in enumerate(document.handles):
        if which[k]:
            document = document.with_handle(
                k, handle.with_pose(rounded_pose(handle.pose, size), handle.waypoints)
            )
    return document
