"""Double-walled vessels: closed surfaces enclosing a wall instead of the capacity."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.linalg.kernels import njit
from apd_viewer.geometry.mesh.arrays import diagonal, mesh_size
from apd_viewer.geometry.mesh.edges_and_components import (
    join,
    missing_volume_reason,
    opposite_half_edges,
    root,
)
from apd_viewer.geometry.mesh.hole_caps import Caps, capped_volume
from apd_viewer.geometry.mesh.operators import volume
from apd_viewer.geometry.picking.picking import block_boxes, ray_hit

# Largest wall thickness in mesh diagonals: 0.009 for a 1 mm cup, 0.04 thick glass, 0.12 a bottle's body.
_THIN = 0.05

# Each ray cast tests all block boxes: 200,000 triangles take about a second.
MOST_TRIANGLES = 200_000

# Least area fraction with a near, parallel opposite wall: 0.98 for a 1 mm cup with a flat rim.
_FACING = 0.8
_PARALLEL = -0.7  # largest cosine between the normals of opposite walls

# Bounds of the area-weighted 10th and 90th percentiles of the thickness, relative to its median.
_SPREAD = 0.5, 2.0

# Near the rim, the path along the surface to the opposite wall is shorter than this many thicknesses.
_AROUND = 4.0

# Largest deviation of a rim from a plane, relative to the rim's bounding-box diagonal.
_UNEVEN = 0.1

# Tolerance of outer volume = capacity + material, as a fraction of the material: rims are not quite planar.
_UNACCOUNTED = 0.3


class DoubleWall(NamedTuple):
    """Wall of a vessel with an outer and an inner surface, mesh units.

    Attributes
    ----------
    thickness : float
        Mean distance of the surfaces.
    material : float
        Volume between them.
    capacity : float
        Volume inside the inner one, up to its rims.
    openings : int
        How many rims there are.
    """

    thickness: float
    material: float
    capacity: float
    openings: int


def double_wall(
    V: np.ndarray, F: np.ndarray, component: np.ndarray, areas: np.ndarray, signed_volume: float
) -> DoubleWall | None:
    """Double wall of a closed surface; None if it has none.

    Parameters
    ----------
    V : (k, 3) float array
    F : (m, 3) int array
        Welded triangles.
    component : (m,) int array
        Connected piece of each triangle.
    areas : (m,) float array
        Of the triangles.
    signed_volume : float
        Signed volume of all.
    """
    found = _wall_and_inner_side(V, F, component, areas, signed_volume)
    return None if found is None else found[0]


def is_too_large_for_double_wall(
    V: np.ndarray, F: np.ndarray, component: np.ndarray, areas: np.ndarray, signed_volume: float
) -> bool:
    """True if a surface may be a double wall, and has too many triangles to tell.

    Parameters as of :func:`double_wall`.
    """
    is_large = len(F) > MOST_TRIANGLES
    return is_large and _thin_components(V, F, component, areas, signed_volume) is not None


def inner_surface(
    V: np.ndarray, F: np.ndarray, component: np.ndarray, areas: np.ndarray, signed_volume: float
) -> np.ndarray | None:
    """Triangles (k, 3) of the inner surface of a double wall, facing away from it.

    None without a double wall. Parameters as of :func:`double_wall`.
    """
    found = _wall_and_inner_side(V, F, component, areas, signed_volume)
    return None if found is None else found[1]


def _thin_components(
    V: np.ndarray, F: np.ndarray, component: np.ndarray, areas: np.ndarray, signed_volume: float
) -> tuple[list[_WallComponent], float] | None:
    """Components of a surface enclosing little, and how much; None for others."""
    area, is_one = float(areas.sum()), bool((component == component[0]).all())
    if is_one and 2.0 * abs(signed_volume) > _THIN * diagonal(V) * area:
        return None  # the volume of most meshes is too large for a wall
    parts = (
        [_WallComponent(np.ones(len(F), dtype=bool), signed_volume)]
        if is_one
        else _nested_components(V, F, component)
    )
    material = abs(parts[0].inside) - sum(abs(part.inside) for part in parts[1:]) if parts else 0.0
    return (parts, material) if 0.0 < 2.0 * material <= _THIN * mesh_size(V, F) * area else None


def _wall_and_inner_side(
    V: np.ndarray, F: np.ndarray, component: np.ndarray, areas: np.ndarray, signed_volume: float
) -> tuple[DoubleWall, np.ndarray] | None:
    """Double wall, and the triangles (k, 3) of its inner surface; None without one."""
    found = None if len(F) > MOST_TRIANGLES else _thin_components(V, F, component, areas, signed_volume)
    if found is None:
        return None
    parts, material = found
    thickness = 2.0 * material / float(areas.sum())
    T = _outward_triangles(F, parts)
    inner = _inner_side(V, T, areas, thickness)
    if inner is None:
        return None
    sides = T[inner], T[~inner]
    both = [_side_volume(V, side) for side in sides]
    if both[0][0] > both[1][0]:
        sides, both = sides[::-1], both[::-1]
    (within, openings), (around, _) = both
    capacity = -within
    if not capacity > material or abs(around - capacity - material) > _UNACCOUNTED * material:
        return None
    return DoubleWall(thickness, material, capacity, openings), sides[0]


class _WallComponent(NamedTuple):
    """Connected component: its triangles as a mask, and its signed volume."""

    triangles: np.ndarray
    inside: float


def _nested_components(V: np.ndarray, F: np.ndarray, component: np.ndarray) -> list[_WallComponent]:
    """Two components, the second inside the first, or an empty list."""
    names = np.flatnonzero(np.bincount(component))
    if len(names) > 2:
        return []
    parts = [_WallComponent(component == name, volume(V, F[component == name])) for name in names]
    parts.sort(key=lambda part: -abs(part.inside))
    around, within = (V[F[part.triangles].ravel()] for part in parts)
    nested = (around.min(axis=0) < within.min(axis=0)) & (within.max(axis=0) < around.max(axis=0))
    return parts if nested.all() else []


def _outward_triangles(F: np.ndarray, parts: list[_WallComponent]) -> np.ndarray:
    """Triangles ``F`` (m, 3) facing away from the wall; inner ones face inwards."""
    T = F.copy()
    for k, (triangles, inside) in enumerate(parts):
        if (inside < 0.0) == (k == 0):
            T[triangles] = T[triangles][:, ::-1]
    return T


def _inner_side(V: np.ndarray, T: np.ndarray, areas: np.ndarray, thickness: float) -> np.ndarray | None:
    """Mask of the triangles ``T`` (m, 3) on one side of a wall; None without a wall."""
    normals = np.cross(V[T[:, 1]] - V[T[:, 0]], V[T[:, 2]] - V[T[:, 0]])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), np.finfo(float).tiny)[:, None]
    middles = V[T].mean(axis=1)
    away, partner = opposite_triangles(V, T, middles, normals, block_boxes(V, T), 1e-3 * thickness)
    facing = (partner >= 0) & (np.einsum("ij,ij->i", normals, normals[partner]) < _PARALLEL)
    total, facing = float(areas.sum()), facing & (away < 3.0 * thickness)
    if areas[facing].sum() < _FACING * total:
        return None
    order = np.argsort(away[facing])
    fraction = np.cumsum(areas[facing][order]) / areas[facing].sum()
    low, middle, high = away[facing][order][np.searchsorted(fraction, [0.1, 0.5, 0.9])]
    if low < _SPREAD[0] * middle or high > _SPREAD[1] * middle:
        return None
    beside = opposite_half_edges(T.astype(np.int32), len(V)) // 3
    side = wall_sides(beside, middles, normals, partner, facing, _AROUND * middle)
    size = np.bincount(side, areas, minlength=len(T))
    first, second = np.argsort(-size)[:2]
    if size[first] + size[second] < 0.5 * total or size[second] <= 0.0:
        return None
    start = np.where(side == first, 1, np.where(side == second, 2, 0))
    return grown_sides(beside, start) == 1


def _side_volume(V: np.ndarray, T: np.ndarray) -> tuple[float, int]:
    """Signed volume of a side with capped rims, and their number; NaN if not planar."""
    opposite = opposite_half_edges(T, len(V))
    if missing_volume_reason(T, opposite) is None:
        return volume(V, T), 0
    caps = Caps.from_triangles(T, opposite)
    inside = capped_volume(caps, V, T)
    if caps is None or inside is None:
        return np.nan, 0
    for rim in np.split(V[caps.ends[:, 0]], caps.start[1:]):
        deviations = np.linalg.svd(rim - rim.mean(axis=0), full_matrices=False)[2][-1]
        if np.ptp(rim @ deviations) > _UNEVEN * diagonal(rim):
            return np.nan, 0
    return inside, caps.count


# Rim triangles may be larger than the wall thickness: triangles within this many steps also count as near.
_HOPS = 3


@njit(cache=True, nogil=True)
def opposite_triangles(
    V: np.ndarray,
    T: np.ndarray,
    middles: np.ndarray,
    normals: np.ndarray,
    block_boxes: np.ndarray,
    offset: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Distance of the nearest triangle behind each triangle, and its index or -1."""
    away, partner = np.full(len(T), np.inf), np.full(len(T), -1)
    for i in range(len(T)):
        face, distance, _, _ = ray_hit(middles[i] - offset * normals[i], -normals[i], V, T, block_boxes)
        if face >= 0:
            away[i], partner[i] = distance + offset, face
    return away, partner


@njit(cache=True, nogil=True)
def wall_sides(
    neighbours: np.ndarray,
    middles: np.ndarray,
    normals: np.ndarray,
    partner: np.ndarray,
    facing: np.ndarray,
    reach: float,
) -> np.ndarray:
    """Side label of each triangle; rim triangles keep labels of their own."""
    m = len(neighbours)
    side, wall = np.arange(m), np.zeros(m, dtype=np.bool_)
    queue, gone, hops, seen = np.zeros(m, np.int64), np.zeros(m), np.zeros(m, np.int64), np.full(m, -1)
    for i in range(m):
        queue[0], gone[i], hops[i], seen[i], begin, end = i, 0.0, 0, i, 0, 1
        while begin < end and seen[partner[i]] != i:
            at = queue[begin]
            begin += 1
            for c in range(3):
                other = neighbours[at, c]
                if other < 0 or seen[other] == i:
                    continue
                way = gone[at] + np.sqrt(((middles[other] - middles[at]) ** 2).sum())
                if way <= reach or hops[at] < _HOPS:
                    seen[other], gone[other], hops[other], queue[end] = i, way, hops[at] + 1, other
                    end += 1
        wall[i] = facing[i] and seen[partner[i]] != i
    for i in range(m):
        for c in range(3):
            other = neighbours[i, c]
            if other >= 0 and wall[i] and wall[other] and (normals[i] * normals[other]).sum() > -0.5:
                join(side, i, other)
    for i in range(m):
        side[i] = root(side, i)
    return side


@njit(cache=True, nogil=True)
def grown_sides(neighbours: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Sides 1 and 2 grown over the unassigned triangles until they meet."""
    side, queue, end = start.copy(), np.zeros(len(start), np.int64), 0
    for i in range(len(start)):
        if side[i]:
            queue[end] = i
            end += 1
    for begin in range(len(start)):
        if begin == end:
            break
        for other in neighbours[queue[begin]]:
            if other >= 0 and not side[other]:
                side[other] = side[queue[begin]]
                queue[end] = other
                end += 1
    return side
