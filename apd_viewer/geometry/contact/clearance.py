"""Clearance between an obstacle and a surface."""

from __future__ import annotations

import numpy as np

from apd_viewer.geometry.contact.contact_obstacles import Obstacle
from apd_viewer.geometry.contact.distances import gaps

_PLATE, _CAPSULE = 3, 2  # by the number of their points


def clearance(obstacle: Obstacle, shift: np.ndarray, U: np.ndarray, F: np.ndarray) -> float:
    """Least distance of an obstacle from a surface; negative if they intersect.

    Of what the surface encloses nothing counts: a sphere may be inside a closed surface. Behind a plate
    everything intersects it.

    Parameters
    ----------
    obstacle : Obstacle
    shift : (3,) float array
        How far it is from its place, mesh units.
    U : (n, 3) float array
    F : (m, 3) int array
    """
    if not len(F):
        return np.inf
    points = obstacle.points + shift
    corners = np.unique(F)
    away = np.full(len(U), np.inf)
    away[corners] = obstacle.distances_and_directions(points, U[corners])[0]
    least = float(away[corners].min())
    if len(points) == _PLATE:
        return least
    near = F[_may_be_nearer(U, F, away, least)]
    if len(points) == _CAPSULE and _pierced(U[near], *points):
        return -obstacle.radius
    return min(least, _least_distance(points, U, near) - obstacle.radius)


def _may_be_nearer(U: np.ndarray, F: np.ndarray, away: np.ndarray, least: float) -> np.ndarray:
    """Mask (m,) of the triangles that may be nearer than any vertex, at ``least``."""
    edges = U[F] - U[np.roll(F, 1, axis=1)]
    longest = np.sqrt(np.einsum("ijk,ijk->ij", edges, edges).max(axis=1))
    return away[F].min(axis=1) - longest <= least


def _least_distance(points: np.ndarray, U: np.ndarray, F: np.ndarray) -> float:
    """Least distance of one or two points, and of the line between them, from ``F``."""
    corners, inverse = np.unique(F, return_inverse=True)
    n, F = len(corners), inverse.reshape(-1, 3)
    X = np.concatenate([U[corners], points])
    pairs = [np.insert(F, 0, n + k, axis=1) for k in range(len(points))]
    if len(points) == _CAPSULE:
        E = np.unique(np.sort(np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]), axis=1), axis=0)
        pairs.append(np.insert(np.insert(E, 0, n + 1, axis=1), 0, n, axis=1))
    found = np.ascontiguousarray(np.concatenate(pairs), np.int32)
    edges = np.arange(len(found)) >= len(points) * len(F)
    return float(gaps(X, found, edges).min(initial=np.inf))


def _pierced(T: np.ndarray, a: np.ndarray, b: np.ndarray) -> bool:
    """True if the line from ``a`` to ``b`` goes through a triangle of ``T`` (m, 3, 3).

    By the signs of volumes [Segura & Feito 2001]; where it only touches an edge, distances tell.
    """
    u, v, w, way = T[:, 0] - a, T[:, 1] - a, T[:, 2] - a, b - a
    normal = np.cross(v - u, w - u)
    before = np.einsum("ij,ij->i", u, normal)
    after = before - normal @ way
    sides = np.array([np.cross(x, y) @ way for x, y in ((u, v), (v, w), (w, u))])
    within = (sides > 0.0).all(axis=0) | (sides < 0.0).all(axis=0)
    return bool((within & (before * after < 0.0)).any())
