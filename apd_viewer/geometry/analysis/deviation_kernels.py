"""Kernels of the deviation from the rest shape: values, extremes, colour levels."""

from __future__ import annotations

import numpy as np
from numba import prange

from apd_viewer.geometry.linalg.threads import cores_for, parallel


@parallel()
def area_change(
    U: np.ndarray,
    F: np.ndarray,
    rest: np.ndarray,
    least: float,
    start: np.ndarray,
    corner: np.ndarray,
    representative: np.ndarray,
    ratios: np.ndarray,
) -> np.ndarray:
    """Logarithm of the area ratio of the most changed triangle at each vertex, (n,).

    NaN at a vertex without a triangle of more than ``least`` area at rest; ``ratios`` (m,) is room.
    """
    for t in prange(len(F)):
        i, j, k = F[t, 0], F[t, 1], F[t, 2]
        ax, ay, az = U[j, 0] - U[i, 0], U[j, 1] - U[i, 1], U[j, 2] - U[i, 2]
        bx, by, bz = U[k, 0] - U[i, 0], U[k, 1] - U[i, 1], U[k, 2] - U[i, 2]
        x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        own = 0.5 * np.sqrt(x * x + y * y + z * z)
        ratios[t] = own / rest[t] if rest[t] > least else np.nan
    out = np.empty(len(representative))
    for v in prange(len(representative)):
        w, found, largest = representative[v], np.nan, -1.0
        for e in range(start[w], start[w + 1]):
            ratio = ratios[corner[e] // 3]
            if abs(ratio - 1.0) > largest:
                found, largest = ratio, abs(ratio - 1.0)
        out[v] = -np.inf if found == 0.0 else np.log(found)
    return out


@parallel()
def edge_strain(
    U: np.ndarray,
    V: np.ndarray,
    start: np.ndarray,
    second: np.ndarray,
    third: np.ndarray,
    representative: np.ndarray,
) -> np.ndarray:
    """Largest logarithmic strain of the edges at each vertex, (n,)."""
    out = np.empty(len(representative))
    for v in prange(len(representative)):
        w = representative[v]
        # Extremes of the squared ratio, so that one logarithm per vertex is enough.
        most, least = 0.0, np.inf
        for e in range(start[w], start[w + 1]):
            for j in (second[e], third[e]):
                x, y, z = V[j, 0] - V[w, 0], V[j, 1] - V[w, 1], V[j, 2] - V[w, 2]
                before = x * x + y * y + z * z
                if before > 0.0:
                    x, y, z = U[j, 0] - U[w, 0], U[j, 1] - U[w, 1], U[j, 2] - U[w, 2]
                    ratio = (x * x + y * y + z * z) / before
                    most, least = max(most, ratio), min(least, ratio)
        if least == np.inf:
            out[v] = np.nan
        elif least == 0.0:
            out[v] = -np.inf
        else:
            out[v] = 0.5 * np.log(most if most * least >= 1.0 else least)
    return out


@parallel()
def displacements(U: np.ndarray, V: np.ndarray) -> np.ndarray:
    """Distances between corresponding vertices, (n,)."""
    out = np.empty(len(U))
    for v in prange(len(U)):
        x, y, z = U[v, 0] - V[v, 0], U[v, 1] - V[v, 1], U[v, 2] - V[v, 2]
        out[v] = np.sqrt(x * x + y * y + z * z)
    return out


@parallel()
def mean_curvature(
    U: np.ndarray, start: np.ndarray, second: np.ndarray, third: np.ndarray, representative: np.ndarray
) -> np.ndarray:
    """Mean curvature at each vertex, (n,), positive if convex from outside.

    The cotangent Laplacian of the positions along the normal, over twice the area that is nearest to the
    vertex [Meyer et al. 2003]: exact where the vertices around it lie on a sphere with it.
    """
    out = np.empty(len(representative))
    for v in prange(len(representative)):
        w = representative[v]
        area = lx = ly = lz = nx = ny = nz = 0.0
        for e in range(start[w], start[w + 1]):
            j, k = second[e], third[e]
            ax, ay, az = U[j, 0] - U[w, 0], U[j, 1] - U[w, 1], U[j, 2] - U[w, 2]
            bx, by, bz = U[k, 0] - U[w, 0], U[k, 1] - U[w, 1], U[k, 2] - U[w, 2]
            x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
            double = np.sqrt(x * x + y * y + z * z)
            if double > 0.0:
                aa, bb, ab = (
                    ax * ax + ay * ay + az * az,
                    bx * bx + by * by + bz * bz,
                    ax * bx + ay * by + az * bz,
                )
                at_j, at_k = (aa - ab) / double, (bb - ab) / double  # cotangents of the corner angles
                if ab < 0.0:
                    area += 0.25 * double
                elif at_j < 0.0 or at_k < 0.0:
                    area += 0.125 * double
                else:
                    area += 0.125 * (aa * at_k + bb * at_j)
                lx += at_k * ax + at_j * bx
                ly += at_k * ay + at_j * by
                lz += at_k * az + at_j * bz
                nx, ny, nz = nx + x, ny + y, nz + z
        length = np.sqrt(nx * nx + ny * ny + nz * nz)
        out[v] = np.nan
        if area > 0.0 and length > 0.0:
            out[v] = -0.25 * (lx * nx + ly * ny + lz * nz) / (length * area)
    return out


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
    zero = 128.5 if signed else 1.5  # half a level up, as the conversion to integers truncates
    for v in prange(len(values)):
        x = values[v]
        shades[v] = np.uint8(0) if np.isnan(x) else np.uint8(min(max(zero + scale * x, 1.0), 255.0))


def extreme_vertices(values: np.ndarray, U: np.ndarray, least_distance: float, most: int) -> np.ndarray:
    """Separated vertices of the largest absolute ``values`` (n,), largest first.

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
