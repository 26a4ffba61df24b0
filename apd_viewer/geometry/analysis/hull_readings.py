"""Readings of a shape determined by its convex hull alone."""

import math
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import as_float, checked, local_origin
from apd_viewer.language import tr

# Volume fraction of randomly packed convex bodies: the densest random packing of equal spheres, and the range
# from the loosest spheres [Onoda & Liniger 1990] to the densest spheroids [Donev et al. 2004].
PACKING, LOOSEST, DENSEST = 0.64, 0.55, 0.71
_LITTLE = 1e-9  # rounding tolerance, as a fraction of an object


class HullReadings(NamedTuple):
    """Readings of a convex hull, mesh units; a flat shape has no volume or width.

    Attributes
    ----------
    volume : float
    width : float
        Least distance of two parallel planes with the shape between them.
    sides : tuple of 3 floats
        Of the smallest box in any orientation, shortest first.

    Examples
    --------
    >>> import apd_viewer
    >>> bottle = apd_viewer.open_mesh("bottle.obj")  # in centimetres
    >>> hull = apd_viewer.volume_readings(bottle.V, bottle.F).hull
    >>> f"{hull.volume:.0f}", f"{hull.bulk():.0f}", hull.count_in(45_000)
    ('573', '896', 50)
    """

    volume: float
    width: float
    sides: tuple[float, float, float]

    @property
    def box(self) -> float:
        """Volume of the smallest bounding box in any orientation."""
        a, b, c = self.sides
        return a * b * c

    def bulk(self, packing: float = PACKING) -> float:
        """Container volume per object in a random packing.

        ``packing`` is the volume fraction of the objects in the container.
        """
        if not 0.0 < as_float(packing) <= 1.0:
            raise InputError(tr("The packing must be a fraction above 0 and at most 1, such as 0.64."))
        return self.volume / packing

    @checked
    def count_in(self, container: float, packing: float = PACKING) -> int:
        """Number of objects in a ``container``, cubic mesh units; 0 for a flat shape."""
        return int(container / self.bulk(packing) + _LITTLE) if self.volume > 0.0 else 0


def hull_readings(points: np.ndarray) -> HullReadings:
    """Readings of the convex hull of ``points`` (k, 3)."""
    points = points - local_origin(points)
    hull = convex_hull(points)
    if hull is None:  # a flat shape has no box volume, whatever its orientation
        return HullReadings(0.0, 0.0, (0.0, *_smallest_rectangle(points)))
    return HullReadings(hull.volume, minimum_width(hull), smallest_box(hull.corners))


def _smallest_rectangle(points: np.ndarray) -> tuple[float, float]:
    """Sides of the smallest rectangle around points (k, 3) of a plane, shorter first.

    One of its sides contains an edge of the convex hull [Freeman & Shapira 1975].
    """
    # Imported here: scipy would delay the first picture, and few runs need a convex hull.
    from scipy.spatial import ConvexHull as Qhull, QhullError

    centred = points - points.mean(axis=0)
    flat = centred @ np.linalg.svd(np.vstack([centred, np.zeros((3, 3))]), full_matrices=False)[2][:2].T
    try:
        corners = flat[Qhull(flat).vertices]
    except QhullError:  # all on a line, or in one place
        return 0.0, float(np.ptp(flat[:, 0]))
    along = np.roll(corners, -1, axis=0) - corners
    along /= np.linalg.norm(along, axis=1)[:, None]
    across = np.column_stack([-along[:, 1], along[:, 0]])
    sides = np.column_stack([np.ptp(each @ corners.T, axis=1) for each in (along, across)])
    a, b = np.sort(sides[np.argmin(sides.prod(axis=1))]).tolist()
    return a, b


_PORTION = 1 << 22  # direction-corner products per batch
_ROUNDING = 1e-12  # relative to the size of the hull
_ENOUGH = 4000  # corners sufficient for finding a direction


class ConvexHull(NamedTuple):
    """Convex hull of points, with outward unit normals.

    Attributes
    ----------
    corners : (k, 3) float array
    normals : (f, 3) float array
        Of its triangles.
    edges : (e, 2) int array
        The two triangles at each edge.
    volume : float
    """

    corners: np.ndarray
    normals: np.ndarray
    edges: np.ndarray
    volume: float


def convex_hull(points: np.ndarray) -> ConvexHull | None:
    """Convex hull of ``points`` (k, 3); None if they are flat."""
    # Imported here: scipy would delay the first picture, and few runs need a convex hull.
    from scipy.spatial import ConvexHull as Qhull, QhullError

    try:
        found = Qhull(points)
    except QhullError:
        return None
    pairs = np.column_stack([np.repeat(np.arange(len(found.neighbors)), 3), found.neighbors.ravel()])
    edges = pairs[pairs[:, 0] < pairs[:, 1]]
    return ConvexHull(points[found.vertices], found.equations[:, :3], edges, float(found.volume))


def minimum_width(hull: ConvexHull) -> float:
    """Least distance between two parallel planes enclosing the hull.

    Exact up to 4,000 corners. Beyond that, the direction is found from some corners, and the extent along it
    from all: never less than the minimum, and on a sphere at most 0.1 % more.
    """
    few = hull.corners[:: -(-len(hull.corners) // _ENOUGH)]
    part = hull if len(few) == len(hull.corners) else convex_hull(few)
    direction = _narrowest_direction(hull if part is None else part)
    return float(_extents(direction[None], hull.corners)[0][0])


def _narrowest_direction(hull: ConvexHull) -> np.ndarray:
    """Direction (3,) of the minimum width, of any length.

    The two planes contain either a face and a corner, or two edges [Houle & Toussaint 1988]; all cases are
    tried. The normals of planes through an edge form an arc between the normals of its two faces; the other
    plane can contain an edge only where the lowest corner changes along this arc.
    """
    corners = hull.corners - hull.corners.mean(axis=0)
    extents, low = _extents(hull.normals, corners)
    best = extents.argmin()
    least, narrowest = extents[best], hull.normals[best]
    ends, lows = hull.normals[hull.edges], low[hull.edges]
    rounding = _ROUNDING * np.abs(corners).max()
    while True:
        apart = corners[lows[:, 1]] - corners[lows[:, 0]]
        gaps = np.einsum("nec,nc->ne", ends, apart) * (1.0, -1.0)
        changes = gaps.sum(axis=1) > rounding
        if not changes.any():
            return narrowest
        ends, lows, gaps = ends[changes], lows[changes], gaps[changes]
        middle = (ends * gaps[:, ::-1, None]).sum(axis=1) / gaps.sum(axis=1)[:, None]
        extents, low = _extents(middle, corners)
        best = extents.argmin()
        if extents[best] < least:
            least, narrowest = extents[best], middle[best]
        # If a third corner is lower still, both halves of the arc are searched.
        depth = np.einsum("nc,nc->n", corners[lows[:, 0]] - corners[low], middle)
        deeper = depth > rounding
        halves = [
            np.stack([ends[deeper, 0], middle[deeper]], 1),
            np.stack([middle[deeper], ends[deeper, 1]], 1),
        ]
        ends = np.concatenate(halves)
        lows = np.concatenate(
            [
                np.column_stack([lows[deeper, 0], low[deeper]]),
                np.column_stack([low[deeper], lows[deeper, 1]]),
            ]
        )


def _extents(directions: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Extents (d,) along ``directions`` (d, 3) of any length, and lowest corners (d,)."""
    extent, low = np.empty(len(directions)), np.empty(len(directions), dtype=np.int64)
    step = max(1, _PORTION // len(corners))
    for k in range(0, len(directions), step):
        heights = directions[k : k + step] @ corners.T
        low[k : k + step] = heights.argmin(axis=1)
        extent[k : k + step] = np.ptp(heights, axis=1)
    return extent / np.linalg.norm(directions, axis=1), low


# Starting orientations in the search for the smallest box, and how many of the best are refined.
_ORIENTATIONS, _BEST = 200, 4
_NEAR = 0.05  # size of the initial simplex, radians


def box_volume(points: np.ndarray) -> float:
    """Volume of the axis-aligned bounding box of the ``points`` (k, 3)."""
    a, b, c = (points.max(axis=0) - points.min(axis=0)).tolist()
    return a * b * c


def smallest_box(corners: np.ndarray) -> tuple[float, float, float]:
    """Sides of the smallest box found around ``corners`` (k, 3), shortest first.

    No algorithm is both exact and fast. The search is deterministic, and its result never larger than the
    axis-aligned box.
    """
    # Imported here: scipy would delay the first picture, and few runs need a convex hull.
    from scipy.optimize import minimize
    from scipy.spatial.transform import Rotation

    corners = np.ascontiguousarray((corners - corners.mean(axis=0)).T)
    some = np.ascontiguousarray(corners[:, :: 1 + corners.shape[1] // _ENOUGH])

    def placed(turn: np.ndarray, what: np.ndarray) -> np.ndarray:
        return (_rotation_matrix(*turn.tolist()) @ what).T

    def turned(turn: np.ndarray) -> float:
        return box_volume(placed(turn, some))

    spread = Rotation.random(_ORIENTATIONS, rng=0).as_rotvec()
    best = spread[np.argsort([turned(turn) for turn in spread])[:_BEST]]
    size, sides = box_volume(corners.T), np.ptp(corners, axis=1)
    for start in (np.zeros(3), _principal_rotation(corners), *best):
        around = np.vstack([start, start + _NEAR * np.eye(3)])
        options = {"initial_simplex": around, "xatol": 1e-7, "fatol": 1e-12 * size, "maxiter": 400}
        found = minimize(turned, start, method="Nelder-Mead", options=options).x
        sides = min(sides, np.ptp(placed(found, corners), axis=0), key=np.prod)
    a, b, c = np.sort(sides).tolist()
    return a, b, c


def _rotation_matrix(x: float, y: float, z: float) -> np.ndarray:
    """Matrix of a rotation vector.

    Equal to scipy's result bit for bit, but seven times as fast for a single matrix.
    """
    angle = math.sqrt(x * x + y * y + z * z)
    square = angle * angle
    is_small = angle <= 1e-3
    scale = 0.5 - square / 48 + square * square / 3840 if is_small else math.sin(angle / 2) / angle
    x, y, z, w = scale * x, scale * y, scale * z, math.cos(angle / 2)
    rows = (
        (x * x - y * y - z * z + w * w, 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), -x * x + y * y - z * z + w * w, 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), -x * x - y * y + z * z + w * w),
    )
    return np.array(rows)


def _principal_rotation(corners: np.ndarray) -> np.ndarray:
    """Rotation vector from the principal axes of ``corners`` (3, k) to x, y, z."""
    # Imported here: scipy is slow to load, and few commands need it.
    from scipy.spatial.transform import Rotation

    axes = np.linalg.eigh(corners @ corners.T)[1].T
    return Rotation.from_matrix(axes * np.linalg.det(axes)).as_rotvec()


def compactness(volume: float, area: float) -> float:
    """Isoperimetric ratio ``36 pi V^2 / A^3``: 1 for a ball, less otherwise."""
    return 36.0 * math.pi * volume**2 / area**3
