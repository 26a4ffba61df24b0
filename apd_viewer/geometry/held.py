"""What a caller holds of a mesh, checked, in terms of the vertices of the solve."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.constraints import Soft
from apd_viewer.geometry.mesh import whole_numbers
from apd_viewer.geometry.rest_mesh import RestMesh


def checked_ids(ids: np.ndarray | Sequence[int], n: int, what: str) -> np.ndarray:
    """The ``ids`` as a flat int array; raises InputError unless all are those of ``n`` vertices."""
    ids = whole_numbers(ids, f"The {what} vertices").ravel()
    if len(ids) and (ids.min() < 0 or ids.max() >= n):
        raise InputError(f"A {what} vertex does not exist: ids go from 0 to {n - 1:,}.")
    return ids


def numbers_of(
    handle: np.ndarray | Sequence[np.ndarray] | None, rest: RestMesh, solve_ids: np.ndarray
) -> np.ndarray:
    """For each held vertex of the solve the number of its handle, from 1; 0 is base."""
    if handle is not None and not isinstance(handle, (np.ndarray, Sequence)):
        raise InputError("The handle must be an array of vertex ids, or a list of such arrays.")
    several = handle is not None and len(handle) > 0 and np.ndim(handle[0]) > 0
    handles = () if handle is None else handle if several else (handle,)
    number = np.zeros(len(solve_ids), dtype=np.int64)
    for k, ids in enumerate(handles, start=1):
        ids = np.unique(rest.weld.inverse[checked_ids(ids, len(rest.V), "handle")])
        if not np.isin(ids, solve_ids).all():
            raise InputError("A handle vertex is not held; name the handle's vertices among the held ones.")
        mine = np.searchsorted(solve_ids, ids)
        if (number[mine] > 0).any():
            raise InputError("A vertex belongs to two handles; give it to one of them.")
        number[mine] = k
    return number


def soft_of(soft: Soft, rest: RestMesh, solve_ids: np.ndarray) -> tuple[Soft, np.ndarray]:
    """What is soft of the solve, and which of the given it is; held vertices are not, nor loose pieces."""
    ids, which = np.unique(rest.weld.inverse[soft.ids], return_index=True)
    piece = rest.shape.piece
    free = np.isin(piece[ids], piece[solve_ids]) & ~np.isin(ids, solve_ids)
    return soft.among(which[free])._replace(ids=ids[free]), which[free]
