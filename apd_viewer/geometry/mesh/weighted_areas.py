"""Areas and volume as functions of the positions, with gradients.

A gradient is gathered corner by corner, so that the cores can share the vertices among them.
"""

import numpy as np
from numba import prange

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.threads import parallel, sum_of_portions, sums_of_portions

# Rest areas below this fraction of the mean are rounding errors; their relative change is ignored.
SLIVER = 1e-9
# Triangles or vertices per parallel task.
_PORTION = 1024


class Patch:
    """A subset of the triangles of a mesh, with its corner lists.

    Parameters
    ----------
    F : (m, 3) int array
    n : int
        Number of vertices of the mesh.

    Attributes
    ----------
    F : (m, 3) uint32 array
    start : (n + 1,) uint32 array
    corner : (3 m,) uint32 array
        The corners at vertex i are ``corner[start[i]:start[i + 1]]``: ``3 t + c`` for corner c of triangle t.
    second, third : (3 m,) uint32 arrays
        The vertices that follow the one at each of ``corner`` in its triangle.
    """

    def __init__(self, F: np.ndarray, n: int) -> None:
        self.F = np.ascontiguousarray(F, dtype=np.uint32)
        self.start, self.corner, self.second, self.third = _corners(self.F, n)

    def area(self, U: np.ndarray) -> float:
        """Area at ``U`` (n, 3)."""
        return float(total_area(U, self.F))

    def volume_and_gradient(self, U: np.ndarray, g: np.ndarray) -> float:
        """Signed volume of a closed patch at ``U`` (n, 3); writes its gradient to ``g``."""
        return float(_volume_and_gradient(U, self.F, self.start, self.second, self.third, g))


class WeightedAreas:
    """Weighted sums of triangle areas, all evaluated in one pass.

    Parameters
    ----------
    patch : Patch
        All triangles.
    weight : (m, g) float32 array
        Weight of each triangle in each sum. The sum of all areas costs least, then those of few triangles.

    Attributes
    ----------
    count : int
        Number of sums.
    support : (n, g) bool array
        The vertices on which each sum depends.
    """

    def __init__(self, patch: Patch, weight: np.ndarray) -> None:
        self.count = weight.shape[1]
        self._patch, self._normals = patch, np.empty((0, 3))
        all_areas = np.flatnonzero((weight == 1.0).all(axis=0))[:1]
        self._all_areas = int(all_areas[0]) if len(all_areas) else -1
        counts = weight != 0.0
        counts[:, all_areas] = False
        self.support = _with_corners(patch.start, patch.corner, counts)
        self._weights = *row_nonzeros(counts), weight[counts]
        self._partial = row_nonzeros(self.support)
        self.support[:, all_areas] = True

    def values(self, U: np.ndarray) -> np.ndarray:
        """Weighted sums of areas, (g,), at ``U`` (n, 3)."""
        return _weighted_areas(U, self._patch.F, *self._weights, self._all_areas, self.count)

    def values_and_gradients(self, U: np.ndarray, g: np.ndarray) -> np.ndarray:
        """Sums (g,) at ``U`` (n, 3); their gradients are written into ``g`` (g, n, 3).

        Only the :attr:`support` of each is written.
        """
        patch = self._patch
        if len(self._normals) != len(patch.F):
            self._normals = np.empty((len(patch.F), 3))
        corners = patch.start, patch.corner, patch.second, patch.third
        return _weighted_areas_and_gradients(
            U, patch.F, *corners, *self._weights, *self._partial, self._all_areas, self._normals, g
        )

    def largest_tension(self, c: np.ndarray) -> float:
        """Largest ``|sum_k c_k weight_k|`` of all triangles."""
        return _largest_tension(*self._weights, self._all_areas, c)


def row_nonzeros(mask: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Row starts (n + 1,) and column indices of the True entries of a ``mask`` (n, k)."""
    starts = np.zeros(len(mask) + 1, dtype=np.uint32)
    starts[1:] = np.cumsum(np.count_nonzero(mask, axis=1))
    return starts, np.nonzero(mask)[1].astype(np.uint32)


@njit(cache=True, nogil=True)
def _with_corners(start: np.ndarray, corner: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """Mask (n, g) of the vertices of the triangles in the mask ``counts`` (m, g)."""
    support = np.zeros((len(start) - 1, counts.shape[1]), dtype=np.bool_)
    for i in range(len(support)):
        for e in range(start[i], start[i + 1]):
            for k in range(counts.shape[1]):
                support[i, k] |= counts[corner[e] // 3, k]
    return support


def triangle_weights(F: np.ndarray, weight: np.ndarray | None, is_smooth: bool) -> np.ndarray:
    """Mean or least ``weight`` (n,) of the corners of each triangle, (m,) float32."""
    if weight is None:
        return np.ones(len(F), dtype=np.float32)
    corners = weight.astype(np.float32)[F]
    return corners.mean(axis=1) if is_smooth else corners.min(axis=1)


@njit(cache=True, nogil=True)
def _corners(F: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Corners at each vertex, from ``start`` (n + 1,), and what follows each."""
    start = np.zeros(n + 1, dtype=np.uint32)
    for t in range(len(F)):
        for c in range(3):
            start[F[t, c] + 1] += 1
    for i in range(n):
        start[i + 1] += start[i]
    following = start[:-1].copy()
    corner = np.empty(3 * len(F), dtype=np.uint32)
    second, third = np.empty_like(corner), np.empty_like(corner)
    for t in range(len(F)):
        for c in range(3):
            at = following[F[t, c]]
            following[F[t, c]] += 1
            corner[at], second[at], third[at] = 3 * t + c, F[t, (c + 1) % 3], F[t, (c + 2) % 3]
    return start, corner, second, third


@parallel()
def total_area(U: np.ndarray, F: np.ndarray) -> float:
    """Area of the triangles ``F`` (m, 3) at ``U`` (n, 3)."""
    count = (len(F) + _PORTION - 1) // _PORTION
    doubles = np.empty(count)
    for portion in prange(count):
        double = 0.0
        for t in range(portion * _PORTION, min(len(F), (portion + 1) * _PORTION)):
            i, j, k = F[t, 0], F[t, 1], F[t, 2]
            ax, ay, az = U[j, 0] - U[i, 0], U[j, 1] - U[i, 1], U[j, 2] - U[i, 2]
            bx, by, bz = U[k, 0] - U[i, 0], U[k, 1] - U[i, 1], U[k, 2] - U[i, 2]
            x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
            double += np.sqrt(x * x + y * y + z * z)
        doubles[portion] = double
    return 0.5 * sum_of_portions(doubles)


@njit(cache=True, nogil=True)
def edge_lengths(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Lengths (m, 3) of the edges of the triangles ``F`` (m, 3).

    They are those from the first corner to the second and third, and from the second to the third.
    """
    lengths = np.empty((len(F), 3))
    for t in range(len(F)):
        i, j, k = F[t, 0], F[t, 1], F[t, 2]
        ax, ay, az = V[j, 0] - V[i, 0], V[j, 1] - V[i, 1], V[j, 2] - V[i, 2]
        bx, by, bz = V[k, 0] - V[i, 0], V[k, 1] - V[i, 1], V[k, 2] - V[i, 2]
        x, y, z = bx - ax, by - ay, bz - az
        lengths[t, 0] = np.sqrt(ax * ax + ay * ay + az * az)
        lengths[t, 1] = np.sqrt(bx * bx + by * by + bz * bz)
        lengths[t, 2] = np.sqrt(x * x + y * y + z * z)
    return lengths


@parallel()
def shape_readings(
    U: np.ndarray, F: np.ndarray, rest: np.ndarray, lengths: np.ndarray, least: float
) -> tuple[float, float, float, float, float]:
    """Area, signed volume, area change and strain of edges, in one pass.

    Parameters
    ----------
    U : (n, 3) float array
    F : (m, 3) int array
    rest, lengths : (m,) and (m, 3) float arrays
        Areas of the triangles at rest, and :func:`edge_lengths`.
    least : float
        Area at rest below which the change of a triangle does not count.

    Returns
    -------
    area, volume : float
    change : float
        Largest relative area change of a triangle, up or down.
    extreme : float
        Strain of the edge whose length has changed most, negative where it is shortened.
    strain : float
        Mean absolute strain of a triangle's edges times its rest area, summed. Edges without length at rest
        do not count; the rest area of their triangles is zero.
    """
    ox, oy, oz = U[F[0, 0], 0], U[F[0, 0], 1], U[F[0, 0], 2]
    count = (len(F) + _PORTION - 1) // _PORTION
    areas, volumes, changes = np.empty(count), np.empty(count), np.zeros(count)
    extremes, strains = np.empty(count), np.empty(count)
    for portion in prange(count):
        area = volume = largest = extreme = weighted = 0.0
        for t in range(portion * _PORTION, min(len(F), (portion + 1) * _PORTION)):
            i, j, k = F[t, 0], F[t, 1], F[t, 2]
            ax, ay, az = U[j, 0] - U[i, 0], U[j, 1] - U[i, 1], U[j, 2] - U[i, 2]
            bx, by, bz = U[k, 0] - U[i, 0], U[k, 1] - U[i, 1], U[k, 2] - U[i, 2]
            x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
            own = 0.5 * np.sqrt(x * x + y * y + z * z)
            area += own
            volume += (U[i, 0] - ox) * x + (U[i, 1] - oy) * y + (U[i, 2] - oz) * z
            if rest[t] > least:
                largest = max(largest, abs(own / rest[t] - 1.0))
            x, y, z = bx - ax, by - ay, bz - az
            squares = ax * ax + ay * ay + az * az, bx * bx + by * by + bz * bz, x * x + y * y + z * z
            for c in range(3):
                strain = np.sqrt(squares[c]) / lengths[t, c] - 1.0 if lengths[t, c] > 0.0 else 0.0
                weighted += rest[t] * abs(strain)
                if abs(strain) > abs(extreme):
                    extreme = strain
        areas[portion], volumes[portion], changes[portion] = area, volume, largest
        extremes[portion], strains[portion] = extreme, weighted
    extreme = 0.0
    for strain in extremes:
        if abs(strain) > abs(extreme):
            extreme = strain
    return (
        sum_of_portions(areas),
        sum_of_portions(volumes) / 6.0,
        changes.max(),
        extreme,
        sum_of_portions(strains) / 3.0,
    )


@parallel()
def _weighted_areas(
    U: np.ndarray,
    F: np.ndarray,
    first: np.ndarray,
    which: np.ndarray,
    weight: np.ndarray,
    all_areas: int,
    sums_count: int,
) -> np.ndarray:
    count = (len(F) + _PORTION - 1) // _PORTION
    sums, doubles = np.zeros((count, sums_count)), np.empty(count)
    for portion in prange(count):
        whole = 0.0
        for t in range(portion * _PORTION, min(len(F), (portion + 1) * _PORTION)):
            i, j, k = F[t, 0], F[t, 1], F[t, 2]
            ax, ay, az = U[j, 0] - U[i, 0], U[j, 1] - U[i, 1], U[j, 2] - U[i, 2]
            bx, by, bz = U[k, 0] - U[i, 0], U[k, 1] - U[i, 1], U[k, 2] - U[i, 2]
            x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
            double = np.sqrt(x * x + y * y + z * z)
            whole += double
            for e in range(first[t], first[t + 1]):
                sums[portion, which[e]] += weight[e] * (0.5 * double)
        doubles[portion] = whole
    values = sums_of_portions(sums)
    if all_areas >= 0:
        values[all_areas] = 0.5 * sum_of_portions(doubles)
    return values


@njit(cache=True, nogil=True)
def _largest_tension(
    first: np.ndarray, which: np.ndarray, weight: np.ndarray, all_areas: int, c: np.ndarray
) -> float:
    everywhere = c[all_areas] if all_areas >= 0 else 0.0
    largest = 0.0
    for t in range(len(first) - 1):
        tension = everywhere
        for e in range(first[t], first[t + 1]):
            tension += c[which[e]] * weight[e]
        largest = max(largest, abs(tension))
    return largest


@parallel()
def _weighted_areas_and_gradients(
    U: np.ndarray,
    F: np.ndarray,
    start: np.ndarray,
    corner: np.ndarray,
    second: np.ndarray,
    third: np.ndarray,
    first: np.ndarray,
    which: np.ndarray,
    weight: np.ndarray,
    support: np.ndarray,
    supported: np.ndarray,
    all_areas: int,
    normals: np.ndarray,
    g: np.ndarray,
) -> np.ndarray:
    # The gradient at a corner is half the cross product of the unit normal with the opposite edge; that of
    # a triangle without area is set to zero.
    count = (len(F) + _PORTION - 1) // _PORTION
    sums, doubles = np.zeros((count, len(g))), np.empty(count)
    for portion in prange(count):
        whole = 0.0
        for t in range(portion * _PORTION, min(len(F), (portion + 1) * _PORTION)):
            i, j, k = F[t, 0], F[t, 1], F[t, 2]
            ax, ay, az = U[j, 0] - U[i, 0], U[j, 1] - U[i, 1], U[j, 2] - U[i, 2]
            bx, by, bz = U[k, 0] - U[i, 0], U[k, 1] - U[i, 1], U[k, 2] - U[i, 2]
            x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
            double = np.sqrt(x * x + y * y + z * z)
            whole += double
            for e in range(first[t], first[t + 1]):
                sums[portion, which[e]] += weight[e] * (0.5 * double)
            h = 0.5 / double if double > 0.0 else 0.0
            normals[t, 0], normals[t, 1], normals[t, 2] = h * x, h * y, h * z
        doubles[portion] = whole
    for portion in prange((len(U) + _PORTION - 1) // _PORTION):
        part = np.zeros((len(g), 3))
        for i in range(portion * _PORTION, min(len(U), (portion + 1) * _PORTION)):
            sx = sy = sz = 0.0
            for c in range(start[i], start[i + 1]):
                t, j, k = corner[c] // 3, second[c], third[c]
                x, y, z = normals[t, 0], normals[t, 1], normals[t, 2]
                ex, ey, ez = U[k, 0] - U[j, 0], U[k, 1] - U[j, 1], U[k, 2] - U[j, 2]
                gx, gy, gz = y * ez - z * ey, z * ex - x * ez, x * ey - y * ex
                sx += gx
                sy += gy
                sz += gz
                for e in range(first[t], first[t + 1]):
                    s, w = which[e], weight[e]
                    part[s, 0] += w * gx
                    part[s, 1] += w * gy
                    part[s, 2] += w * gz
            if all_areas >= 0:
                g[all_areas, i, 0], g[all_areas, i, 1], g[all_areas, i, 2] = sx, sy, sz
            for e in range(support[i], support[i + 1]):
                s = supported[e]
                g[s, i, 0], g[s, i, 1], g[s, i, 2] = part[s, 0], part[s, 1], part[s, 2]
                part[s, 0] = part[s, 1] = part[s, 2] = 0.0
    values = sums_of_portions(sums)
    if all_areas >= 0:
        values[all_areas] = 0.5 * sum_of_portions(doubles)
    return values


@parallel()
def _volume_and_gradient(
    U: np.ndarray, F: np.ndarray, start: np.ndarray, second: np.ndarray, third: np.ndarray, g: np.ndarray
) -> float:
    # Measured from a vertex of the surface: far from the origin, the sum would lose digits to cancellation.
    ox, oy, oz = U[F[0, 0], 0], U[F[0, 0], 1], U[F[0, 0], 2]
    count = (len(U) + _PORTION - 1) // _PORTION
    volumes = np.empty(count)
    for portion in prange(count):
        volume = 0.0
        for i in range(portion * _PORTION, min(len(U), (portion + 1) * _PORTION)):
            gx = gy = gz = 0.0
            for e in range(start[i], start[i + 1]):
                j, k = second[e], third[e]
                bx, by, bz = U[j, 0] - ox, U[j, 1] - oy, U[j, 2] - oz
                cx, cy, cz = U[k, 0] - ox, U[k, 1] - oy, U[k, 2] - oz
                gx += by * cz - bz * cy
                gy += bz * cx - bx * cz
                gz += bx * cy - by * cx
            g[i, 0], g[i, 1], g[i, 2] = gx / 6.0, gy / 6.0, gz / 6.0
            # The volume is cubic in the positions, so that the sum of u.g counts it three times.
            volume += (U[i, 0] - ox) * gx + (U[i, 1] - oy) * gy + (U[i, 2] - oz) * gz
        volumes[portion] = volume
    return sum_of_portions(volumes) / 18.0
