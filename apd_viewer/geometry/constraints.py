"""From painted labels and a handle pose to held vertices and where they are held."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError

# The codes of the survey's .sel files [Botsch & Sorkine 2008].
BASE, FREE, HANDLE = 0, 1, 2


class Constraints(NamedTuple):
    """Held vertices and their positions.

    Attributes
    ----------
    fixed : (k,) int array
        Base and handle vertices, ascending.
    handle : (h,) int array
        Those of ``fixed`` that belong to the handle.
    targets : (k, 3) float array
        Where each of ``fixed`` is held.
    """

    fixed: np.ndarray
    handle: np.ndarray
    targets: np.ndarray


def transform(pose: np.ndarray, X: np.ndarray) -> np.ndarray:
    """Apply the (4, 4) matrix ``pose`` to the points ``X`` (n, 3)."""
    return X @ pose[:3, :3].T + pose[:3, 3]


def constraints(labels: np.ndarray, grip: np.ndarray, pose: np.ndarray) -> Constraints:
    """Hold the base at ``grip`` and the handle at ``pose`` applied to ``grip``.

    Parameters
    ----------
    labels : (n,) int array of BASE, FREE and HANDLE
    grip : (n, 3) float array
        Positions when the labels were last changed. Measured from there and not from rest, a
        vertex that is painted after a drag stays where it is.
    pose : (4, 4) float array
        Motion of the handle since then.

    Raises
    ------
    InputError
        If there is no base, no handle or nothing free.
    """
    problem = what_is_missing(labels)
    if problem:
        raise InputError(problem)
    fixed = np.flatnonzero(labels != FREE)
    is_handle = labels[fixed] == HANDLE
    targets = grip[fixed].astype(np.float64)
    targets[is_handle] = transform(pose, targets[is_handle])
    return Constraints(fixed, fixed[is_handle], targets)


def what_is_missing(labels: np.ndarray) -> str | None:
    """What must be painted before the handle can move, as a sentence; None if nothing."""
    if not (labels == BASE).any():
        return "There is no base: paint the part that stays in place as base."
    if not (labels == HANDLE).any():
        return "There is no handle: paint the part to be moved as handle."
    if not (labels == FREE).any():
        return "Everything is painted: erase some paint, so that a part is free to deform."
    return None
