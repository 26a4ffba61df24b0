"""Search for near pairs between pairs of patches."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import prange

from apd_viewer.geometry.contact.distances import edge_edge, vertex_triangle
from apd_viewer.geometry.contact.near_boxes import box_distance, boxes_within
from apd_viewer.geometry.contact.patches import Patches
from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.threads import parallel

# Fixed for any number of cores, so that pairs are always listed and summed in the same order.
_TASKS = 32
_FIRST_CAPACITY = 5_000  # pairs per task
# Range limit as a fraction of a pair's rest distance, so that neighbours exert no force in the rest shape.
OF_REST = 0.25
# Pairs with a smaller rest distance, in mesh sizes, already touch and cannot be kept apart.
_TOUCHES = 1e-9


class FoundPairs(NamedTuple):
    """Near pairs found by a search.

    Attributes
    ----------
    pairs : (p, 4) int array
    is_edge_pair : (p,) bool array
        True for pairs of two edges.
    owner : (p,) int array
        Row among the pairs of patches that were searched.
    gap : (p,) float array
    reach : (p,) float array
        Range of the energy; 0 of a pair that touches at rest.
    """

    pairs: np.ndarray
    is_edge_pair: np.ndarray
    owner: np.ndarray
    gap: np.ndarray
    reach: np.ndarray

    def subset(self, mask: np.ndarray) -> FoundPairs:
        """Rows selected by a mask."""
        return FoundPairs(*(column[mask] for column in self))


class PairSearch:
    """Search for near pairs, vertex and triangle or edge and edge.

    Parameters
    ----------
    V : (n, 3) float array
        Rest positions.
    F : (m, 3) int array
    E : (e, 2) int array
    patches : Patches
    exempt_groups : (z, n) int array
        Groups that vertices belong to, 0 for none, in each row: a pair all of whose vertices are in one
        group is left out. Numbers below 0 are of what a group leaves out besides, but not by itself.
    reach : float
        Range of the gap energy, mesh units.
    """

    def __init__(
        self,
        V: np.ndarray,
        F: np.ndarray,
        E: np.ndarray,
        patches: Patches,
        exempt_groups: np.ndarray,
        reach: float,
    ) -> None:
        self._V, self._F, self._E, self._patches = V, F, E, patches
        self._together, self._reach = exempt_groups, reach
        self._touches = _TOUCHES * float(np.ptp(V, axis=0).max())
        self._capacity = _FIRST_CAPACITY

    def near_pairs(
        self, U: np.ndarray, patch_pairs: np.ndarray, margins: np.ndarray
    ) -> tuple[FoundPairs, np.ndarray]:
        """Near element pairs of patch pairs (k, 2), and bounds (k,) for the other pairs.

        The gaps of near pairs exceed their range by less than ``margins`` (k,). The bounds are lower bounds
        of the excess of all other gaps over their range.
        """
        patches, vertices = self._patches, np.arange(len(U))[:, None]
        most = 1 + max(
            int(np.diff(each.start).max()) for each in (patches.vertices, patches.edges, patches.faces)
        )
        while True:
            *found, bound, count = _find_pairs(
                self._V, U, patch_pairs, self._reach, self._touches, margins, *patches.covered_vertices,
                *patches.vertices, vertices, *patches.edges, self._E, *patches.faces, self._F,
                self._together, most, self._capacity, _TASKS,
            )  # fmt: skip
            if count.max(initial=0) <= self._capacity:
                break
            self._capacity = int(1.5 * count.max())
        columns = (np.concatenate([part[k, : count[k]] for k in range(_TASKS)]) for part in found)
        return FoundPairs(*columns), bound


@njit(cache=True, nogil=True)
def _write_box(U: np.ndarray, start: np.ndarray, item: np.ndarray, p: int, box: np.ndarray) -> None:
    """Write the bounding box of the vertices of a patch."""
    for c in range(3):
        low, high = np.inf, -np.inf
        for e in range(start[p], start[p + 1]):
            x = U[item[e], c]
            low, high = min(low, x), max(high, x)
        box[0, c], box[0, c + 3] = low, high


@njit(cache=True, nogil=True)
def _gather(
    U: np.ndarray, start: np.ndarray, item: np.ndarray, S: np.ndarray, p: int, other: np.ndarray, r: float,
    ids: np.ndarray, boxes: np.ndarray,
) -> int:  # fmt: skip
    """Write simplices of a patch within ``r`` of a box, and their boxes; count them."""
    n = 0
    for e in range(start[p], start[p + 1]):
        f = item[e]
        for c in range(3):
            low = high = U[S[f, 0], c]
            for j in range(1, S.shape[1]):
                x = U[S[f, j], c]
                low, high = min(low, x), max(high, x)
            boxes[n, c], boxes[n, c + 3] = low, high
        if boxes_within(boxes, n, other, 0, r):
            ids[n] = f
            n += 1
    return n


@njit(cache=True, nogil=True)
def _are_both_exempt(exempt_groups: np.ndarray, a: int, b: int, c: int, d: int) -> bool:
    for z in range(len(exempt_groups)):
        p, q, r, s = exempt_groups[z, a], exempt_groups[z, b], exempt_groups[z, c], exempt_groups[z, d]
        if p != 0 and abs(p) == abs(q) == abs(r) == abs(s) and max(p, q, r, s) > 0:
            return True
    return False


@njit(inline="always")
def _range_of(at_rest: float, reach: float, touches: float) -> float:
    """Range of a pair's energy from its rest distance."""
    return min(reach, OF_REST * at_rest) if at_rest > touches else 0.0


@parallel()
def _find_pairs(
    V: np.ndarray, U: np.ndarray, between: np.ndarray, reach: float, touches: float, beyond: np.ndarray,
    rstart: np.ndarray, ritem: np.ndarray, vstart: np.ndarray, vitem: np.ndarray, S: np.ndarray,
    estart: np.ndarray, eitem: np.ndarray, E: np.ndarray, fstart: np.ndarray, fitem: np.ndarray,
    F: np.ndarray, exempt_groups: np.ndarray, most: int, capacity: int, tasks: int,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:  # fmt: skip
    """Pairs found by each task, up to the capacity, with bounds and counts."""
    pairs = np.empty((tasks, capacity, 4), np.int32)
    edges = np.empty((tasks, capacity), np.bool_)
    owner = np.empty((tasks, capacity), np.int32)
    gap = np.empty((tasks, capacity))
    range_ = np.empty((tasks, capacity))
    bound = np.empty(len(between))
    count = np.zeros(tasks, np.int64)
    for task in prange(tasks):
        n = 0
        box = np.empty((2, 1, 6))
        one, other = np.empty(most, np.int64), np.empty(most, np.int64)
        A, B = np.empty((most, 6)), np.empty((most, 6))
        for o in range(task, len(between), tasks):
            i, j = between[o, 0], between[o, 1]
            _write_box(U, rstart, ritem, i, box[0])
            _write_box(U, rstart, ritem, j, box[1])
            bound[o] = max(beyond[o], box_distance(box[0], 0, box[1], 0) - reach)
            if bound[o] > beyond[o]:
                continue
            r = reach + beyond[o]
            ones = _gather(U, estart, eitem, E, i, box[1], r, one, A)
            others = _gather(U, estart, eitem, E, j, box[0], r, other, B) if ones > 0 else 0
            for x in range(ones):
                f = one[x]
                a, b = E[f, 0], E[f, 1]
                for y in range(others):
                    g = other[y]
                    if (i == j and g <= f) or not boxes_within(A, x, B, y, r):
                        continue
                    c, d = E[g, 0], E[g, 1]
                    if a in (c, d) or b in (c, d) or _are_both_exempt(exempt_groups, a, b, c, d):
                        continue
                    q = edge_edge(U, a, b, c, d)[0]
                    if q >= r * r:
                        continue
                    h = _range_of(np.sqrt(edge_edge(V, a, b, c, d)[0]), reach, touches)
                    if np.sqrt(q) < h + beyond[o]:
                        if n < capacity:
                            pairs[task, n, 0], pairs[task, n, 1] = a, b
                            pairs[task, n, 2], pairs[task, n, 3] = c, d
                            edges[task, n], owner[task, n] = True, o
                            gap[task, n], range_[task, n] = np.sqrt(q), h
                        n += 1
            for turn in range(1 if i == j else 2):
                mine, its = (i, j) if turn == 0 else (j, i)
                ones = _gather(U, vstart, vitem, S, mine, box[1 - turn], r, one, A)
                others = _gather(U, fstart, fitem, F, its, box[turn], r, other, B) if ones > 0 else 0
                for x in range(ones):
                    v = one[x]
                    for y in range(others):
                        f = other[y]
                        a, b, c = F[f, 0], F[f, 1], F[f, 2]
                        if (
                            not boxes_within(A, x, B, y, r)
                            or v in (a, b, c)
                            or _are_both_exempt(exempt_groups, v, a, b, c)
                        ):
                            continue
                        q = vertex_triangle(U, v, a, b, c)[0]
                        if q >= r * r:
                            continue
                        h = _range_of(np.sqrt(vertex_triangle(V, v, a, b, c)[0]), reach, touches)
                        if np.sqrt(q) < h + beyond[o]:
                            if n < capacity:
                                pairs[task, n, 0], pairs[task, n, 1] = v, a
                                pairs[task, n, 2], pairs[task, n, 3] = b, c
                                edges[task, n], owner[task, n] = False, o
                                gap[task, n], range_[task, n] = np.sqrt(q), h
                            n += 1
        count[task] = n
    return pairs, edges, owner, gap, range_, bound, count
