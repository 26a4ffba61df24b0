"""Search for near ones among bounding boxes, by a tree of boxes."""

import numpy as np
from numba import prange

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.threads import parallel

# Cells of the Morton curve along the longest axis, and steps that spread the bits of their numbers.
_CELLS = 1023.0
_SPREAD = (16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)
_TASKS = 32  # of a search for near boxes
_FIRST_CAPACITY = 1000  # pairs of boxes of a task
_DEEPEST = 64  # nodes that wait: one for each level of a tree


class NearBoxes:
    """Search for pairs of near boxes, with room for as many as before."""

    def __init__(self) -> None:
        self._capacity = _FIRST_CAPACITY

    def pairs_within(self, boxes: np.ndarray, gap: float) -> tuple[np.ndarray, np.ndarray]:
        """Pairs (k, 2) of boxes (p, 6) within ``gap``, and their distances (k,).

        In ascending order; each box makes a pair with itself.
        """
        order = _order_along_curve(boxes)
        tree = _tree_of_boxes(boxes[order])
        while True:
            *columns, count = _near_leaves(tree, order, gap, self._capacity, _TASKS)
            if (most := int(count.max())) <= self._capacity:
                break
            self._capacity = int(1.2 * most)
        return _in_ascending_order(*columns, count, len(boxes))


@njit(inline="always")
def box_distance(A: np.ndarray, i: int, B: np.ndarray, j: int) -> float:
    """Distance of two boxes, rows of (k, 6) arrays."""
    q = 0.0
    for c in range(3):
        d = max(B[j, c] - A[i, c + 3], A[i, c] - B[j, c + 3])
        if d > 0.0:
            q += d * d
    return np.sqrt(q)


@njit(inline="always")
def boxes_within(A: np.ndarray, i: int, B: np.ndarray, j: int, gap: float) -> bool:
    """True unless two boxes are farther apart than ``gap`` along an axis."""
    return not (
        A[i, 0] > B[j, 3] + gap
        or A[i, 3] < B[j, 0] - gap
        or A[i, 1] > B[j, 4] + gap
        or A[i, 4] < B[j, 1] - gap
        or A[i, 2] > B[j, 5] + gap
        or A[i, 5] < B[j, 2] - gap
    )


def _order_along_curve(boxes: np.ndarray) -> np.ndarray:
    """Order (p,) of boxes (p, 6) by the Morton curve through their centres."""
    centres = boxes[:, :3] + boxes[:, 3:]
    size = max(float(np.ptp(centres, axis=0).max()), 1e-300)
    cells = ((centres - centres.min(axis=0)) * (_CELLS / size)).astype(np.int64)
    for shift, mask in _SPREAD:
        cells = (cells | cells << shift) & mask
    return np.argsort(cells @ [1, 2, 4], kind="stable")


def _tree_of_boxes(leaves: np.ndarray) -> np.ndarray:
    """Complete binary tree (2 l, 6) of boxes around boxes (p, 6), its root in row 1.

    Children of row k are 2 k and 2 k + 1. The leaves from row l on are those given, then empty ones.
    """
    width = 1 << (len(leaves) - 1).bit_length()
    empty = np.repeat([np.inf, -np.inf], 3)
    tree = np.tile(empty, (2 * width, 1))
    tree[width : width + len(leaves)] = leaves
    while width > 1:
        low, high = tree[width : 2 * width : 2], tree[width + 1 : 2 * width : 2]
        width //= 2
        tree[width : 2 * width, :3] = np.minimum(low[:, :3], high[:, :3])
        tree[width : 2 * width, 3:] = np.maximum(low[:, 3:], high[:, 3:])
    return tree


@parallel()
def _near_leaves(
    tree: np.ndarray, order: np.ndarray, gap: float, capacity: int, tasks: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Keys and distances of near leaves by task, and their number.

    No more than the capacity are written. A key has the lower of two numbers of boxes, which ``order`` (p,)
    tells, in its upper 32 bits.
    """
    width, leaves = len(tree) // 2, len(order)
    key, apart = np.empty((tasks, capacity), np.int64), np.empty((tasks, capacity))
    count = np.zeros(tasks, np.int64)
    for task in prange(tasks):
        n = 0
        node, span = np.empty(_DEEPEST, np.int64), np.empty(_DEEPEST, np.int64)
        for leaf in range(task, leaves, tasks):
            i = order[leaf]
            node[0], span[0] = 1, width
            depth = 1
            while depth > 0:
                depth -= 1
                k, size = node[depth], span[depth]
                begin = k * size - width  # the first leaf below
                if begin + size <= leaf or begin >= leaves:
                    continue
                if not boxes_within(tree, width + leaf, tree, k, gap):
                    continue
                d = box_distance(tree, width + leaf, tree, k)
                if d > gap:
                    continue
                if size > 1:
                    for child in range(2):
                        node[depth], span[depth] = 2 * k + child, size // 2
                        depth += 1
                    continue
                if n < capacity:
                    j = order[begin]
                    key[task, n], apart[task, n] = min(i, j) << 32 | max(i, j), d
                n += 1
        count[task] = n
    return key, apart, count


@njit(cache=True, nogil=True)
def _in_ascending_order(
    key: np.ndarray, apart: np.ndarray, count: np.ndarray, boxes: int
) -> tuple[np.ndarray, np.ndarray]:
    """Pairs (k, 2) and distances (k,) of all tasks, in ascending order."""
    # Sorted by counting, then within the few pairs of a box: a third of the time of argsort.
    start = np.zeros(boxes + 1, np.int64)
    for task in range(len(count)):
        for n in range(count[task]):
            start[(key[task, n] >> 32) + 1] += 1
    start = np.cumsum(start)
    last, pairs, distance = start.copy(), np.empty((start[-1], 2), np.int64), np.empty(start[-1])
    for task in range(len(count)):
        for n in range(count[task]):
            i, j = key[task, n] >> 32, key[task, n] & 0xFFFFFFFF
            k = last[i]
            while k > start[i] and pairs[k - 1, 1] > j:
                pairs[k, 1], distance[k] = pairs[k - 1, 1], distance[k - 1]
                k -= 1
            pairs[last[i], 0] = i
            pairs[k, 1], distance[k] = j, apart[task, n]
            last[i] += 1
    return pairs, distance
