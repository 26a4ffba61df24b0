"""Index of a mesh for drawing, picking and brushes.

One ray is answered faster by a look at every triangle: see :mod:`picking`. For a ray to
each of many vertices it is worth sorting the triangles first; then their order in a file does not matter.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numba import prange

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.linalg.threads import cores_for, parallel
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.edges_and_components import flood_fill, opposite_half_edges
from apd_viewer.geometry.mesh.normals import CornerNormals
from apd_viewer.geometry.mesh.operators import vertex_neighbours
from apd_viewer.geometry.picking.bounding_hierarchy import (
    BRANCHING,
    BRANCHING_BITS,
    BoundingVolumeHierarchy,
    bounding_hierarchy,
)
from apd_viewer.geometry.picking.picking import block_boxes, ray_hit, vertices_under_brush
from apd_viewer.geometry.picking.render_mesh import RenderMesh
from apd_viewer.geometry.picking.vertex_sets import border_loop, component_of, is_inside_polygon

_EDGE = 1e-9  # margin beyond an edge, so that rounding does not let a ray pass between two neighbours
# Triangles this close to a vertex, relative to its distance from the eye, do not hide it.
TOUCHING_DISTANCE = 1e-6
# A triangle with a smaller relative projection is edge-on and hides nothing.
_EDGE_ON = 1e-12


def is_visible(
    eye: np.ndarray,
    U: np.ndarray,
    boxes: BoundingVolumeHierarchy,
    ids: np.ndarray,
    touching: float = TOUCHING_DISTANCE,
) -> np.ndarray:
    """Mask of the vertices visible from a point.

    One is seen if no triangle that it is not a corner of meets the straight line to it. A triangle nearer to
    it than ``touching`` of its distance from the eye does not hide it, nor does one that is seen exactly
    edge-on.

    Parameters
    ----------
    eye : (3,) float array
    U : (n, 3) float array
    boxes : BoundingVolumeHierarchy
        The :func:`bounding_hierarchy` of the same ``U``.
    ids : (k,) int array
        The vertices, by the names that the triangles have for them.
    touching : float

    Returns
    -------
    (k,) bool array
    """
    eye = np.ascontiguousarray(eye, dtype=np.float64)
    seen = np.empty(len(ids), dtype=bool)
    with cores_for(len(U)):
        _mark_visible(
            eye, U, np.asarray(ids, dtype=np.int64), boxes.F, boxes.corners, boxes.level, 1.0 - touching, seen
        )
    return seen


@parallel()
def _mark_visible(
    eye: np.ndarray,
    U: np.ndarray,
    ids: np.ndarray,
    F: np.ndarray,
    corners: np.ndarray,
    level: np.ndarray,
    end: float,
    seen: np.ndarray,
) -> None:
    ox, oy, oz = eye[0], eye[1], eye[2]
    count, top = level[1], len(level) - 2
    for i in prange(len(ids)):
        v = ids[i]
        dx, dy, dz = U[v, 0] - ox, U[v, 1] - oy, U[v, 2] - oz
        ix, iy, iz = _inverse(dx), _inverse(dy), _inverse(dz)
        # Stackless traversal: a box is followed by the largest one that starts after its end.
        b, size, hidden = 0, top, False
        while b < count and not hidden:
            k = level[size] + (b >> (BRANCHING_BITS * size))
            ax, bx = (corners[k, 0, 0] - ox) * ix, (corners[k, 1, 0] - ox) * ix
            ay, by = (corners[k, 0, 1] - oy) * iy, (corners[k, 1, 1] - oy) * iy
            az, bz = (corners[k, 0, 2] - oz) * iz, (corners[k, 1, 2] - oz) * iz
            near = max(max(min(ax, bx), min(ay, by)), max(min(az, bz), 0.0))
            far = min(min(max(ax, bx), max(ay, by)), min(max(az, bz), 1.0))
            if near <= far and size > 0:
                size -= 1
                continue
            if near <= far:
                for t in range(BRANCHING * b, min(BRANCHING * (b + 1), len(F))):
                    if F[t, 0] != v and F[t, 1] != v and F[t, 2] != v:
                        hidden |= _blocks_segment(ox, oy, oz, dx, dy, dz, U, F[t, 0], F[t, 1], F[t, 2], end)
            b = ((b >> (BRANCHING_BITS * size)) + 1) << (BRANCHING_BITS * size)
            while size < top and b & ((1 << (BRANCHING_BITS * (size + 1))) - 1) == 0:
                size += 1
        seen[i] = not hidden


@njit(inline="always")
def _inverse(d: float) -> float:
    """Reciprocal of ``d``, or a huge number for zero: 0 * inf would give NaN."""
    return 1.0 / d if abs(d) > 1e-290 else 1e290


@njit(inline="always")
def _blocks_segment(
    ox: float,
    oy: float,
    oz: float,
    dx: float,
    dy: float,
    dz: float,
    U: np.ndarray,
    i: int,
    j: int,
    k: int,
    end: float,
) -> bool:
    """True if a triangle blocks the segment ``o + t d`` for ``t`` from 0 to ``end``."""
    ex, ey, ez = U[j, 0] - U[i, 0], U[j, 1] - U[i, 1], U[j, 2] - U[i, 2]
    gx, gy, gz = U[k, 0] - U[i, 0], U[k, 1] - U[i, 1], U[k, 2] - U[i, 2]
    px, py, pz = dy * gz - dz * gy, dz * gx - dx * gz, dx * gy - dy * gx
    det = ex * px + ey * py + ez * pz
    size = (ex * ex + ey * ey + ez * ez) * (gx * gx + gy * gy + gz * gz) * (dx * dx + dy * dy + dz * dz)
    if det * det <= _EDGE_ON**2 * size:
        return False
    sx, sy, sz = ox - U[i, 0], oy - U[i, 1], oz - U[i, 2]
    u = (sx * px + sy * py + sz * pz) / det
    if u < -_EDGE or u > 1.0 + _EDGE:
        return False
    qx, qy, qz = sy * ez - sz * ey, sz * ex - sx * ez, sx * ey - sy * ex
    v = (dx * qx + dy * qy + dz * qz) / det
    if v < -_EDGE or u + v > 1.0 + _EDGE:
        return False
    return 0.0 < (gx * qx + gy * qy + gz * qz) / det < end


@dataclass(frozen=True, eq=False)
class SurfaceIndex:
    """Index of a mesh, unchanged while it deforms.

    Attributes
    ----------
    F : (m, 3) int32 array
        The triangles.
    joined : (m, 3) int32 array
        The same, with the vertices at a seam named by one of them; the very same array if there is no seam.
    source : (n,) int32 array
        For each vertex the one that its place is named by; empty if there is no seam.
    used : (n,) bool array
        Whether a triangle has the vertex.
    start, neighbour : int32 arrays
        The one-rings across seams: see :func:`apd_viewer.geometry.mesh.operators.vertex_neighbours`.
    opposite : (m, 3) int32 array
        The :func:`.opposite_half_edges` of ``joined``.
    smooth, sharp : RenderMesh
        What is drawn, without and with the sharp edges of the rest shape.
    file_shaded : RenderMesh or None
        What is drawn with the normals of the file, where it has some.
    """

    F: np.ndarray
    joined: np.ndarray
    source: np.ndarray
    used: np.ndarray
    start: np.ndarray
    neighbour: np.ndarray
    opposite: np.ndarray
    smooth: RenderMesh
    sharp: RenderMesh
    file_shaded: RenderMesh | None = None

    @classmethod
    def from_triangles(
        cls,
        F: np.ndarray,
        n: int,
        joined_F: np.ndarray | None = None,
        V: np.ndarray | None = None,
        normals: CornerNormals | None = None,
        opposite: np.ndarray | None = None,
    ) -> SurfaceIndex:
        """Index of the triangles ``F`` (m, 3) of ``n`` vertices.

        Parameters
        ----------
        F : (m, 3) int array
        n : int
        joined_F : (m, 3) int array, optional
            The triangles with the vertices at a seam named by one of them. An STL file is nothing but seams.
        V : (n, 3) float array, optional
            The rest shape, for its sharp edges.
        normals : CornerNormals, optional
            Those of the file.
        opposite : (m, 3) int32 array, optional
            The :func:`.opposite_half_edges` of ``joined_F``, where they are known already.
        """
        own = np.array(F, dtype=np.int32, order="C")
        joined, source = own, np.empty(0, dtype=np.int32)
        if joined_F is not None and not np.array_equal(joined_F, F):
            joined = np.array(joined_F, dtype=np.int32, order="C")
            source = np.arange(n, dtype=np.int32)
            source[own] = joined
        used = np.zeros(n, dtype=bool)
        used[own] = True
        own, joined, source, used = map(frozen, (own, joined, source, used))
        if opposite is None:
            opposite = frozen(opposite_half_edges(joined, n))
        smooth = RenderMesh(own, frozen(np.empty(0, dtype=np.int32)), joined, joined, source, used)
        sharp = smooth if V is None else smooth.with_sharp_edges(V, opposite)
        start, neighbour = map(frozen, vertex_neighbours(joined, n))
        filed = None if normals is None else smooth.with_normals(normals)
        return cls(own, joined, source, used, start, neighbour, opposite, smooth, sharp, filed)

    @cached_property
    def representative_vertices(self) -> np.ndarray:
        """Used vertices, one for each seam position, ascending, (k,) int array."""
        named = np.zeros(len(self.used), dtype=bool)
        named[self.joined] = True
        return np.flatnonzero(named)

    def render_mesh(self, sharp: bool, with_file_normals: bool = False) -> RenderMesh:
        """Mesh for the renderer with the file's normals, or sharp or smooth edges."""
        return (
            self.file_shaded
            if with_file_normals and self.file_shaded is not None
            else self.sharp
            if sharp
            else self.smooth
        )

    def block_boxes(self, U: np.ndarray) -> np.ndarray:
        """Bounding boxes for :meth:`ray_hit`, computed once per shape ``U``."""
        return block_boxes(U, self.F)

    def ray_hit(
        self, origin: np.ndarray, direction: np.ndarray, U: np.ndarray, block_boxes: np.ndarray
    ) -> tuple[int, float, float, float]:
        """Ray hit on the shape ``U`` with boxes ``block_boxes``: :func:`picking.ray_hit`."""
        return ray_hit(origin, direction, U, self.F, block_boxes)

    def is_inside_polygon(self, points: np.ndarray, polygon: np.ndarray) -> np.ndarray:
        """Mask (k,) of ``points`` (k, 2) inside a ``polygon`` (p, 2)."""
        return is_inside_polygon(points, polygon)

    def visibility_tree(self, U: np.ndarray) -> BoundingVolumeHierarchy:
        """Search tree for :meth:`is_visible`, built once per shape ``U``."""
        return bounding_hierarchy(U, self.joined)

    def is_visible(
        self,
        eye: np.ndarray,
        U: np.ndarray,
        ids: np.ndarray,
        visibility_tree: BoundingVolumeHierarchy,
        touching: float = TOUCHING_DISTANCE,
    ) -> np.ndarray:
        """Mask (k,) of the vertices ``ids`` of ``U`` visible from ``eye`` (3,)."""
        return is_visible(eye, U, visibility_tree, ids, touching)

    def vertices_up_to_creases(self, U: np.ndarray, face: int, crease: float) -> np.ndarray:
        """Vertices around a face, up to creases sharper than ``crease`` radians."""
        return np.flatnonzero(flood_fill(self.joined, self.opposite, U, face, crease))

    def component(self, face: int) -> np.ndarray:
        """Vertices of the connected component of a face."""
        return np.flatnonzero(component_of(self.start, self.neighbour, self.joined[face, 0]))

    def border_loop(self, face: int) -> np.ndarray:
        """Vertices of the border loop nearest to a face; empty without a border."""
        F, seeds = self.joined, self.joined[face]
        return np.flatnonzero(border_loop(F, self.opposite, self.start, self.neighbour, seeds))

    def vertices_under_brush(
        self, U: np.ndarray, faces: tuple[int, int], a: np.ndarray, b: np.ndarray, radius: float
    ) -> np.ndarray:
        """Vertices of ``U`` under a brush from ``a`` to ``b``, (3,) each, on two faces.

        It crosses seams; of the vertices there only one of each place is named.
        """
        return vertices_under_brush(
            self.start, self.neighbour, U, self.joined[list(faces)].ravel(), a, b, radius
        )
