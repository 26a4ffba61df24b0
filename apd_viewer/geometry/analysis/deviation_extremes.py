"""Extremes of a deviation, and its values quantised for colours."""

from __future__ import annotations

import numpy as np
from numba import prange

from apd_viewer.geometry.linalg.threads import cores_for, parallel


def write_shades(values: np.ndarray, signed: bool, reach: float, shades: np.ndarray) -> None:
    """Quantise ``values`` (n,) to ``shades`` (n,) uint8; the scale ends at ``reach``.

    With a sign -reach, 0 and reach are 1, 128 and 255, without one 0 and reach are 1 and 255; what is beyond
    is as the end, and 0 is no value.
    """
    with cores_for(len(values)):
        _write_shades(values, signed, reach, shades)


@parallel()
def _write_shades(values: np.ndarray, signed: bool, reach: float, shades: np.ndarray) -> None:
    scale = (127.0 if signed else 254.0) / reach
    zero = 128.5 if signed else 1.5  # truncated, it is rounded
    for v in prange(len(values)):
        x = values[v]
        shades[v] = np.uint8(0) if np.isnan(x) else np.uint8(min(max(zero + scale * x, 1.0), 255.0))


def extreme_vertices(values: np.ndarray, U: np.ndarray, least_distance: float, most: int) -> np.ndarray:
    """Vertices of the largest absolute ``values`` (n,), worst first, kept apart.

    Parameters
    ----------
    values : (n,) float array
    U : (n, 3) float array
    least_distance : float
        Their least distance.
    most : int
        How many at most.
    """
    size = np.where(np.isnan(values), 0.0, np.abs(values))
    found: list[int] = []
    while len(found) < most:
        v = int(size.argmax())
        if size[v] <= 0.0:
            break
        found.append(v)
        size[((U - U[v]) ** 2).sum(axis=1) < least_distance**2] = 0.0
    return np.array(found, dtype=np.int64)
