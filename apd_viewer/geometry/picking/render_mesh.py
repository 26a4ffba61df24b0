"""Triangles for the renderer, with vertices duplicated along sharp edges."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.edges_and_components import BOUNDARY, _normal, join, root
from apd_viewer.geometry.mesh.normals import CornerNormals

_NONE = frozen(np.empty((0, 3, 3), dtype=np.float32))
SHARP = np.deg2rad(30.0)  # least angle between the normals of two triangles at a sharp edge


@dataclass(frozen=True, eq=False)
class RenderMesh:
    """Triangles and vertices for the renderer, unchanged while a mesh deforms.

    Attributes
    ----------
    F : (m, 3) int32 array
        Render vertices of the triangles: the first n are the vertices of the mesh.
    repeated_vertices : (k,) int32 array
        For each render vertex from n on the vertex that it repeats.
    joined : (m, 3) int32 array
        The triangles of the mesh, with the vertices at a seam named by one of them.
    leading : (m, 3) int32 array
        The triangles of the renderer, with render vertices of one normal named by one of them.
    source : (n + k,) int32 array
        For each render vertex the one that its normal is named by; empty if each has its own.
    used : (n,) bool array
        Whether a triangle has the vertex.
    local : (m, 3, 3) float32 array
        Normals of the corners in the frames of their triangles; empty if the normals follow from the shape.
    """

    F: np.ndarray
    repeated_vertices: np.ndarray
    joined: np.ndarray
    leading: np.ndarray
    source: np.ndarray
    used: np.ndarray
    local: np.ndarray = field(default_factory=lambda: _NONE)

    def with_normals(self, normals: CornerNormals) -> RenderMesh:
        """The mesh with normals of a file, and vertices duplicated where they differ."""
        n = len(self.used)
        F, copied, _ = map(frozen, _split_vertices(self.F, normals.group.ravel(), n))
        own = frozen(np.empty(0, dtype=np.int32))
        return RenderMesh(F, copied, self.joined, F, own, self.used, normals.local)

    def with_sharp_edges(self, V: np.ndarray, opposite: np.ndarray) -> RenderMesh:
        """The mesh with vertices duplicated along the sharp edges of ``V`` (n, 3).

        Parameters
        ----------
        V : (n, 3) float array
        opposite : (m, 3) int32 array
            The ``opposite_half_edges`` of ``joined``.
        """
        group = _smoothing_groups(V, self.joined, opposite, np.cos(SHARP))
        if not len(group):
            return self
        F, copied, lead = _split_vertices(self.F, group, len(V))
        leading, source = lead[group].reshape(F.shape), np.arange(len(V) + len(copied), dtype=np.int32)
        source[F] = leading
        if np.array_equal(leading, F):
            leading, source = F, np.empty(0, dtype=np.int32)
        F, copied, leading, source = map(frozen, (F, copied, leading, source))
        return RenderMesh(F, copied, self.joined, leading, source, self.used)

    def with_seams(self, group: np.ndarray) -> RenderMesh:
        """The mesh with vertices duplicated where corners (m, 3) differ in ``group``.

        Normals stay continuous there.
        """
        n, before = len(self.used), len(self.used) + len(self.repeated_vertices)
        F, copied, _ = _split_vertices(self.F, group.ravel(), before)
        source = self.source if len(self.source) else np.arange(before, dtype=np.int32)
        vertex = np.append(np.arange(n), self.repeated_vertices)
        arrays = F, np.append(self.repeated_vertices, vertex[copied]), np.append(source, source[copied])
        F, copied, source = (frozen(array.astype(np.int32)) for array in arrays)
        return replace(self, F=F, repeated_vertices=copied, source=source)

    def write_render_arrays(
        self, U: np.ndarray, origin: np.ndarray, points: np.ndarray, normals: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Write the renderer's arrays for the shape ``U``.

        Parameters
        ----------
        U : (n, 3) float64 array, read-only
        origin : (3,) float array
        points, normals : (n + k, 3) float32 arrays
            Overwritten: with the positions seen from ``origin``, and with unit normals weighted by the areas
            of the triangles, or turned with these from rest; zero at vertices without area.

        Returns
        -------
        low, high : (3,) float arrays
            The box around the triangles, seen from ``origin``.
        """
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        kept = self.joined, self.leading, self.repeated_vertices, self.source, self.used
        write_render_arrays(U, *kept, origin, points, normals, low, high)
        if len(self.local):
            _turn_normals(points, self.leading, self.source, self.local, normals)
        return low, high


@njit(cache=True, nogil=True)
def _smoothing_groups(V: np.ndarray, F: np.ndarray, opposite: np.ndarray, least: float) -> np.ndarray:
    """Smoothing group, as a corner, of each corner (3 m,); empty without sharp edges.

    Two corners at a vertex are in one group if edges with a cosine of at least ``least`` lead from the one
    triangle to the other. A triangle without area has no sharp edges.
    """
    N = np.empty((len(F), 3))
    for t in range(len(F)):
        N[t] = _normal(V, F, t)
    smooth, sharp = np.zeros(opposite.shape, dtype=np.bool_), False
    for t in range(len(F)):
        for c in range(3):
            h = opposite[t, c]
            if h >= 0:
                s = h // 3
                side = -1.0 if F[s, h % 3] == F[t, c] else 1.0
                cosine = N[t, 0] * N[s, 0] + N[t, 1] * N[s, 1] + N[t, 2] * N[s, 2]
                flat = not N[t].any() or not N[s].any()
                smooth[t, c] = flat or side * cosine >= least
            sharp |= h != BOUNDARY and not smooth[t, c]
    if not sharp:
        return np.empty(0, dtype=np.int32)
    group = np.arange(F.size).astype(np.int32)
    for t in range(len(F)):
        for c in range(3):
            if smooth[t, c]:
                s, d = opposite[t, c] // 3, opposite[t, c] % 3
                same = F[s, d] == F[t, c]
                join(group, 3 * t + c, 3 * s + (d if same else (d + 1) % 3))
                join(group, 3 * t + (c + 1) % 3, 3 * s + ((d + 1) % 3 if same else d))
    for k in range(len(group)):
        group[k] = root(group, k)
    return group


@njit(cache=True, nogil=True)
def _split_vertices(F: np.ndarray, group: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Render triangles, duplicated vertices, and the leading vertex of each group."""
    split, copied = np.empty_like(F), np.empty(F.size, dtype=np.int32)
    lead = np.full(F.size, -1, dtype=np.int32)
    # Linked list of the render vertices of each vertex, starting with the vertex itself.
    owner, following = np.full(n + F.size, -1, dtype=np.int32), np.full(n + F.size, -1, dtype=np.int32)
    count = 0
    for t in range(len(F)):
        for c in range(3):
            g, r = group[3 * t + c], F[t, c]
            while owner[r] >= 0 and owner[r] != g:
                if following[r] < 0:
                    copied[count], following[r] = F[t, c], n + count
                    count += 1
                r = following[r]
            owner[r] = g
            split[t, c] = r
            if lead[g] < 0:
                lead[g] = r
    return split, copied[:count].copy(), lead


@njit(cache=True, nogil=True)
def write_render_arrays(
    U: np.ndarray,
    joined: np.ndarray,
    leading: np.ndarray,
    repeated_vertices: np.ndarray,
    source: np.ndarray,
    used: np.ndarray,
    origin: np.ndarray,
    points: np.ndarray,
    normals: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
) -> None:
    """Write positions, normals and their bounding box.

    See :meth:`RenderMesh.write_render_arrays`.
    """
    ox, oy, oz = origin[0], origin[1], origin[2]
    lx = ly = lz = np.inf
    hx = hy = hz = -np.inf
    for v in range(U.shape[0]):
        x, y, z = U[v, 0] - ox, U[v, 1] - oy, U[v, 2] - oz
        points[v, 0], points[v, 1], points[v, 2] = x, y, z
        normals[v, 0] = normals[v, 1] = normals[v, 2] = 0.0
        if used[v]:
            lx, ly, lz = min(lx, x), min(ly, y), min(lz, z)
            hx, hy, hz = max(hx, x), max(hy, y), max(hz, z)
    low[0], low[1], low[2] = lx, ly, lz
    high[0], high[1], high[2] = hx, hy, hz
    for i in range(repeated_vertices.shape[0]):
        v = U.shape[0] + i
        for c in range(3):
            points[v, c] = points[repeated_vertices[i], c]
            normals[v, c] = 0.0
    for t in range(joined.shape[0]):
        i, j, k = joined[t, 0], joined[t, 1], joined[t, 2]
        ax, ay, az = U[j, 0] - U[i, 0], U[j, 1] - U[i, 1], U[j, 2] - U[i, 2]
        bx, by, bz = U[k, 0] - U[i, 0], U[k, 1] - U[i, 1], U[k, 2] - U[i, 2]
        # Rounded to single precision before summation: a double-precision sum would be rounded each time.
        nx, ny, nz = (
            np.float32(ay * bz - az * by),
            np.float32(az * bx - ax * bz),
            np.float32(ax * by - ay * bx),
        )
        for c in range(3):
            v = leading[t, c]
            normals[v, 0] += nx
            normals[v, 1] += ny
            normals[v, 2] += nz
    for v in range(U.shape[0] + repeated_vertices.shape[0]):
        nx, ny, nz = normals[v, 0], normals[v, 1], normals[v, 2]
        length = np.sqrt(nx * nx + ny * ny + nz * nz)
        if length > 0.0:
            normals[v, 0] = nx / length
            normals[v, 1] = ny / length
            normals[v, 2] = nz / length
    for v in range(source.shape[0]):
        for c in range(3):
            normals[v, c] = normals[source[v], c]


@njit(cache=True, nogil=True)
def _turn_normals(
    points: np.ndarray, F: np.ndarray, source: np.ndarray, local: np.ndarray, normals: np.ndarray
) -> None:
    """Rotate the normals ``local`` with their triangles, except those without area."""
    P, turned, across = points, np.zeros(normals.shape, dtype=np.float32), np.empty(3)
    for t in range(len(F)):
        i, j, k = F[t, 0], F[t, 1], F[t, 2]
        ax, ay, az = P[j, 0] - P[i, 0], P[j, 1] - P[i, 1], P[j, 2] - P[i, 2]
        bx, by, bz = P[k, 0] - P[i, 0], P[k, 1] - P[i, 1], P[k, 2] - P[i, 2]
        nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        area, edge = np.sqrt(nx * nx + ny * ny + nz * nz), np.sqrt(ax * ax + ay * ay + az * az)
        if area > 0.0:
            # Local frame with a normal as long as the area, to weight the normals of several triangles.
            ax, ay, az = ax / edge, ay / edge, az / edge
            across[0], across[1], across[2] = ny * az - nz * ay, nz * ax - nx * az, nx * ay - ny * ax
            for c in range(3):
                x, y, z = local[t, c, 0], local[t, c, 1], local[t, c, 2]
                v = F[t, c]
                turned[v, 0] += x * area * ax + y * across[0] + z * nx
                turned[v, 1] += x * area * ay + y * across[1] + z * ny
                turned[v, 2] += x * area * az + y * across[2] + z * nz
    for v in range(len(turned)):
        x, y, z = turned[v, 0], turned[v, 1], turned[v, 2]
        length = np.sqrt(x * x + y * y + z * z)
        if length > 0.0:
            normals[v, 0], normals[v, 1], normals[v, 2] = x / length, y / length, z / length
    for v in range(source.shape[0]):
        for c in range(3):
            normals[v, c] = normals[source[v], c]
