"""Discrete operators of a triangle mesh: areas, gradients, cotangents, Laplacians.

Throughout, ``V`` or ``U`` is an (n, 3) float array of positions in mesh units and ``F`` an (m, 3)
integer array of triangles, counter-clockwise seen from outside.
"""

import numpy as np
import scipy.sparse as sp

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.mesh.edges_and_components import boundary_vertices, join
from apd_viewer.geometry.mesh.weighted_areas import Patch

_NO_VOLUME = 1e-9  # of a surface of unit area: a smaller volume is rounding errors


def vertex_neighbours(F: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """One-ring of every vertex as a compressed sparse row graph.

    Parameters
    ----------
    F : (m, 3) int array
        Triangles.
    n : int
        Number of vertices.

    Returns
    -------
    start : (n + 1,) int32 array
    neighbour : (k,) int32 array
        The neighbours of vertex ``i`` are ``neighbour[start[i]:start[i + 1]]``, ascending, without
        repetition and without ``i`` itself.
    """
    a, b = F.ravel(), np.roll(F, -1, axis=1).ravel()
    edge = a != b
    a, b = a[edge], b[edge]
    ones = np.ones(2 * len(a), dtype=np.int8)
    graph = sp.csr_array((ones, (np.concatenate([a, b]), np.concatenate([b, a]))), shape=(n, n))
    graph.sum_duplicates()
    return graph.indptr.astype(np.int32), graph.indices.astype(np.int32)


@njit(cache=True, nogil=True)
def face_areas(U: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Area of every triangle, (m,) float array in square mesh units."""
    areas = np.empty(F.shape[0])
    for t in range(F.shape[0]):
        i, j, k = F[t, 0], F[t, 1], F[t, 2]
        ax, ay, az = U[j, 0] - U[i, 0], U[j, 1] - U[i, 1], U[j, 2] - U[i, 2]
        bx, by, bz = U[k, 0] - U[i, 0], U[k, 1] - U[i, 1], U[k, 2] - U[i, 2]
        x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        areas[t] = 0.5 * np.sqrt(x * x + y * y + z * z)
    return areas


def area(U: np.ndarray, F: np.ndarray) -> float:
    """Total surface area in square mesh units."""
    return float(face_areas(U, F).sum())


def vertex_areas(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """One third of the area of the triangles around every vertex, (n,) float array."""
    return np.bincount(F.ravel(), weights=np.repeat(face_areas(V, F) / 3.0, 3), minlength=len(V))


@njit(cache=True, nogil=True)
def _signed_volumes(U: np.ndarray, F: np.ndarray, origin: np.ndarray) -> np.ndarray:
    volumes = np.empty(F.shape[0])
    x, y, z = origin[0], origin[1], origin[2]
    for t in range(F.shape[0]):
        i, j, k = F[t, 0], F[t, 1], F[t, 2]
        ax, ay, az = U[i, 0] - x, U[i, 1] - y, U[i, 2] - z
        bx, by, bz = U[j, 0] - x, U[j, 1] - y, U[j, 2] - z
        cx, cy, cz = U[k, 0] - x, U[k, 1] - y, U[k, 2] - z
        volumes[t] = (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6.0
    return volumes


def volume(U: np.ndarray, F: np.ndarray) -> float:
    """Signed volume, cubic mesh units, positive for outward faces.

    Without meaning for a surface that is not closed: see :func:`.missing_volume_reason`.
    """
    return float(face_volumes(U, F).sum())


def face_volumes(U: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Signed volumes (m,) between a corner of the surface and each triangle."""
    # Measured from a vertex of the surface: far from the origin, the sum would lose digits to cancellation.
    return _signed_volumes(U, F, U[F[0, 0]])


def encloses_nothing(volume: float, area: float) -> bool:
    """True for a volume within the rounding of a surface of that area."""
    return bool(abs(volume) <= _NO_VOLUME * area**1.5)


@njit(cache=True, nogil=True)
def region_areas(U: np.ndarray, F: np.ndarray, member: np.ndarray, count: int) -> np.ndarray:
    """Areas of ``count`` regions: triangles with all three corners inside.

    Parameters
    ----------
    U : (n, 3) float array
    F : (m, 3) int array
    member : (n,) int array
        k + 1 for the vertices of region k, 0 for those in none.
    count : int

    Returns
    -------
    (count,) float array
        Square mesh units.
    """
    areas = np.zeros(count)
    for t in range(F.shape[0]):
        i, j, k = F[t, 0], F[t, 1], F[t, 2]
        number = member[i]
        if number == 0 or number > count or member[j] != number or member[k] != number:
            continue
        ax, ay, az = U[j, 0] - U[i, 0], U[j, 1] - U[i, 1], U[j, 2] - U[i, 2]
        bx, by, bz = U[k, 0] - U[i, 0], U[k, 1] - U[i, 1], U[k, 2] - U[i, 2]
        x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        areas[number - 1] += 0.5 * np.sqrt(x * x + y * y + z * z)
    return areas


@njit(cache=True, nogil=True)
def cotangents(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Cotangents of the corner angles, (m, 3); 0 in triangles without area."""
    cot = np.zeros(F.shape)
    for t in range(F.shape[0]):
        for c in range(3):
            i, j, k = F[t, c], F[t, (c + 1) % 3], F[t, (c + 2) % 3]
            ax, ay, az = V[j, 0] - V[i, 0], V[j, 1] - V[i, 1], V[j, 2] - V[i, 2]
            bx, by, bz = V[k, 0] - V[i, 0], V[k, 1] - V[i, 1], V[k, 2] - V[i, 2]
            x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
            double_area = np.sqrt(x * x + y * y + z * z)
            if double_area > 0.0:
                cot[t, c] = (ax * bx + ay * by + az * bz) / double_area
    return cot


# Connects vertices disconnected by clamped weights, too weakly to be visible in the shape.
_WEIGHT_FLOOR = 1e-6


# Upper bound on sliver weights: rigid to eight digits; a larger weight would cost other edges precision.
_STEEPEST = 1e8


# Largest cotangent of a well-shaped triangle: its square leaves half of the digits.
_NEEDLE = 1e4


def is_well_shaped(cot: np.ndarray) -> np.ndarray:
    """Mask (m,) of the triangles other than needles, by their cotangents (m, 3)."""
    size = np.abs(cot)
    return (size.max(axis=1) < _NEEDLE) & (size.sum(axis=1) > 0.0)


def _opposite_edges(F: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Ends of the edge opposite to each corner, in scipy's index type."""
    return F[:, [1, 2, 0]].ravel().astype(np.int32), F[:, [2, 0, 1]].ravel().astype(np.int32)


def edge_weights(V: np.ndarray, patch: Patch) -> sp.csr_array:
    """Symmetric matrix of cotangent weights, negative cotangents set to zero.

    ``w_ij = (max(0, cot a_ij) + max(0, cot b_ij)) / 2``. Each cotangent is clamped by itself, as CGAL does;
    clamping the sum gives another energy. Where clamping cuts a connected piece apart (needles, obtuse fans),
    the edges between the parts get a weight that is tiny, or the Laplacian of the piece would be singular.

    Parameters
    ----------
    V : (n, 3) float array
    patch : Patch
        The triangles.

    Returns
    -------
    (n, n) csr_array
        Zero diagonal; every edge of the mesh is stored, also those of weight zero.
    """
    n, cot = len(V), np.clip(cotangents(V, patch.F), 0.0, _STEEPEST)
    start, column, weight = _sorted_edges(patch.start, patch.corner, patch.F, cot)
    cut = _cut_edges(patch.F, cot, start, column)
    if cut.any():
        # Median, because a single sliver would dominate the mean.
        positive = weight[weight > 0.0]
        weight[cut] = _WEIGHT_FLOOR * (np.median(positive) if len(positive) else 1.0)
    return sp.csr_array((weight, column, start), shape=(n, n))


# Number of edges up to which rows are sorted by insertion alone.
_FEW = 64


@njit(cache=True, nogil=True)
def _sorted_edges(
    start: np.ndarray, corner: np.ndarray, F: np.ndarray, cot: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Compressed rows of the edges' weights: starts, ascending columns and entries."""
    n, count = len(start) - 1, 0
    rows, column, weight = np.zeros(n + 1, np.int32), np.empty(2 * F.size, np.int32), np.empty(2 * F.size)
    for i in range(n):
        first = count
        for e in range(start[i], start[i + 1]):
            t, c = corner[e] // 3, corner[e] % 3
            for d in range(1, 3):
                j = F[t, (c + d) % 3]
                if j != i:
                    column[count], weight[count] = j, 0.5 * cot[t, (c + 3 - d) % 3]
                    count += 1
        # Insertion, for many edges with gaps that shrink [Shell 1959, A high-speed sorting procedure].
        gap = count - first if count - first > _FEW else 2
        while gap > 1:
            gap = max(4 * gap // 9, 1)
            for e in range(first + gap, count):
                j, w, at = column[e], weight[e], e
                while at - gap >= first and column[at - gap] > j:
                    column[at], weight[at] = column[at - gap], weight[at - gap]
                    at -= gap
                column[at], weight[at] = j, w
        end, count = count, first
        for e in range(first, end):
            if count > first and column[e] == column[count - 1]:
                weight[count - 1] += weight[e]
            else:
                column[count], weight[count] = column[e], weight[e]
                count += 1
        rows[i + 1] = count
    return rows, column[:count].copy(), weight[:count].copy()


@njit(cache=True, nogil=True)
def _cut_edges(F: np.ndarray, cot: np.ndarray, start: np.ndarray, column: np.ndarray) -> np.ndarray:
    """Mask (k,) of the edges between parts that no edges of positive weight connect."""
    part = np.arange(len(start) - 1)
    for t in range(len(F)):
        for c in range(3):
            if cot[t, c] > 0.0:
                join(part, F[t, (c + 1) % 3], F[t, (c + 2) % 3])
    for i in range(len(part)):
        part[i] = part[part[i]]  # the parent is a lower vertex
    cut = np.zeros(len(column), dtype=np.bool_)
    for i in range(len(part)):
        for e in range(start[i], start[i + 1]):
            cut[e] = part[i] != part[column[e]]
    return cut


def laplacian(W: sp.csr_array) -> sp.csr_array:
    """Positive semi-definite Laplacian ``L_ij = -w_ij`` of the weights ``W`` (n, n)."""
    return (sp.diags_array(W.sum(axis=1)) - W).tocsr()


def element_laplacian(cot: np.ndarray, F: np.ndarray, n: int) -> sp.csr_array:
    """Cotangent Laplacian (n, n) from the corners' cotangents ``cot`` (m, 3) of ``F``."""
    w = 0.5 * cot.ravel()
    i, j = _opposite_edges(F)
    W = sp.coo_array((np.concatenate([w, w]), (np.concatenate([i, j]), np.concatenate([j, i]))), shape=(n, n))
    return laplacian(W.tocsr())


# Vertices on an arbitrarily triangulated cylinder have angle defects of both signs, 0.46 in total. This many
# averaging steps leave 0.02; they leave 1.0 for a tube with vertices off by a hundredth of its radius.
_STEPS = 30


@njit(cache=True, nogil=True)
def aspect_ratios(V: np.ndarray, F: np.ndarray, areas: np.ndarray) -> np.ndarray:
    """Longest edges over heights (m,) of triangles ``F`` (m, 3); 0 without area."""
    ratios = np.zeros(len(F))
    for t in range(len(F)):
        longest = 0.0
        for c in range(3):
            i, j = F[t, c], F[t, (c + 1) % 3]
            x, y, z = V[j, 0] - V[i, 0], V[j, 1] - V[i, 1], V[j, 2] - V[i, 2]
            longest = max(longest, x * x + y * y + z * z)
        if areas[t] > 0.0:
            ratios[t] = longest / (2.0 * areas[t])
    return ratios


def total_curvature(V: np.ndarray, F: np.ndarray) -> float:
    """Integral of the absolute Gauss curvature, averaged over neighbourhoods.

    4 pi for every convex closed surface, 0 for tubes, sheets and whatever else can be unrolled. The borders
    of an open surface do not count.

    Parameters
    ----------
    V : (n, 3) float array
        One for each vertex: those at one position are joined.
    F : (m, 3) int array, triangles
    """
    n, cot = len(V), cotangents(V, F)
    angles = np.where(is_well_shaped(cot)[:, None], np.arctan2(1.0, cot), 0.0)
    around = np.bincount(F.ravel(), angles.ravel(), n)
    defect = np.where(around > 0.0, 2.0 * np.pi - around, 0.0)
    defect[boundary_vertices(F, n)] = 0.0
    start, neighbour = vertex_neighbours(F, n)
    count = np.diff(start)
    handed = sp.csr_array((np.repeat(1.0 / np.maximum(count, 1), count), neighbour, start), shape=(n, n)).T
    for _ in range(_STEPS):
        defect = 0.5 * (defect + handed @ defect)
    return float(np.abs(defect).sum())
