"""Texture images of a mesh, and pictures laid on a part of the rest shape."""

import math
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.language import tr

# Share of a part's area that its shadow has, from which it is flat: an arc of 40° has 0.98.
_FLAT = 0.98
_LEVEL = 0.7  # mean vertical part of the normals of what lies, such as a lid or a bottom
_ELSEWHERE = -9.0  # texture coordinate far outside a picture


class Texture(NamedTuple):
    """Image mapped onto a mesh, with seams.

    Attributes
    ----------
    uv : (k, 2) float array
        Texture coordinates: 0 to 1 from left to right and from bottom to top, repeated beyond.
    uv_of : (m, 3) int32 array
        Index into them for each corner.
    image : (h, w, 3) uint8 array
        Rows from top to bottom, sRGB; of a picture (h, w, 4), with opacity.
    turn : float
        Of a picture, which is not repeated, the first coordinate once around the mesh; 0 of other images.
    """

    uv: np.ndarray
    uv_of: np.ndarray
    image: np.ndarray
    turn: float = 0.0


def laid_picture(
    V: np.ndarray, F: np.ndarray, inside: np.ndarray, frame: np.ndarray, image: np.ndarray
) -> Texture:
    """Texture of an upright picture in true proportions on a part of the rest shape.

    Around the up axis, coordinates are angle and height, and on a flat part those of its plane. The picture
    is as large as the part permits, in its middle, and at the front where the part goes all around.

    Parameters
    ----------
    V, F : (n, 3) float and (m, 3) int arrays
    inside : (n,) bool array
        Vertices of the part.
    frame : (3, 3) float array
        Unit vectors of the front view in rows: right, up and towards the viewer.
    image : (h, w, 4) uint8 array

    Raises
    ------
    InputError
        If the part has no triangle.
    """
    touched = np.flatnonzero(inside[F].any(axis=1))
    whole = F[inside[F].all(axis=1)]
    P = V @ frame.T
    N = np.cross(P[whole[:, 1]] - P[whole[:, 0]], P[whole[:, 2]] - P[whole[:, 0]])
    total = float(np.linalg.norm(N, axis=1).sum())
    if total == 0.0:
        raise InputError(tr("The region is too small for a picture; paint more of it."))
    mean = N.sum(axis=0) / total
    if np.linalg.norm(mean) > _FLAT or np.abs(N[:, 1]).sum() > _LEVEL * total:
        place, size, period = _flat_places(P, inside, mean)
    else:
        place, size, period = _places_around(P, whole, inside, N)
    width = min(size[0], size[1] * image.shape[1] / image.shape[0])
    scale = np.array([width, width * image.shape[0] / image.shape[1]])
    # A triangle across the seam has corners of the next turn.
    along = place[F[touched], 0]
    turns = np.rint((along[:, :1] - along) / period).astype(np.int64)
    row = np.full(F.shape, 3 * len(V))
    row[touched] = F[touched] + len(V) * (1 + turns)
    rows, uv_of = np.unique(row, return_inverse=True)
    uv = 0.5 + np.vstack([place + (shift * period, 0.0) for shift in (-1, 0, 1)]) / scale
    uv = np.vstack([uv, np.full(2, _ELSEWHERE)])[rows]
    return Texture(frozen(uv), frozen(uv_of.reshape(F.shape).astype(np.int32)), image, period / width)


def _flat_places(P: np.ndarray, inside: np.ndarray, mean: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Places (n, 2) in the plane of a part from its middle, its size, and a turn."""
    length = float(np.linalg.norm(mean))
    normal = mean / length if length > 0.1 else np.array([0.0, 1.0, 0.0])  # both sides of a plate have none
    lies = abs(normal[1]) > _LEVEL
    up = np.array([0.0, 0.0, -np.sign(normal[1])] if lies else [0.0, 1.0, 0.0])  # as in the view from above
    up = up - (up @ normal) * normal
    up /= np.linalg.norm(up)
    place = P @ np.column_stack([np.cross(up, normal), up])
    low, high = place[inside].min(axis=0), place[inside].max(axis=0)
    size = high - low
    return place - (low + high) / 2, size, 1e6 * float(size.max())


def _places_around(
    P: np.ndarray, whole: np.ndarray, inside: np.ndarray, N: np.ndarray
) -> tuple[np.ndarray, np.ndarray, float]:
    """Places (n, 2) by angle and height from a part's middle, its size, and a turn."""
    Q = P - _axis_place(P[inside])
    angle = np.arctan2(Q[:, 0], Q[:, 2])  # from the front to the right
    radius = float(np.hypot(Q[inside, 0], Q[inside, 2]).mean())
    seen = np.sort(angle[inside])
    gaps = np.diff(seen, append=seen[0] + 2.0 * np.pi)
    widest = int(gaps.argmax())
    span, middle = 2.0 * np.pi, 0.0
    if gaps[widest] > 1.5 * np.abs(_wrapped(angle[whole] - angle[whole[:, :1]])).max():
        span, middle = span - gaps[widest], seen[widest] + gaps[widest] / 2 + np.pi
    away = N[:, [0, 2]] * Q[whole[:, 0]][:, [0, 2]]
    side = np.copysign(1.0, away.sum())  # on the inside of a cup, right is left
    low, high = Q[inside, 1].min(), Q[inside, 1].max()
    place = np.column_stack([side * radius * _wrapped(angle - middle), Q[:, 1] - (low + high) / 2])
    return place, np.array([radius * span, high - low]), 2.0 * np.pi * radius


def _axis_place(points: np.ndarray) -> np.ndarray:
    """Point (3,) on the axis of the circle nearest to points seen from above."""
    start = points.mean(axis=0)
    x, z = (points - start)[:, 0], (points - start)[:, 2]
    terms = np.column_stack([x, z, np.ones(len(x))])
    found = np.linalg.lstsq(terms, x * x + z * z, rcond=None)[0]
    return np.array([start[0] + found[0] / 2, 0.0, start[2] + found[1] / 2])


def _wrapped(angle: np.ndarray) -> np.ndarray:
    """Angles within half a turn of zero."""
    return angle - 2.0 * math.pi * np.rint(angle / (2.0 * math.pi))
