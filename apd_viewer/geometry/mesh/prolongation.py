"""Smooth prolongation of the motion of a coarse surface to a fine one.

Neighbouring fine vertices are so near each other that any jump of the interpolation is a dent. So the weights
fall to zero smoothly, and what is blended are the expansions of the motion about the coarse vertices:

    u(v) = sum_k w_k (u_k + (G_k + G) (v - x_k) / 2),   G = sum_k w_k G_k,

with the gradients G_k of the displacement: a partition of unity [Shepard 1968, A two-dimensional
interpolation function for irregularly-spaced data; Babuska & Melenk 1997, The partition of unity method]. By
the trapezoidal rule an expansion is exact for a displacement of second degree.
"""

import numpy as np
from numba import prange
from scipy.sparse import coo_array

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.rotations import quaternion_to_matrix
from apd_viewer.geometry.linalg.threads import parallel

# Radius of a coarse vertex's influence in mean lengths of its edges, and the rings of neighbours within
# that radius.
_REACH, _RINGS = 2.5, 4
# Weight of the rotation in a gradient: across the surface it is not determined by the neighbours.
_ROTATION = 1e-2
_COMPONENTS = 15
# Vertices per parallel task.
_PORTION = 1024


class Prolongation:
    """Smooth interpolation from coarse vertices to every fine one.

    Parameters
    ----------
    V : (n, 3) float array
        Rest positions of the fine surface.
    vertices : (c,) int array
        The fine vertices that the coarse surface has.
    F : (k, 3) int array
        Triangles between them.
    nearest : (n,) int array
        A coarse vertex near every fine one, on its own side of a wall; -1 if there is none.
    """

    def __init__(self, V: np.ndarray, vertices: np.ndarray, F: np.ndarray, nearest: np.ndarray) -> None:
        X, c = V[vertices], len(vertices)
        i, j = F[:, [0, 1, 2, 1, 2, 0]].T.ravel(), F[:, [1, 2, 0, 0, 1, 2]].T.ravel()
        graph = coo_array((np.ones(len(i)), (i, j)), shape=(c, c)).tocsr()
        near, at = graph.nonzero()
        self._degree = np.bincount(near, minlength=c)
        length = np.bincount(near, np.linalg.norm(X[near] - X[at], axis=1), c) / np.maximum(self._degree, 1)
        radius = _REACH * np.where(length > 0.0, length, 1.0)
        self._rings = _rings_of(graph.indptr, graph.indices, _RINGS)
        (start, ring), squared = self._rings, radius * radius
        rows = np.concatenate([[0], np.cumsum(_counts(V, X, nearest, start, ring, squared))])
        self._weights = rows, *_weights(V, X, nearest, start, ring, squared, rows)

    def moved_positions(
        self, U: np.ndarray, X: np.ndarray, q: np.ndarray, moved: np.ndarray, is_held: np.ndarray
    ) -> np.ndarray:
        """Positions ``U`` (n, 3) after a motion of the coarse surface.

        Parameters
        ----------
        X, moved : (c, 3) float arrays
            The coarse vertices before, and their displacements.
        q : (c, 4) float array
            Unit quaternions: how they have turned.
        is_held : (c,) bool array
            The coarse vertices that are held.
        """
        (rows, node, weight), (start, ring) = self._weights, self._rings
        B = _expansions(X, q, moved, start, ring, self._degree, is_held)
        return _carried(U, rows, node, weight, B)

    def prolonged_values(self, values: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Interpolation ``P values`` (f, 3) of ``values`` (c, 3) to the fine ``rows``."""
        return _interpolated(values, rows, *self._weights)

    def restricted_values(self, b: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Restriction ``P^T b`` (c, 3) of ``b`` (f, 3) at the fine vertices ``rows``."""
        return _gathered(b, rows, *self._weights, len(self._degree))


@njit(cache=True, nogil=True)
def _rings_of(start: np.ndarray, neighbour: np.ndarray, depth: int) -> tuple[np.ndarray, np.ndarray]:
    """Rows of every vertex and those up to ``depth`` edges away, nearest first."""
    n = len(start) - 1
    rows, mark = np.zeros(n + 1, dtype=np.int64), np.full(n, -1)
    found = np.empty(64 * n + 64, dtype=np.int32)
    count = 0
    for i in range(n):
        if count + n > len(found):
            larger = np.empty(2 * len(found) + n, dtype=np.int32)
            larger[:count] = found[:count]
            found = larger
        found[count], mark[i] = i, i
        first, count = count, count + 1
        for _ in range(depth):
            last = count
            for place in range(first, last):
                for e in range(start[found[place]], start[found[place] + 1]):
                    j = neighbour[e]
                    if mark[j] != i:
                        found[count], mark[j] = j, i
                        count += 1
            first = last
        rows[i + 1] = count
    return rows, found[:count].copy()


@parallel()
def _counts(
    V: np.ndarray,
    X: np.ndarray,
    nearest: np.ndarray,
    start: np.ndarray,
    ring: np.ndarray,
    squared: np.ndarray,
) -> np.ndarray:
    """Numbers (n,) of coarse vertices within whose ``squared`` radii fine ones lie."""
    count = np.zeros(len(V), dtype=np.int64)
    for portion in prange((len(V) + _PORTION - 1) // _PORTION):
        for i in range(portion * _PORTION, min(len(V), (portion + 1) * _PORTION)):
            c = nearest[i]
            if c >= 0:
                within = 0
                for e in range(start[c], start[c + 1]):
                    k = ring[e]
                    x, y, z = V[i, 0] - X[k, 0], V[i, 1] - X[k, 1], V[i, 2] - X[k, 2]
                    within += x * x + y * y + z * z < squared[k]
                count[i] = max(within, 1)
    return count


@parallel()
def _weights(
    V: np.ndarray,
    X: np.ndarray,
    nearest: np.ndarray,
    start: np.ndarray,
    ring: np.ndarray,
    squared: np.ndarray,
    rows: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Sparse ``rows`` of the weights ``(1 - d^2 / radius^2)^3``, each of sum one."""
    node, weight = np.empty(rows[-1], dtype=np.int32), np.empty(rows[-1], dtype=np.float32)
    for portion in prange((len(V) + _PORTION - 1) // _PORTION):
        for i in range(portion * _PORTION, min(len(V), (portion + 1) * _PORTION)):
            c, count, total = nearest[i], rows[i], 0.0
            if rows[i + 1] == count:
                continue
            for e in range(start[c], start[c + 1]):
                k = ring[e]
                x, y, z = V[i, 0] - X[k, 0], V[i, 1] - X[k, 1], V[i, 2] - X[k, 2]
                distance = x * x + y * y + z * z
                if distance < squared[k]:
                    s = 1.0 - distance / squared[k]
                    node[count], weight[count] = k, s * s * s
                    total += s * s * s
                    count += 1
            if total == 0.0:
                node[rows[i]], weight[rows[i]] = c, 1.0
                total = 1.0
            for e in range(rows[i], rows[i + 1]):
                weight[e] /= total
    return node, weight


@parallel()
def _expansions(
    X: np.ndarray,
    q: np.ndarray,
    moved: np.ndarray,
    start: np.ndarray,
    ring: np.ndarray,
    degree: np.ndarray,
    held: np.ndarray,
) -> np.ndarray:
    """Expansions of the coarse motion, ``moved_k - G_k x_k / 2, G_k, x_k``, (c, 15).

    Gradients are fitted to the neighbours by least squares; those of held vertices to held ones alone, for
    these are not bent.
    """
    out = np.empty((len(X), _COMPONENTS))
    for i in prange(len(X)):
        M, S, R = np.zeros((3, 3)), np.zeros((3, 3)), np.empty((3, 3))
        quaternion_to_matrix(q[i], R)
        for e in range(start[i] + 1, start[i + 1] if held[i] else start[i] + 1 + degree[i]):
            j = ring[e]
            if held[j] or not held[i]:
                for a in range(3):
                    for b in range(3):
                        M[a, b] += (X[j, a] - X[i, a]) * (X[j, b] - X[i, b])
                        S[a, b] += (moved[j, a] - moved[i, a]) * (X[j, b] - X[i, b])
        trace = M[0, 0] + M[1, 1] + M[2, 2]
        ridge = _ROTATION * trace if trace > 0.0 else 1.0
        for a in range(3):
            M[a, a] += ridge
            R[a, a] -= 1.0
        G = (S + ridge * R) @ np.linalg.inv(M)
        for a in range(3):
            out[i, a] = moved[i, a] - 0.5 * (G[a, 0] * X[i, 0] + G[a, 1] * X[i, 1] + G[a, 2] * X[i, 2])
            out[i, 12 + a] = X[i, a]
            for b in range(3):
                out[i, 3 + 3 * a + b] = G[a, b]
    return out


@parallel(fastmath=True)
def _carried(
    U: np.ndarray, start: np.ndarray, node: np.ndarray, weight: np.ndarray, B: np.ndarray
) -> np.ndarray:
    """Positions ``U`` (n, 3) moved by the blended expansions ``B`` (c, 15)."""
    out = np.empty_like(U)
    for portion in prange((len(U) + _PORTION - 1) // _PORTION):
        f = np.empty(_COMPONENTS)
        for i in range(portion * _PORTION, min(len(U), (portion + 1) * _PORTION)):
            f[:] = 0.0
            for e in range(start[i], start[i + 1]):
                k, w = node[e], weight[e]
                for a in range(_COMPONENTS):
                    f[a] += w * B[k, a]
            x, y, z = U[i, 0] - 0.5 * f[12], U[i, 1] - 0.5 * f[13], U[i, 2] - 0.5 * f[14]
            for a in range(3):
                out[i, a] = U[i, a] + f[a] + f[3 + 3 * a] * x + f[4 + 3 * a] * y + f[5 + 3 * a] * z
    return out


@parallel()
def _interpolated(
    X: np.ndarray, rows: np.ndarray, start: np.ndarray, node: np.ndarray, weight: np.ndarray
) -> np.ndarray:
    out = np.empty((len(rows), 3))
    for f in prange(len(rows)):
        x = y = z = 0.0
        for e in range(start[rows[f]], start[rows[f] + 1]):
            k, w = node[e], weight[e]
            x += w * X[k, 0]
            y += w * X[k, 1]
            z += w * X[k, 2]
        out[f, 0], out[f, 1], out[f, 2] = x, y, z
    return out


@njit(cache=True, nogil=True)
def _gathered(
    b: np.ndarray, rows: np.ndarray, start: np.ndarray, node: np.ndarray, weight: np.ndarray, c: int
) -> np.ndarray:
    out = np.zeros((c, 3))
    for f in range(len(rows)):
        for e in range(start[rows[f]], start[rows[f] + 1]):
            for axis in range(3):
                out[node[e], axis] += weight[e] * b[f, axis]
    return out
