"""Small pictures of shapes, rasterized in memory without OpenGL or a window.

Each triangle is divided into rows of covered pixels, and the nearest triangle at each pixel is found; colours
and light are computed for the visible triangles only. Triangles are processed in batches of a fixed size, so
that memory is bounded for any mesh. The same shape gives the same picture.
"""

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

# Direction from the shape to the viewer, for a mesh with +Y up.
VIEW_DIRECTION = (0.55, 0.28, 1.0)
_AT_ONCE = 1 << 18  # triangles, rows or pixels per batch
# Largest picture side in pixels with 2 x 2 supersampling.
_FINE = 512
_DEEPEST = 12  # average overdraw; beyond it only every k-th triangle is drawn
_MARGIN = 0.02  # margin around the shapes, as a fraction of the longer side
_NARROWEST = 0.25  # minimum length of the shorter side, as a fraction of the longer side
_NOTHING = 1e-30  # mesh units; smaller shapes count as points
_LIGHT = np.array([-0.35, 0.45, 1.0]) / np.linalg.norm([-0.35, 0.45, 1.0])
_AMBIENT = 0.35
_CREASE = 0.5  # cosine of the minimum angle of a sharp edge


class _Canvas(NamedTuple):
    """Canvas with its lowest corner, pixels per unit length, and size in pixels."""

    low: np.ndarray
    scale: float
    width: int
    height: int


def shape_picture(
    shapes: Sequence[np.ndarray],
    F: np.ndarray,
    colors: Sequence[np.ndarray | tuple[int, int, int]],
    size: int,
    view_direction: tuple[float, float, float] = VIEW_DIRECTION,
    up: tuple[float, float, float] = (0.0, 1.0, 0.0),
) -> np.ndarray:
    """Picture of shapes side by side at one scale, on a transparent background.

    Parameters
    ----------
    shapes : sequence of (n, 3) float arrays
    F : (m, 3) int array
        Triangles of all of them, at least one.
    colors : sequence of (m, 3) uint8 arrays or of RGB
        Of the triangles of each shape.
    size : int
        Longer side of each, pixels.
    view_direction, up : (float, float, float)
        Direction from the shapes to the viewer, and up direction.

    Returns
    -------
    (h, w, 4) uint8 array
        RGBA, not weighted by alpha.
    """
    finer = 2 if size <= _FINE else 1
    axes = _axes(np.array(view_direction), np.array(up))
    turned = [np.einsum("ij,kj->ik", U, axes) for U in shapes]
    canvas = _canvas(turned, F, size * finer, finer)
    drawn = [_rendered_shape(canvas, U, F, np.array(color)) for U, color in zip(turned, colors, strict=True)]
    return _downsample(np.concatenate(drawn, axis=1), finer)


def _axes(view_direction: np.ndarray, up: np.ndarray) -> np.ndarray:
    """Unit vectors to the right, up and towards the viewer, rows (3, 3)."""
    toward = view_direction / np.linalg.norm(view_direction)
    right = np.cross(up, toward)
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(toward, right), toward])


def _canvas(shapes: Sequence[np.ndarray], F: np.ndarray, size: int, step: int) -> _Canvas:
    """Canvas for all shapes, ``size`` pixels long, its sides multiples of ``step``."""
    used = np.zeros(len(shapes[0]), dtype=bool)  # a vertex without a triangle is not drawn
    used[F] = True
    low = np.min([U.min(axis=0, where=used[:, None], initial=np.inf) for U in shapes], axis=0)
    high = np.max([U.max(axis=0, where=used[:, None], initial=-np.inf) for U in shapes], axis=0)
    longest = float((high - low)[:2].max())
    scale = (1.0 - 2.0 * _MARGIN) * size / (longest if longest > _NOTHING else 1.0)
    sides = np.clip((high - low)[:2] * scale / size + 2.0 * _MARGIN, _NARROWEST, 1.0) * size
    width, height = (step * math.ceil(side / step - 1e-9) for side in sides)
    corner = (low + high) / 2 - np.array([width, height, 0.0]) / 2 / scale
    return _Canvas(corner, scale, width, height)


def _rendered_shape(canvas: _Canvas, U: np.ndarray, F: np.ndarray, colors: np.ndarray) -> np.ndarray:
    """RGBA of a shape (h, w, 4), floats from 0 to 255, on a transparent background."""
    X = (U - canvas.low) * canvas.scale  # column, row from the bottom and depth, in pixels
    nearest = nearest_triangles(X, F, canvas.width, canvas.height)
    pixels = np.flatnonzero(nearest >= 0)
    triangles = nearest[pixels]
    light = _brightness(X, F, triangles, pixels % canvas.width + 0.5, pixels // canvas.width + 0.5)
    rgba = np.zeros((len(nearest), 4))
    rgba[pixels, :3] = light[:, None] * (colors if colors.ndim == 1 else colors[triangles])
    rgba[pixels, 3] = 255.0
    return rgba.reshape(canvas.height, canvas.width, 4)[::-1]


def _downsample(rgba: np.ndarray, finer: int) -> np.ndarray:
    """Downsample by ``finer`` in both directions, with straight alpha."""
    height, width = (side // finer for side in rgba.shape[:2])
    mean = rgba.reshape(height, finer, width, finer, 4).mean(axis=(1, 3))
    mean[..., :3] *= 255.0 / np.maximum(mean[..., 3:], 1.0)
    return np.rint(mean).astype(np.uint8)


def nearest_triangles(X: np.ndarray, F: np.ndarray, width: int, height: int) -> np.ndarray:
    """Nearest triangle at each pixel, (height * width,) int; -1 for none."""
    depth = np.full(width * height, -np.inf)
    who = np.full(width * height, -1)
    every = _triangle_stride(X, F, _DEEPEST * width * height)
    for part in _portions(np.ones(len(F), dtype=int)):
        ids = np.arange(part.start, part.stop)[::every]
        for pixel, triangle, z in fragments(X[F[ids]], width):
            np.maximum.at(depth, pixel, z)
            nearer = z == depth[pixel]
            who[pixel[nearer]] = ids[triangle[nearer]]
    return who


def _triangle_stride(X: np.ndarray, F: np.ndarray, most: int) -> int:
    """Triangle stride for drawing about ``most`` pixels."""
    total = 0.0
    for part in _portions(np.ones(len(F), dtype=int)):
        a, b, c = X[F[part], :2].transpose(1, 0, 2)
        total += 0.5 * np.abs(_cross(b - a, c - a)).sum()
    return max(1, math.ceil(total / most))


def _portions(counts: np.ndarray) -> Iterator[slice]:
    """Slices of a list into batches with about equal sums of ``counts``."""
    ends, first = np.cumsum(counts), 0
    while first < len(counts):
        done = ends[first - 1] if first else 0
        last = max(int(np.searchsorted(ends, done + _AT_ONCE, side="right")), first + 1)
        yield slice(first, last)
        first = last


def fragments(corners: np.ndarray, width: int) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Rasterize triangles (t, 3, 3); yields batches of pixels, triangles and depths."""
    low, high = (np.ceil(side - 0.5).astype(int) for side in (corners[..., 1].min(1), corners[..., 1].max(1)))
    for part in _portions(high - low):
        triangle, row = _concatenated_ranges(part.start, low[part], high[part])
        begin, end = _spans(corners[triangle], row + 0.5)
        for some in _portions(end - begin):
            of, column = _concatenated_ranges(some.start, begin[some], end[some])
            yield row[of] * width + column, triangle[of], _depth(corners[triangle[of]], column, row[of])


def _concatenated_ranges(first: int, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Concatenated ranges ``low`` to ``high``, after the range number of each item."""
    count = high - low
    of = np.repeat(np.arange(len(count)), count)
    start = np.cumsum(count) - count
    return of + first, np.arange(len(of)) - start[of] + low[of]


def _spans(corners: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First column of each triangle (r, 3, 3) at height ``y``, and one past its last.

    Columns are tested at their middle, with half-open ends: triangles with a common edge share no pixel.
    """
    left, right = np.full(len(y), np.inf), np.full(len(y), -np.inf)
    for k in range(3):
        a, b = corners[:, k], corners[:, (k + 1) % 3]
        crosses = (a[:, 1] <= y) != (b[:, 1] <= y)
        rise = np.where(crosses, b[:, 1] - a[:, 1], 1.0)
        x = a[:, 0] + (y - a[:, 1]) / rise * (b[:, 0] - a[:, 0])
        left = np.where(crosses, np.minimum(left, x), left)
        right = np.where(crosses, np.maximum(right, x), right)
    left, right = (np.where(np.isfinite(side), side, 0.0) for side in (left, right))
    return np.ceil(left - 0.5).astype(int), np.ceil(right - 0.5).astype(int)


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Cross products of vectors in the plane, (k,)."""
    product: np.ndarray = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return product


def _weights(corners: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Barycentric coordinates (k, 3) of points in triangles (k, 3, 3)."""
    a, b, c = corners[..., :2].transpose(1, 0, 2)
    p = np.column_stack([x, y])
    area = _cross(b - a, c - a)
    area = np.where(area == 0.0, 1.0, area)
    second, third = _cross(p - a, c - a) / area, _cross(b - a, p - a) / area
    return np.column_stack([1.0 - second - third, second, third])


def _depth(corners: np.ndarray, column: np.ndarray, row: np.ndarray) -> np.ndarray:
    depth: np.ndarray = (_weights(corners, column + 0.5, row + 0.5) * corners[..., 2]).sum(axis=1)
    return depth


def _brightness(
    X: np.ndarray, F: np.ndarray, triangles: np.ndarray, x: np.ndarray, y: np.ndarray
) -> np.ndarray:
    """Brightness (k,) of points on triangles, from 0 to 1; both sides are lit."""
    own = _unit(_doubled_normals(X[F[triangles]]))
    corner = _vertex_normals(X, F)[F[triangles]]
    sharp = (corner * own[:, None]).sum(axis=2) < _CREASE
    corner = np.where(sharp[..., None], own[:, None], corner)
    normal = _unit((_weights(X[F[triangles]], x, y)[..., None] * corner).sum(axis=1))
    normal *= np.where(normal[:, 2:] < 0.0, -1.0, 1.0)
    return _AMBIENT + (1.0 - _AMBIENT) * np.clip(normal @ _LIGHT, 0.0, 1.0)


def _vertex_normals(X: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Unit vertex normals (n, 3); zero without triangles."""
    sums = np.zeros_like(X)
    for part in _portions(np.ones(len(F), dtype=int)):
        normals = np.repeat(_doubled_normals(X[F[part]]), 3, axis=0)
        for k in range(3):
            sums[:, k] += np.bincount(F[part].ravel(), normals[:, k], minlength=len(X))
    return _unit(sums)


def _doubled_normals(corners: np.ndarray) -> np.ndarray:
    """Normals of triangles (k, 3, 3) with twice the area as length."""
    a, b, c = corners.transpose(1, 0, 2)
    return np.cross(b - a, c - a)


def _unit(v: np.ndarray) -> np.ndarray:
    length = np.linalg.norm(v, axis=1, keepdims=True)
    return v / np.where(length == 0.0, 1.0, length)
