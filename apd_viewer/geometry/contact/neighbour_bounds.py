"""Lower bounds of gaps between patches in nearly the same place as at rest.

Neighbouring patches of a smooth surface always touch, so that a budget of their approach is soon used up.
Where an affine map of the rest shape, ``x = A X + t``, leaves displacements of at most ``r``, two points that
were ``d`` apart are at least ``s d - 2 r`` apart, with the least singular value ``s`` of ``A``. That says for
any shape, whatever the way to it, that neighbours do not touch.
"""

import numpy as np
from numba import prange

from apd_viewer.geometry.contact.distances import edge_edge, vertex_triangle
from apd_viewer.geometry.contact.pair_search import OF_REST
from apd_viewer.geometry.contact.patches import Patches, pair_keys, rows_among
from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.threads import parallel

# Ridge relative to the trace of the moments, which are singular for coplanar points.
_RIDGE = 1e-3
# Relative rounding errors of the least eigenvalue, from above.
_ROUNDING = 1e-6


class NeighbourBounds:
    """Lower bounds of the excess of gaps over their range, by the rest shape.

    Parameters
    ----------
    V : (n, 3) float array
        Rest positions.
    F : (m, 3) int array
    E : (e, 2) int array
    patches : Patches
    reach : float
        Range of the gap energy, mesh units.
    most : float
        Gaps at rest are known up to this distance, mesh units.
    """

    def __init__(
        self, V: np.ndarray, F: np.ndarray, E: np.ndarray, patches: Patches, reach: float, most: float
    ) -> None:
        self._V, self._patches, self._reach, self._most = V, patches, reach, most
        pairs, _ = patches.near_pairs(boxes := patches.boxes(V), most)
        self._keys = pair_keys(pairs)
        items = *patches.vertices, *patches.edges, E, *patches.faces, F
        self._gap = _rest_gaps(V, boxes, pairs, most, *items)

    def excess(self, U: np.ndarray, W: np.ndarray, pairs: np.ndarray) -> np.ndarray:
        """Lower bounds (k,) for ascending pairs (k, 2) of patches from ``U`` to ``W``.

        On the whole step; negative where the patches no longer lie to each other as at rest.
        """
        row = rows_among(pair_keys(pairs), self._keys)
        gap = np.where(row >= 0, self._gap[row], self._most)
        return _least_excess(self._V, U, W, pairs, gap, self._reach, *self._patches.covered_vertices)


@njit(cache=True, nogil=True)
def _squared_distance(X: np.ndarray, a: int, b: int) -> float:
    x, y, z = X[a, 0] - X[b, 0], X[a, 1] - X[b, 1], X[a, 2] - X[b, 2]
    return x * x + y * y + z * z


@njit(cache=True, nogil=True)
def _squared_distance_of_sums(X: np.ndarray, a: int, b: int, c: int, d: int) -> float:
    x, y, z = X[a, 0] + X[b, 0], X[a, 1] + X[b, 1], X[a, 2] + X[b, 2]
    x, y, z = x - X[c, 0] - X[d, 0], y - X[c, 1] - X[d, 1], z - X[c, 2] - X[d, 2]
    return x * x + y * y + z * z


@njit(cache=True, nogil=True)
def _is_beyond(V: np.ndarray, ids: tuple[int, ...], boxes: np.ndarray, p: int, gap: float) -> bool:
    """True if vertices ``ids`` lie more than ``gap`` beside box ``p`` along an axis."""
    for c in range(3):
        low = high = V[ids[0], c]
        for v in ids[1:]:
            low, high = min(low, V[v, c]), max(high, V[v, c])
        if low > boxes[p, c + 3] + gap or high < boxes[p, c] - gap:
            return True
    return False


@parallel()
def _rest_gaps(
    V: np.ndarray, boxes: np.ndarray, pairs: np.ndarray, most: float, vstart: np.ndarray,
    vitem: np.ndarray, estart: np.ndarray, eitem: np.ndarray, E: np.ndarray, fstart: np.ndarray,
    fitem: np.ndarray, F: np.ndarray,
) -> np.ndarray:  # fmt: skip
    """Least gap (k,), up to ``most``, between elements without a common vertex."""
    gaps = np.empty(len(pairs))
    for k in prange(len(pairs)):
        i, j = pairs[k, 0], pairs[k, 1]
        least = most
        for x in range(estart[i], estart[i + 1]):
            a, b = E[eitem[x], 0], E[eitem[x], 1]
            if _is_beyond(V, (a, b), boxes, j, least):
                continue
            one = np.sqrt(_squared_distance(V, a, b))
            for y in range(estart[j], estart[j + 1]):
                c, d = E[eitem[y], 0], E[eitem[y], 1]
                if a in (c, d) or b in (c, d):
                    continue
                # No point of an edge is farther from its middle than half of its length.
                far = 2.0 * least + one + np.sqrt(_squared_distance(V, c, d))
                if _squared_distance_of_sums(V, a, b, c, d) < far * far:
                    least = min(least, np.sqrt(edge_edge(V, a, b, c, d)[0]))
        for turn in range(2):
            mine, its = (i, j) if turn == 0 else (j, i)
            for y in range(fstart[its], fstart[its + 1]):
                a, b, c = F[fitem[y], 0], F[fitem[y], 1], F[fitem[y], 2]
                if _is_beyond(V, (a, b, c), boxes, mine, least):
                    continue
                size = np.sqrt(max(_squared_distance(V, a, b), _squared_distance(V, a, c)))
                for x in range(vstart[mine], vstart[mine + 1]):
                    v = vitem[x]
                    if v in (a, b, c) or _squared_distance(V, v, a) >= (least + size) ** 2:
                        continue
                    least = min(least, np.sqrt(vertex_triangle(V, v, a, b, c)[0]))
        gaps[k] = least
    return gaps


@njit(cache=True, nogil=True)
def _cofactors(A: np.ndarray, C: np.ndarray) -> None:
    """Write the cofactors of ``A`` (3, 3) to ``C``."""
    for r in range(3):
        for c in range(3):
            p, q, s, t = (r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3
            C[r, c] = A[p, s] * A[q, t] - A[p, t] * A[q, s]


@njit(cache=True, nogil=True)
def _least_singular_value(A: np.ndarray) -> float:
    """Lower bound of the least singular value of ``A`` (3, 3), up to rounding."""
    xx = yy = zz = xy = yz = zx = 0.0
    for k in range(3):
        x, y, z = A[k, 0], A[k, 1], A[k, 2]
        xx, yy, zz, xy, yz, zx = xx + x * x, yy + y * y, zz + z * z, xy + x * y, yz + y * z, zx + z * x
    trace = xx + yy + zz
    mean = trace / 3.0
    a, b, c = xx - mean, yy - mean, zz - mean
    size = np.sqrt((a * a + b * b + c * c + 2.0 * (xy * xy + yz * yz + zx * zx)) / 6.0)
    if size > 0.0:
        whole = a * (b * c - yz * yz) - xy * (xy * c - yz * zx) + zx * (xy * yz - b * zx)
        angle = np.arccos(min(1.0, max(-1.0, 0.5 * whole / size**3))) / 3.0
        mean += 2.0 * size * np.cos(angle + 2.0 * np.pi / 3.0)
    return np.sqrt(max(0.0, mean - _ROUNDING * trace))


@parallel()
def _least_excess(
    V: np.ndarray, U: np.ndarray, W: np.ndarray, pairs: np.ndarray, gap: np.ndarray, reach: float,
    start: np.ndarray, item: np.ndarray,
) -> np.ndarray:  # fmt: skip
    """Lower bounds (k,) of the excess of gaps, given those at rest (k,)."""
    found = np.empty(len(pairs))
    for k in prange(len(pairs)):
        # Rows: rest shape, shape before, shape after.
        mean, moments = np.zeros((3, 3)), np.zeros((3, 3, 3))
        A, B, C, inverse = np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3))
        count = 0
        for side in range(2):
            p = pairs[k, side]
            for e in range(start[p], start[p + 1]):
                v = item[e]
                count += 1
                for c in range(3):
                    mean[0, c] += V[v, c]
                    mean[1, c] += U[v, c]
                    mean[2, c] += W[v, c]
        for s in range(3):
            for c in range(3):
                mean[s, c] /= count
        for side in range(2):
            p = pairs[k, side]
            for e in range(start[p], start[p + 1]):
                v = item[e]
                for c in range(3):
                    x = V[v, c] - mean[0, c]
                    for r in range(3):
                        moments[0, r, c] += (V[v, r] - mean[0, r]) * x
                        moments[1, r, c] += (U[v, r] - mean[1, r]) * x
                        moments[2, r, c] += (W[v, r] - mean[2, r]) * x
        M = moments[0]
        ridge = _RIDGE * (M[0, 0] + M[1, 1] + M[2, 2])
        for c in range(3):
            M[c, c] += ridge
        _cofactors(M, inverse)
        whole = M[0, 0] * inverse[0, 0] + M[0, 1] * inverse[0, 1] + M[0, 2] * inverse[0, 2]
        if not whole > 0.0:
            found[k] = -1.0
            continue
        least, most = np.inf, 0.0
        for s in range(1, 3):
            D, N = (A, moments[1]) if s == 1 else (B, moments[2])
            for r in range(3):
                for c in range(3):
                    D[r, c] = (
                        N[r, 0] * inverse[0, c] + N[r, 1] * inverse[1, c] + N[r, 2] * inverse[2, c]
                    ) / whole
            # Normals of flat patches go to normals: the cofactors map them so. Any map would do, since what
            # it leaves is measured.
            _cofactors(D, C)
            for r in range(3):
                for c in range(3):
                    N[r, c] += ridge * C[r, c]
            for r in range(3):
                for c in range(3):
                    D[r, c] = (
                        N[r, 0] * inverse[0, c] + N[r, 1] * inverse[1, c] + N[r, 2] * inverse[2, c]
                    ) / whole
            least = min(least, _least_singular_value(D))
        for side in range(2):
            p = pairs[k, side]
            for e in range(start[p], start[p + 1]):
                v = item[e]
                x, y, z = V[v, 0] - mean[0, 0], V[v, 1] - mean[0, 1], V[v, 2] - mean[0, 2]
                before = after = 0.0
                for c in range(3):
                    left = U[v, c] - mean[1, c] - A[c, 0] * x - A[c, 1] * y - A[c, 2] * z
                    before += left * left
                    left = W[v, c] - mean[2, c] - B[c, 0] * x - B[c, 1] * y - B[c, 2] * z
                    after += left * left
                most = max(most, before, after)
        between = 0.0
        for r in range(3):
            for c in range(3):
                between += (A[r, c] - B[r, c]) ** 2
        # On the way the map and what it leaves are means of those at the ends, of which one is not farther
        # than half of the way.
        least -= 0.5 * np.sqrt(between)
        # Beyond the least gap, the excess grows with the gap only above this ratio.
        found[k] = least * gap[k] - 2.0 * np.sqrt(most) - min(reach, OF_REST * gap[k])
        if least < OF_REST:
            found[k] = -1.0
    return found
