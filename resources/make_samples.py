"""Make the sample meshes, their selections and their transforms.

Run ``python resources/make_samples.py [folder]``; without a folder the files land beside this script.
Nothing is random: the same script gives the same files.

Lengths are in centimetres, +Y is up, all objects stand on y = 0.

* The bottle is a cubic B-spline profile turned about the Y axis. Its rings carry a multiple of six vertices,
  in proportion to their circumference, so that triangles stay near equilateral up to both poles and no
  direction around the axis is special.
* The duck is the zero set of a few ellipsoids and tubes, blended. A fine contour of it is partitioned into
  equal cells [Valette and Chassery 2004]; the dual of the cells is the mesh, relaxed on the zero set.
* The cushion is such a zero set too: two bulging covers, and the piping along their seam.
* The cloth is a flat pattern, its edge turned under to a hem, and meshed by such cells of the hemmed cloth.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyvista as pv
import trimesh
from scipy.interpolate import BSpline
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import Delaunay, cKDTree
from scipy.spatial.distance import pdist

LICENCE = "CC0-1.0: dedicated to the public domain by the apd_viewer developers"
HELD, FREE, HANDLE = 0, 1, 2
Field = Callable[[np.ndarray], np.ndarray]  # such as the signed distance of points (n, 3) to a solid

# ---------------------------------------------------------------------------------------------- the bottle

BOTTLE_VOLUME = 500.0  # cm³, that is half a litre
BOTTLE_EDGE, NECK_EDGE = 0.215, 0.135  # cm; the neck has the finer detail
BOTTLE_BASE_TOP = 1.2  # cm: held below
BOTTLE_NECK_BOTTOM = 18.7  # cm: handle above

# (radius, height) of the spline's control points in cm, from the bottom's centre to the cap's: where they are
# close the edge is crisp. The finished bottle is scaled to its volume.
BOTTLE_PROFILE = [
    (0.0, 0.55), (0.7, 0.55), (1.4, 0.45), (1.95, 0.2), (2.28, 0.0), (2.58, 0.0), (2.86, 0.12),
    (3.1, 0.45), (3.2, 1.0), (3.21, 1.6), (3.21, 2.1), (3.16, 2.7), (3.08, 3.6), (3.03, 4.6),
    (3.03, 5.6), (3.08, 6.6), (3.16, 7.5), (3.22, 8.1), (3.28, 8.3), (3.28, 8.5), (3.17, 8.7),
    (3.16, 9.0), (3.16, 10.5), (3.16, 12.0), (3.17, 12.3), (3.28, 12.5), (3.28, 12.7), (3.24, 13.2),
    (3.12, 14.0), (2.88, 14.9), (2.45, 15.9), (1.92, 16.9), (1.54, 17.7), (1.36, 18.3), (1.3, 18.8),
    (1.3, 19.1), (1.3, 19.25), (1.66, 19.3), (1.72, 19.35), (1.72, 19.5), (1.66, 19.55), (1.3, 19.6),
    (1.28, 19.75), (1.3, 19.9), (1.54, 19.95), (1.56, 20.05), (1.56, 20.25), (1.46, 20.35), (1.46, 20.45),
    (1.52, 20.55), (1.51, 21.0), (1.5, 21.5), (1.5, 21.8), (1.46, 21.98), (1.3, 22.0), (0.9, 22.0),
    (0.4, 22.0), (0.0, 22.0),
]  # fmt: skip
RIBS = (2.45, 7.7)  # cm: where the grip's ribs begin and end
RIB_COUNT, RIB_DEPTH = 4, 0.16


def bottle_profile(samples: int = 40_000) -> np.ndarray:
    """Return the profile as a dense polyline, (samples, 2): radius and height, bottom first."""
    control = np.array(BOTTLE_PROFILE)
    inner = np.linspace(0, 1, len(control) - 2)
    spline = BSpline(np.r_[0, 0, 0, inner, 1, 1, 1], control, 3)
    r, y = spline(np.linspace(0, 1, samples)).T
    along = np.clip((y - RIBS[0]) / (RIBS[1] - RIBS[0]), 0, 1)
    r = r - RIB_DEPTH * np.sin(np.pi * RIB_COUNT * along) ** 2 * (r > 2)
    return np.column_stack([r, y])


def edge_length(y: np.ndarray) -> np.ndarray:
    """Return the edge length wanted at height `y`: it narrows smoothly over the shoulder."""
    t = np.clip((y - 14.0) / 4.5, 0, 1)
    return BOTTLE_EDGE + (NECK_EDGE - BOTTLE_EDGE) * t * t * (3 - 2 * t)


def ring_heights(profile: np.ndarray) -> np.ndarray:
    """Return (radius, height) of every ring, both poles included, a triangle's height apart."""
    steps = np.linalg.norm(np.diff(profile, axis=0), axis=1)
    rows = np.r_[0, np.cumsum(steps / (np.sqrt(0.75) * edge_length(profile[1:, 1])))]
    at = np.linspace(0, rows[-1], round(rows[-1]) + 1)
    return np.column_stack([np.interp(at, rows, column) for column in profile.T])


def ring_angles(radius: float, height: float, row: int) -> np.ndarray:
    """Return the angles of a ring's vertices, a multiple of six; every other ring is half a step on."""
    count = 6 * max(1, round(2 * np.pi * radius / edge_length(np.array(height)) / 6))
    return (np.arange(count) + 0.5 * (row % 2)) * (2 * np.pi / count)


def stitch(lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Return the triangles between two rings, given their angles; `upper` is numbered after `lower`.

    Walks round both rings at once and always closes the triangle whose new edge is the shorter.
    """
    n, m = len(lower), len(upper)
    a, b = np.r_[lower, lower[0] + 2 * np.pi], np.r_[upper, upper[0] + 2 * np.pi]
    i = j = 0
    faces = []
    while i < n or j < m:
        if j == m or (i < n and abs(a[i + 1] - b[j]) < abs(b[j + 1] - a[i])):
            faces.append((i, (i + 1) % n, n + j % m))
            i += 1
        else:
            faces.append((i % n, n + (j + 1) % m, n + j))
            j += 1
    return np.array(faces)


def fan(pole: int, ring: np.ndarray) -> np.ndarray:
    """Return the triangles between a pole and the ring round it, which it sees counter-clockwise."""
    return np.column_stack([np.full(len(ring), pole), ring, np.roll(ring, -1)])


def bottle() -> tuple[np.ndarray, np.ndarray]:
    """Return the bottle's vertices (n, 3) and faces (f, 3)."""
    rings = ring_heights(bottle_profile())
    angles = [ring_angles(r, y, row) for row, (r, y) in enumerate(rings[1:-1])]
    walls = [
        np.column_stack([r * np.cos(a), np.full(len(a), y), -r * np.sin(a)])
        for (r, y), a in zip(rings[1:-1], angles, strict=True)
    ]
    bottom, top = ([[0, y, 0]] for y in rings[[0, -1], 1])
    first = np.cumsum([1, *(len(a) for a in angles)])
    strips = [stitch(a, b) + k for a, b, k in zip(angles[:-1], angles[1:], first[:-1], strict=False)]
    floor = fan(0, np.arange(1, first[1])[::-1])
    lid = fan(first[-1], np.arange(first[-2], first[-1]))
    V, F = np.vstack([bottom, *walls, top]), np.vstack([floor, *strips, lid])
    V = V - [0, V[:, 1].min(), 0]
    return V * np.cbrt(BOTTLE_VOLUME / trimesh.Trimesh(V, F, process=False).volume), F


# -------------------------------------------------------------------------------- solids, and meshes of them


def ellipsoid(P: np.ndarray, centre: tuple, radii: tuple, pitch: float = 0.0) -> np.ndarray:
    """Return about the distance to an ellipsoid that is turned by `pitch` degrees about Z."""
    c, s = np.cos(np.radians(pitch)), np.sin(np.radians(pitch))
    Q = (P - centre) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    near = np.linalg.norm(Q / radii, axis=1)
    return near * (near - 1) / np.maximum(np.linalg.norm(Q / np.square(radii), axis=1), 1e-12)


def tube(P: np.ndarray, start: tuple, end: tuple, radii: tuple[float, float]) -> np.ndarray:
    """Return about the distance to a round tube whose radius runs from ``radii[0]`` to ``radii[1]``."""
    axis = np.subtract(end, start)
    t = np.clip((P - start) @ axis / (axis @ axis), 0, 1)
    return np.linalg.norm(P - start - t[:, None] * axis, axis=1) - radii[0] - t * (radii[1] - radii[0])


def blend(a: np.ndarray, b: np.ndarray, width: float) -> np.ndarray:
    """Return the union of two solids, rounded where their surfaces are less than `width` apart."""
    return np.minimum(a, b) - width / 6 * (np.maximum(width - np.abs(a - b), 0) / width) ** 3


def meet(a: np.ndarray, b: np.ndarray, width: float) -> np.ndarray:
    """Return what two solids share, its edge rounded over `width`."""
    return -blend(-a, -b, width)


def project(P: np.ndarray, field: Field, steps: int = 3) -> np.ndarray:
    """Return points moved onto a zero set by Newton steps along the field's gradient."""
    nudge = 1e-4 * np.eye(3)
    for _ in range(steps):
        G = np.column_stack([field(P + e) - field(P - e) for e in nudge]) / 2e-4
        P = P - (field(P) / np.maximum((G * G).sum(axis=1), 0.05))[:, None] * G
    return P


def fine_contour(field: Field, low: tuple, high: tuple, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Return many uneven triangles near a zero set: the contour where z >= 0 and its mirror image."""
    x, y, z = (np.arange(a, b, spacing) for a, b in zip(low, high, strict=True))
    half = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1)
    values = field(half.reshape(-1, 3)).reshape(half.shape[:3])
    values = np.concatenate([values[:, :, :0:-1], values], axis=2)
    grid = pv.ImageData(dimensions=values.shape, spacing=(spacing,) * 3, origin=(x[0], y[0], -z[-1]))
    surface = grid.contour([0.0], scalars=values.ravel(order="F"), compute_normals=False).subdivide(1)
    return np.round(np.asarray(surface.points, dtype=float), 5), surface.faces.reshape(-1, 4)[:, 1:]


def vertex_areas(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Return a third of the area around every vertex."""
    double = np.linalg.norm(np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]]), axis=1)
    return np.bincount(F.ravel(), np.repeat(double / 6, 3), len(V))


def scattered(V: np.ndarray, count: int, taken: np.ndarray) -> np.ndarray:
    """Return `count` indices of points, each as far as can be from those before it [Gonzalez 1985].

    The first ones are away from the points `taken`.
    """
    x, y, z = np.ascontiguousarray(V.T)
    chosen = np.zeros(count, dtype=int)
    gap = cKDTree(taken).query(V)[0] ** 2
    for k in range(count):
        chosen[k] = i = gap.argmax()
        np.minimum(gap, (x - x[i]) ** 2 + (y - y[i]) ** 2 + (z - z[i]) ** 2, out=gap)
    return chosen


def equal_cells(
    P: np.ndarray, area: np.ndarray, centre: np.ndarray, place: Field = np.asarray, kept: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """Return the centres of compact cells of about equal area, and the cell of every vertex [Lloyd 1982].

    Distances are those between the points that `place` makes of vertices and centres. The first centres, as
    many as `kept`, stay.
    """
    V = place(P)
    for _ in range(15):
        cell = cKDTree(place(centre)).query(V)[1]
        weight = np.bincount(cell, area, len(centre))
        middle = np.column_stack([np.bincount(cell, area * x, len(centre)) for x in P.T]) / weight[:, None]
        centre = np.vstack([centre[:kept], middle[kept:]])
    return centre, cell


def mended(F: np.ndarray, cell: np.ndarray) -> np.ndarray:
    """Return `cell` with every cell in one piece: a vertex cut off from its cell joins a neighbour's."""
    edges = np.vstack([F[:, :2], F[:, 1:], F[:, ::2]])
    i, j = edges[cell[edges[:, 0]] == cell[edges[:, 1]]].T
    piece = connected_components(coo_matrix((np.ones(len(i)), (i, j)), (len(cell),) * 2), directed=False)[1]
    size = np.bincount(piece)[piece]
    largest = np.zeros(cell.max() + 1, dtype=int)
    np.maximum.at(largest, cell, size)
    cell, stray = cell.copy(), size < largest[cell]
    both = np.vstack([edges, edges[:, ::-1]])
    for a, b in both[stray[both[:, 0]]]:
        if stray[a] and not stray[b]:
            cell[a], stray[a] = cell[b], False
    return cell


def cell_dual(F: np.ndarray, cell: np.ndarray) -> np.ndarray:
    """Return a triangle for every three cells that meet, oriented like `F`."""
    corners = cell[F]
    return corners[(corners != np.roll(corners, 1, axis=1)).all(axis=1)]


def relax(P: np.ndarray, F: np.ndarray, back: Field, rounds: int = 12) -> np.ndarray:
    """Return vertices moved to the middle of their neighbours; `back` brings each step onto the surface."""
    i, j = F.ravel(), np.roll(F, -1, axis=1).ravel()
    A = coo_matrix((np.ones(2 * len(i)), (np.r_[i, j], np.r_[j, i])), (len(P), len(P))).tocsr()
    A.data[:] = 1
    valence = np.diff(A.indptr)[:, None]
    for _ in range(rounds):
        P = back(0.5 * P + 0.5 * (A @ P) / valence)
    return P


def remeshed(V: np.ndarray, F: np.ndarray, count: int, field: Field) -> tuple[np.ndarray, np.ndarray]:
    """Return `count` vertices on a closed zero set near the fine mesh, and the faces between them."""
    few = V[:: len(V) // 40_000]
    first = few[np.r_[0, scattered(few, count - 1, few[:1])]]
    centre, cell = equal_cells(V, vertex_areas(V, F), first)
    dual = cell_dual(F, mended(F, cell))[:, ::-1]  # the contour's triangles face inwards
    P = relax(project(centre, field), dual, lambda P: project(P, field, steps=1))
    return project(P, field), dual


# ------------------------------------------------------------------------------------------------ the duck

DUCK_VERTICES = 11_500
DUCK_FLOOR = 0.1434  # cm: how far above the cutting plane the field's rounded underside ends
TAIL_CUT = np.array([3.35, 3.55, 0.0])  # cm: a point of the reference plane that cuts off the tail
TAIL_NORMAL = np.array([0.8, 0.6, 0.0])
TAIL_MOTION = np.array([-0.6, 0.8, 0.0])  # along that plane: up, and forwards


def duck_body(P: np.ndarray) -> np.ndarray:
    """Return about the signed distance to breast, back and the upturned tail."""
    body = blend(
        ellipsoid(P, (0.5, 2.2, 0), (3.35, 2.15, 2.55)), ellipsoid(P, (-1.3, 2.6, 0), (2.1, 2.2, 2.05)), 0.8
    )
    root = tube(P, (1.9, 2.6, 0), (3.2, 3.3, 0), (1.6, 1.0))
    tip = tube(P, (3.1, 3.2, 0), (4.35, 4.8, 0), (1.0, 0.3))
    return blend(body, blend(root, tip, 0.8), 1.2)


def duck_bill(P: np.ndarray) -> np.ndarray:
    """Return about the signed distance to the flat bill: two lips, turned up towards the tip."""
    Q = P.copy()
    Q[:, 1] -= 0.16 * np.minimum(P[:, 0] + 3.1, 0) ** 2
    upper = ellipsoid(Q, (-3.25, 5.14, 0), (1.6, 0.42, 1.08), pitch=4)
    lower = ellipsoid(Q, (-3.05, 4.62, 0), (1.3, 0.36, 0.85))
    return blend(upper, lower, 0.35)


def duck_field(P: np.ndarray) -> np.ndarray:
    """Return about the signed distance of points (n, 3) to the duck: negative inside."""
    P = P * [1, 1, 0] + np.abs(P) * [0, 0, 1]
    body = duck_body(P)
    outline = blend(
        ellipsoid(P, (0.6, 2.6, 0), (1.6, 0.95, 9.0), pitch=10),
        tube(P, (1.2, 2.8, 2), (2.7, 3.45, 2), (0.7, 0.22)),
        0.5,
    )
    relief = np.clip(0.22 + 0.07 * P[:, 0], 0.05, 0.4)  # the wings lift off towards the tail
    solid = blend(body, meet(body - relief, outline, 0.5), 0.25)
    solid = blend(solid, ellipsoid(P, (-1.75, 5.55, 0), (1.85, 1.8, 1.75)), 0.9)
    solid = blend(solid, duck_bill(P), 0.3)
    solid = blend(solid, ellipsoid(P, (-2.68, 6.06, 0.98), (0.5, 0.5, 0.5)), 0.1)
    return meet(solid, -P[:, 1], 0.7)


def duck() -> tuple[np.ndarray, np.ndarray]:
    """Return the duck's vertices (n, 3) and faces (f, 3)."""
    fine = fine_contour(duck_field, (-5.2, -0.3, 0.0), (5.0, 7.8, 3.2), 0.09)
    V, F = remeshed(*fine, DUCK_VERTICES, duck_field)
    return V - [0, DUCK_FLOOR, 0], F


# ---------------------------------------------------------------------------------------------- the cushion

CUSHION_VERTICES = 9_500
CUSHION_REACH = 19.2  # cm: from the middle to the piping's centre line at a corner, along x and z
CUSHION_HEIGHT = 12.0  # cm
PIPING = 0.8  # cm: radius
WAIST = 1.3  # cm: how far the middle of a side is drawn in
FULLNESS = 2.4  # how steeply the covers rise from the seam
PRESS = 5.0  # cm: how far a hand presses it
PALM = 4.5  # cm: radius of the patch to press on, and of the one below that is held


def inside_seam(P: np.ndarray) -> np.ndarray:
    """Return about how far points (n, 3) are inside the seam, within the plane y = 0."""
    x, z = np.abs(P[:, 0]), np.abs(P[:, 2])
    to_x, to_z = (
        CUSHION_REACH - a - WAIST * np.maximum(1 - (b / CUSHION_REACH) ** 2, 0) for a, b in ((x, z), (z, x))
    )
    return blend(to_x, to_z, 5.0)


def covers(P: np.ndarray) -> np.ndarray:
    """Return about the signed distance of points (n, 3) to what is between the two covers."""
    x, z = (np.minimum(np.abs(a) / CUSHION_REACH, 1) for a in (P[:, 0], P[:, 2]))
    x, z = (np.minimum(a / (1 - WAIST / CUSHION_REACH * (1 - b**2)), 1) for a, b in ((x, z), (z, x)))
    fall = np.exp(-FULLNESS * (1 - x**2) * (1 - z**2))
    half = CUSHION_HEIGHT / 2 / (1 - np.exp(-FULLNESS))
    steepness = 2 / CUSHION_REACH * np.hypot(x * (1 - z**2), z * (1 - x**2))
    return (np.abs(P[:, 1]) - half * (1 - fall)) / np.hypot(1, half * FULLNESS * fall * steepness)


def cushion_field(P: np.ndarray) -> np.ndarray:
    """Return about the signed distance of points (n, 3) to the cushion: negative inside."""
    inside = inside_seam(P)
    from_seam = np.hypot(inside, P[:, 1])
    return blend(np.where(inside > 0, covers(P), from_seam), from_seam - PIPING, 0.15)


def cushion() -> tuple[np.ndarray, np.ndarray]:
    """Return the cushion's vertices (n, 3) and faces (f, 3)."""
    V, F = fine_contour(cushion_field, (-21.0, -7.5, 0.0), (21.0, 7.5, 21.0), 0.32)
    V, F = remeshed(project(V, cushion_field), F, CUSHION_VERTICES, cushion_field)
    return V - [0, V[:, 1].min(), 0], F


# ------------------------------------------------------------------------------------------------ the cloth

CLOTH_VERTICES = 8_000
CLOTH_SIZE = (20.0, 30.0)  # cm, along x and z
CLOTH_CORNER = 2.0  # cm: radius of the outline's corners
CLOTH_CORE = np.array(CLOTH_SIZE) / 2 - CLOTH_CORNER  # the corners' centres
CLOTH_FREE = 5.0  # cm: what is nearer to the middle is neither held nor handle
HEM = (0.6, 0.14)  # cm: the hem is a flat tube, its cross-section an ellipse of these semi-axes
HEM_MOUTH = 0.12  # cm: between the cloth and the raw edge, which lies below the seam
FOLD_HEIGHT = 0.4  # cm: of the axis about which the cloth is folded


def hem_profile(samples: int = 4_000) -> np.ndarray:
    """Return the hem's cross-section, (samples, 3): arc length, distance inwards from the rim, and height.

    It runs from the raw edge below, round the rim, to the seam above.
    """
    mouth = np.arcsin(HEM_MOUTH / 2 / HEM[1])
    angle = np.linspace(-mouth, mouth - 2 * np.pi, samples)
    line = np.column_stack([HEM[0] * (1 + np.cos(angle)), HEM[1] * np.sin(angle)])
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    return np.column_stack([np.r_[0, np.cumsum(steps)], line])


def pattern_corner() -> float:
    """Return the radius of the flat pattern's corners: those of the cloth with the hem let down."""
    length, inwards, _ = hem_profile()[-1]
    return CLOTH_CORNER - inwards + length


def laid(P: np.ndarray, opened: float = 0.0) -> np.ndarray:
    """Return where points (n, 2) of the flat pattern lie in the hemmed cloth, (n, 3).

    With `opened` the lower half of the hem hangs down, so many times as deep as it is long.
    """
    length, inwards, height = hem_profile().T
    away = P - np.clip(P, -CLOTH_CORE, CLOTH_CORE)
    out = np.linalg.norm(away, axis=1)
    s = pattern_corner() - out
    offset = np.where(s < length[-1], CLOTH_CORNER - np.interp(s, length, inwards), out)
    x, z = (P - away + away * (offset / np.maximum(out, 1e-12))[:, None]).T
    y = np.interp(s, length, height) - opened * np.maximum(length[-1] / 2 - s, 0)
    return np.column_stack([x, y, z])


def pattern_rim(spacing: float) -> np.ndarray:
    """Return points (n, 2) of the pattern's outline, about `spacing` apart once the cloth is hemmed."""
    turns = round(np.pi / 2 * (CLOTH_CORNER - hem_profile()[0, 1]) / spacing)
    points = []
    for k, corner in enumerate(np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])):
        angle = np.pi / 2 * (k + np.arange(turns + 1) / turns)
        arc = CLOTH_CORE * corner + pattern_corner() * np.column_stack([np.cos(angle), np.sin(angle)])
        side = CLOTH_CORE * (np.roll(corner, 1) * [-1, 1] - corner)
        pieces = round(np.linalg.norm(side) / spacing)
        points += [arc, arc[-1] + np.outer(np.arange(1, pieces) / pieces, side)]
    return np.vstack(points)


def fine_pattern(spacing: float = 0.12) -> tuple[np.ndarray, np.ndarray]:
    """Return many small triangles of the flat pattern: points (n, 2) and faces (f, 3)."""
    width, depth = CLOTH_CORE + pattern_corner()
    rows = np.arange(-depth, depth, spacing * np.sqrt(0.75))
    grid = np.stack(np.meshgrid(np.arange(-width, width, spacing), rows), axis=-1)
    grid[1::2, :, 0] += spacing / 2
    grid = grid.reshape(-1, 2)
    out = np.linalg.norm(grid - np.clip(grid, -CLOTH_CORE, CLOTH_CORE), axis=1)
    P = np.vstack([pattern_rim(0.7 * spacing), grid[out < pattern_corner() - spacing / 2]])
    return P, Delaunay(P).simplices


def cloth() -> tuple[np.ndarray, np.ndarray]:
    """Return the cloth's vertices (n, 3) and faces (f, 3), which look upwards."""
    P, F = fine_pattern()
    area = vertex_areas(laid(P), F)
    rim = pattern_rim(np.sqrt(area.sum() / CLOTH_VERTICES / np.sqrt(0.75)))

    def place(P: np.ndarray) -> np.ndarray:
        return laid(P, 0.5)  # the raw edge is nearer to the cloth above it than cells are wide

    def back(P: np.ndarray) -> np.ndarray:
        return np.vstack([rim, P[len(rim) :]])

    first = P[scattered(place(P), CLOTH_VERTICES - len(rim), place(rim))]
    centre, cell = equal_cells(P, area, np.vstack([rim, first]), place, len(rim))
    dual = cell_dual(F, mended(F, cell))
    V = laid(relax(centre, dual, back))
    return V - [0, V[:, 1].min(), 0], dual[:, ::-1]


# ---------------------------------------------------------------------------- selections and transforms


def bottle_labels(V: np.ndarray) -> np.ndarray:
    """Return the bottle's selection: it stands held on its foot, and its neck and cap are the handle."""
    return np.where(V[:, 1] < BOTTLE_BASE_TOP, HELD, np.where(V[:, 1] > BOTTLE_NECK_BOTTOM, HANDLE, FREE))


def duck_labels(V: np.ndarray) -> np.ndarray:
    """Return the duck's selection: held at what shows of the bill, the tail behind the cut is the handle."""
    on_bill = np.abs(duck_bill(V + np.array([0, DUCK_FLOOR, 0]))) < 0.06
    return np.where(on_bill, HELD, np.where((V - TAIL_CUT) @ TAIL_NORMAL > 0, HANDLE, FREE))


def cushion_labels(V: np.ndarray) -> np.ndarray:
    """Return the cushion's selection: it lies on what is held, and a palm's patch on top is the handle."""
    palm = np.hypot(V[:, 0], V[:, 2]) < PALM
    return np.where(~palm, FREE, np.where(V[:, 1] > CUSHION_HEIGHT / 2, HANDLE, HELD))


def cloth_labels(V: np.ndarray) -> np.ndarray:
    """Return the cloth's selection: a third of it is held, and the third at the other end is the handle."""
    return np.where(V[:, 2] > CLOTH_FREE, HELD, np.where(V[:, 2] < -CLOTH_FREE, HANDLE, FREE))


def twist(degrees: float) -> np.ndarray:
    """Return the 4x4 rotation about +Y, right-handed."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, 0, s, 0], [0, 1, 0, 0], [-s, 0, c, 0], [0, 0, 0, 1]])


def fold(height: float) -> np.ndarray:
    """Return the 4x4 half turn about the line along +X at `height`."""
    return np.array([[1, 0, 0, 0], [0, -1, 0, 2 * height], [0, 0, -1, 0], [0, 0, 0, 1]])


def shift(motion: np.ndarray) -> np.ndarray:
    """Return the 4x4 translation by `motion`."""
    return np.vstack([np.column_stack([np.eye(3), motion]), [0, 0, 0, 1]])


def cut_length(V: np.ndarray, F: np.ndarray) -> float:
    """Return the longest extent, within its plane, of the cut that parts the tail from the duck."""
    height = (V - TAIL_CUT) @ TAIL_NORMAL
    i, j = np.vstack([F[:, :2], F[:, 1:]]).T
    i, j = np.column_stack([i, j])[height[i] * height[j] < 0].T
    crossing = V[i] + (height[i] / (height[i] - height[j]))[:, None] * (V[j] - V[i])
    return float(pdist(crossing).max())


# ----------------------------------------------------------------------------------------------- the files


def comment(*lines: str) -> str:
    """Return the head of a file: its lines as comments, then the licence and the maker."""
    return "".join(f"# {line}\n" for line in (*lines, LICENCE, "made by make_samples.py"))


def vertex_normals(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Return the unit normal of every vertex, the mean of those around it by their angles."""
    mesh = trimesh.Trimesh(V, F, process=False)
    return trimesh.geometry.weighted_vertex_normals(len(V), F, mesh.face_normals, mesh.face_angles)


def write_mesh(path: Path, title: str, V: np.ndarray, F: np.ndarray, soft: bool = False) -> None:
    """Write an OBJ file: vertices to a nanometre, triangles, and normals of what is `soft`, without edges."""
    edges = np.sort(np.vstack([F[:, :2], F[:, 1:], F[:, ::2]]), axis=1)
    shut = "closed" if (np.unique(edges, axis=0, return_counts=True)[1] == 2).all() else "open"
    size = f"{len(V)} vertices, {len(F)} triangles; {shut}; unit: centimetre; +Y is up"
    vertices = "".join("v {:.9g} {:.9g} {:.9g}\n".format(*v) for v in np.round(V, 7) + 0.0)
    normals, corner = "", "{0}"
    if soft:
        normals = "".join("vn {:.3f} {:.3f} {:.3f}\n".format(*n) for n in vertex_normals(V, F) + 0.0)
        corner = "{0}//{0}"
    faces = "".join("f " + " ".join(corner.format(i) for i in face) + "\n" for face in F + 1)
    path.write_text(comment(title, size) + vertices + normals + faces, encoding="utf-8", newline="\n")


def write_selection(path: Path, title: str, labels: np.ndarray) -> None:
    """Write one label a vertex, in the mesh file's order."""
    key = "one line a vertex, in the order of the mesh file: 0 held, 1 free, 2 handle"
    text = comment(title, key) + "".join(f"{label}\n" for label in labels)
    path.write_text(text, encoding="utf-8", newline="\n")


def write_transform(path: Path, titles: list[str], M: np.ndarray) -> None:
    """Write a 4x4 matrix that acts on column vectors, row by row, to full precision."""
    rows = "".join(" ".join(f"{x!r}" for x in row) + "\n" for row in (M + 0.0).tolist())
    head = comment(*titles, "4x4, acts on column vectors; lengths in centimetres")
    path.write_text(head + rows, encoding="utf-8", newline="\n")


def write_bottle(folder: Path) -> None:
    """Write the bottle, its selection and its twists."""
    V, F = bottle()
    write_mesh(folder / "bottle.obj", "a half-litre PET bottle with its cap on", V, F)
    title = f"bottle.obj: held below y = {BOTTLE_BASE_TOP}, handle above y = {BOTTLE_NECK_BOTTOM}"
    write_selection(folder / "bottle.sel", title, bottle_labels(V))
    for degrees in (60, 120, 180):
        title = f"twist the handle of bottle.sel by {degrees} degrees about the bottle's axis, +Y"
        write_transform(folder / f"bottle-twist-{degrees:d}.def", [title], twist(degrees))


def write_duck(folder: Path) -> None:
    """Write the duck, its selection and its two bends."""
    V, F = duck()
    write_mesh(folder / "duck.obj", "a rubber duck; it looks along -X", V, F)
    plane = f"the plane through {TAIL_CUT.tolist()} with normal {TAIL_NORMAL.tolist()}"
    title = f"duck.obj: held at the bill; handle: the tail, cut off by {plane}"
    write_selection(folder / "duck.sel", title, duck_labels(V))
    L = cut_length(V, F)
    for share in (0.15, 0.3):
        motion = share * L * TAIL_MOTION
        way = f"H = {share} L = {share * L:.9g} cm along {TAIL_MOTION.tolist()}"
        cut = f"L = {L:.9g} cm: the longest extent of the cut that {plane} makes"
        write_transform(
            folder / f"duck-bend-{round(100 * share):03d}.def",
            [f"bend the duck: its tail moves by {way}", cut],
            shift(motion),
        )


def write_cushion(folder: Path) -> None:
    """Write the cushion, its selection, and how a hand presses it."""
    V, F = cushion()
    write_mesh(folder / "cushion.obj", "a cushion with piping along its seam", V, F, soft=True)
    title = f"cushion.obj: held below, handle above, both within {PALM} cm of its axis"
    write_selection(folder / "cushion.sel", title, cushion_labels(V))
    title = "press the cushion: the handle of cushion.sel goes down"
    write_transform(folder / "cushion-press.def", [title], shift(np.array([0, -PRESS, 0])))


def write_cloth(folder: Path) -> None:
    """Write the cloth, its selection and its fold."""
    V, F = cloth()
    write_mesh(folder / "cloth.obj", "a cloth with a hem", V, F, soft=True)
    title = f"cloth.obj: held where z > {CLOTH_FREE}, handle where z < -{CLOTH_FREE}"
    write_selection(folder / "cloth.sel", title, cloth_labels(V))
    title = f"fold the cloth: half a turn about the line along +X through [0, {FOLD_HEIGHT}, 0]"
    write_transform(folder / "cloth-fold.def", [title], fold(FOLD_HEIGHT))


def main(folder: Path) -> None:
    """Write all samples into `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    write_bottle(folder)
    write_duck(folder)
    write_cushion(folder)
    write_cloth(folder)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
