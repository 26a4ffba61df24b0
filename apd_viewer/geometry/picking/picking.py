"""Ray casting and brushes on a deforming mesh, without a search tree.

No search tree: a mesh that deforms would have to rebuild it for every pick, which costs more than looking
at each triangle once. Boxes around the triangles as they come cost no more than one look at them.
"""

import numpy as np

from apd_viewer.geometry.linalg.kernels import njit

BLOCK = 128  # triangles per box; consecutive triangles are mostly close in space
_SLACK = 1e-9  # margin, so that rounding does not let a ray miss the box of a triangle it hits
_RIM = 1e-9  # margin of barycentric weights, so that no ray slips through a vertex or between triangles


@njit(cache=True, nogil=True)
def block_boxes(U: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Bounding boxes of each ``BLOCK`` consecutive triangles.

    Parameters
    ----------
    U : (n, 3) float array
    F : (m, 3) int array

    Returns
    -------
    (b, 2, 3) float array
        The low and the high corner of each.
    """
    count = (F.shape[0] + BLOCK - 1) // BLOCK
    found = np.empty((count, 2, 3))
    for b in range(count):
        lx = ly = lz = np.inf
        hx = hy = hz = -np.inf
        for t in range(b * BLOCK, min((b + 1) * BLOCK, F.shape[0])):
            for c in range(3):
                x, y, z = U[F[t, c], 0], U[F[t, c], 1], U[F[t, c], 2]
                lx, ly, lz = min(lx, x), min(ly, y), min(lz, z)
                hx, hy, hz = max(hx, x), max(hy, y), max(hz, z)
        largest = max(max(abs(lx), abs(hx)), max(abs(ly), abs(hy)), max(abs(lz), abs(hz)))
        slack = _SLACK * largest
        found[b, 0, 0], found[b, 0, 1], found[b, 0, 2] = lx - slack, ly - slack, lz - slack
        found[b, 1, 0], found[b, 1, 1], found[b, 1, 2] = hx + slack, hy + slack, hz + slack
    return found


@njit(cache=True, nogil=True)
def ray_hit(
    origin: np.ndarray, direction: np.ndarray, U: np.ndarray, F: np.ndarray, block_boxes: np.ndarray
) -> tuple[int, float, float, float]:
    """Nearest triangle hit by a ray, from either side of the surface.

    Parameters
    ----------
    origin, direction : (3,) float array
    U : (n, 3) float array
    F : (m, 3) int array
    block_boxes : (b, 2, 3) float array
        The :func:`block_boxes` of the same ``U`` and ``F``.

    Returns
    -------
    face : int
        -1 when the ray meets nothing.
    distance : float
        In multiples of ``direction``; infinite when the ray meets nothing.
    b1, b2 : float
        The hit is ``(1 - b1 - b2) * U[F[face, 0]] + b1 * U[F[face, 1]] + b2 * U[F[face, 2]]``.
    """
    ox, oy, oz = origin[0], origin[1], origin[2]
    dx, dy, dz = direction[0], direction[1], direction[2]
    face, distance, b1, b2 = -1, np.inf, 0.0, 0.0
    for b in range(block_boxes.shape[0]):
        if not _enters_box(origin, direction, block_boxes[b], distance):
            continue
        for t in range(b * BLOCK, min((b + 1) * BLOCK, F.shape[0])):
            i, j, k = F[t, 0], F[t, 1], F[t, 2]
            ex, ey, ez = U[j, 0] - U[i, 0], U[j, 1] - U[i, 1], U[j, 2] - U[i, 2]
            gx, gy, gz = U[k, 0] - U[i, 0], U[k, 1] - U[i, 1], U[k, 2] - U[i, 2]
            px, py, pz = dy * gz - dz * gy, dz * gx - dx * gz, dx * gy - dy * gx
            det = ex * px + ey * py + ez * pz
            if det == 0.0:
                continue
            sx, sy, sz = ox - U[i, 0], oy - U[i, 1], oz - U[i, 2]
            u = (sx * px + sy * py + sz * pz) / det
            if u < -_RIM or u > 1.0 + _RIM:
                continue
            qx, qy, qz = sy * ez - sz * ey, sz * ex - sx * ez, sx * ey - sy * ex
            v = (dx * qx + dy * qy + dz * qz) / det
            if v < -_RIM or u + v > 1.0 + _RIM:
                continue
            s = (gx * qx + gy * qy + gz * qz) / det
            if 0.0 < s < distance:
                face, distance, b1, b2 = t, s, u, v
    return face, distance, b1, b2


@njit(cache=True, nogil=True)
def _enters_box(origin: np.ndarray, direction: np.ndarray, box: np.ndarray, distance: float) -> bool:
    """True if a ray enters a ``box`` (2, 3) within a ``distance`` of its origin."""
    near, far = 0.0, distance
    for c in range(3):
        if direction[c] == 0.0:
            if not box[0, c] <= origin[c] <= box[1, c]:
                return False
        else:
            a, b = (box[0, c] - origin[c]) / direction[c], (box[1, c] - origin[c]) / direction[c]
            near, far = max(near, min(a, b)), min(far, max(a, b))
    return near <= far


@njit(cache=True, nogil=True)
def _squared_distance(x: np.ndarray, a: np.ndarray, b: np.ndarray) -> float:
    """Squared distance of ``x`` from the segment ``a`` to ``b``, all (3,)."""
    along, length = 0.0, 0.0
    for c in range(3):
        along += (x[c] - a[c]) * (b[c] - a[c])
        length += (b[c] - a[c]) ** 2
    t = min(max(along / length, 0.0), 1.0) if length > 0.0 else 0.0
    squared = 0.0
    for c in range(3):
        squared += (x[c] - a[c] - t * (b[c] - a[c])) ** 2
    return squared


@njit(cache=True, nogil=True)
def vertices_under_brush(
    start: np.ndarray,
    neighbour: np.ndarray,
    U: np.ndarray,
    seeds: np.ndarray,
    a: np.ndarray,
    b: np.ndarray,
    radius: float,
) -> np.ndarray:
    """Vertices connected to the seeds within ``radius`` of the segment a to b.

    The front walks over edges and stops at the border of the capsule, so a brush on one side of a
    thin wall leaves the other side alone.

    Parameters
    ----------
    start : (n + 1,) int array
    neighbour : (k,) int array
        The one-ring graph of :func:`apd_viewer.geometry.mesh.operators.vertex_neighbours`.
    U : (n, 3) float array
    seeds : (s,) int array
        Corners of the faces that were hit; at least one.
    a, b : (3,) float array
        Last hit and this hit.
    radius : float
        In mesh units.

    Returns
    -------
    covered : (c,) int32 array
        Without repetition, seeds first. Never empty: the seed nearest to ``b`` is always in it, so
        that a brush finer than the mesh still paints.
    """
    reached = np.zeros(U.shape[0], dtype=np.bool_)
    covered = np.empty(U.shape[0], dtype=np.int32)
    count = 1
    covered[0] = _nearest_vertex(U, seeds, b)
    reached[covered[0]] = True
    for v in seeds:
        if not reached[v] and _squared_distance(U[v], a, b) <= radius * radius:
            reached[v] = True
            covered[count] = v
            count += 1
    head = 0
    while head < count:
        v = covered[head]
        head += 1
        for e in range(start[v], start[v + 1]):
            w = neighbour[e]
            if not reached[w] and _squared_distance(U[w], a, b) <= radius * radius:
                reached[w] = True
                covered[count] = w
                count += 1
    return covered[:count].copy()


@njit(cache=True, nogil=True)
def _nearest_vertex(U: np.ndarray, candidates: np.ndarray, x: np.ndarray) -> int:
    """The vertex among ``candidates``, an (s,) int array, nearest to the point ``x``."""
    best, nearest = np.inf, candidates[0]
    for v in candidates:
        squared = _squared_distance(U[v], x, x)
        if squared < best:
            best, nearest = squared, v
    return nearest
