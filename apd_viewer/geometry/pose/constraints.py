"""Held vertices and their targets, from painted labels and handle poses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.language import tr, trn

# Codes of the survey's .sel files [Botsch & Sorkine 2008], continued for more handles: 3, 4, ...
BASE, FREE, HANDLE = 0, 1, 2
MOST_HANDLES = 8


class SoftConstraints(NamedTuple):
    """Vertices pulled along by springs of their handle; see :mod:`falloff`.

    Attributes
    ----------
    ids : (s,) int array
        Ascending; none of them is held.
    strength : (s,) float array
        From 1 beside the handle to 0 at its falloff.
    density : (s,) float array
        Of the springs: weight per area.
    handle : (s,) int array
        Index of the handle that pulls each, from 0.
    """

    ids: np.ndarray
    strength: np.ndarray
    density: np.ndarray
    handle: np.ndarray

    def subset(self, mask: np.ndarray) -> SoftConstraints:
        """Soft constraints selected by a ``mask`` (s,)."""
        return SoftConstraints(*(each[mask] for each in self))


NO_SOFT_CONSTRAINTS = SoftConstraints(
    np.empty(0, dtype=np.int64), np.empty(0), np.empty(0), np.empty(0, dtype=np.int64)
)


class Constraints(NamedTuple):
    """Held vertices and their target positions.

    Attributes
    ----------
    fixed : (k,) int array
        Base and handle vertices, ascending.
    handles : tuple of int arrays
        Members of ``fixed`` in each handle; a handle without a vertex is left out.
    targets : (k, 3) float array
        Target positions of ``fixed``.
    soft : SoftConstraints
        Vertices pulled along by handles without being held.
    soft_targets : (s, 3) float array
        Target positions of the soft vertices.
    """

    fixed: np.ndarray
    handles: tuple[np.ndarray, ...]
    targets: np.ndarray
    soft: SoftConstraints = NO_SOFT_CONSTRAINTS
    soft_targets: np.ndarray = np.empty((0, 3))


def transform(pose: np.ndarray, X: np.ndarray) -> np.ndarray:
    """Apply the (4, 4) matrix ``pose`` to the points ``X`` (n, 3)."""
    return X @ pose[:3, :3].T + pose[:3, 3]


def constraints(
    labels: np.ndarray,
    start: np.ndarray,
    poses: Sequence[np.ndarray],
    soft: SoftConstraints = NO_SOFT_CONSTRAINTS,
    obstacles: bool = False,
) -> Constraints:
    """Constraints holding the base at ``start``, and the handles at their poses.

    Parameters
    ----------
    labels : (n,) int array of BASE, FREE, and HANDLE + k for the handle number k, from 0
    start : (n, 3) float array
        Positions when the labels were last changed. Measured from there and not from rest, a
        vertex that is painted after a drag stays where it is.
    poses : sequence of (4, 4) float arrays
        Motion of each handle since then.
    soft : SoftConstraints
        Vertices pulled along by the handles.
    obstacles : bool
        Whether there are obstacles to push: base and handles may then be missing.

    Raises
    ------
    InputError
        If there is no base, no handle, nothing free, or a handle without a pose.
    """
    problem = next_paint_sentence(labels, obstacles)
    if problem:
        raise InputError(problem)
    count = int(labels.max()) - HANDLE + 1
    if count > len(poses):
        raise InputError(
            trn(
                "There are {count} handles but one motion; give one for each handle.",
                "There are {count} handles but {n} motions; give one for each handle.",
                len(poses),
            ).format(count=count, n=len(poses))
        )
    fixed = np.flatnonzero(labels != FREE)
    targets = start[fixed].astype(np.float64)
    handles = []
    for k in range(count):
        mine = labels[fixed] == HANDLE + k
        targets[mine] = transform(poses[k], targets[mine])
        if mine.any():
            handles.append(fixed[mine])
    drawn = start[soft.ids].astype(np.float64)
    for k in range(count):
        mine = soft.handle == k
        drawn[mine] = transform(poses[k], drawn[mine])
    return Constraints(fixed, tuple(handles), targets, soft, drawn)


def next_paint_sentence(labels: np.ndarray, obstacles: bool = False) -> str | None:
    """Sentence saying what to paint next; None if handles or obstacles can move."""
    if not obstacles and not (labels == BASE).any():
        return tr("There is no base: paint the part that stays in place as base.")
    if not obstacles and not (labels >= HANDLE).any():
        return tr("There is no handle: paint the part to move as handle.")
    if not (labels == FREE).any():
        return tr("Everything is painted: erase some paint to leave a part free to deform.")
    return None
