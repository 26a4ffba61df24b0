"""Falloff of handles with the distance along the surface.

A vertex at the distance d from a handle with the falloff r is drawn to where the handle would carry it, by a
spring whose energy is ``2 w |u - t|^2``, to go with ``grad E = 4 (K U - b)`` of the surface:

    w = firmness m (1 - (d / r)^2)^2 / r^2,        m the vertex area.

So scaled, springs are as firm against the surface whatever its size, its resolution and the falloff are.
"""

from typing import TypeAlias

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra

from apd_viewer.geometry.mesh.edges_and_components import undirected_edges
from apd_viewer.geometry.pose.constraints import SoftConstraints

Graph: TypeAlias = csr_array

_FIRMNESS = 25.0


def edge_graph(V: np.ndarray, F: np.ndarray) -> Graph:
    """Sparse matrix (n, n) of the edge lengths of ``V`` (n, 3), ``F`` (m, 3)."""
    low, high = undirected_edges(F, len(V)).T
    # The graph search ignores edges of length zero, so that coincident vertices need a tiny length.
    length = np.maximum(np.linalg.norm(V[high] - V[low], axis=1), np.finfo(float).tiny)
    graph: Graph = coo_array((length, (low, high)), shape=(len(V), len(V))).tocsr()
    return graph


def distances(graph: Graph, start: np.ndarray, limit: float) -> np.ndarray:
    """Graph distance of each vertex from ``start``, (n,); inf beyond ``limit``."""
    if not len(start):
        return np.full(graph.shape[0], np.inf)
    found: np.ndarray = dijkstra(graph, directed=False, indices=start, min_only=True, limit=limit)
    return found


def falloff_strengths(distance: np.ndarray, falloff: float) -> np.ndarray:
    """Strength ``(1 - (d / r)^2)^2`` of a falloff r at distance d; 0 beyond r."""
    share = np.clip(1.0 - (distance / falloff) ** 2, 0.0, 1.0)
    return share * share


def soft_constraints(free: np.ndarray, strength: np.ndarray, falloffs: np.ndarray) -> SoftConstraints:
    """Soft constraints on free vertices, each by the handle with the largest strength.

    Parameters
    ----------
    free : (n,) bool array
        Vertices that may be constrained.
    strength : (h, n) float array
        Of every handle at every vertex: see :func:`falloff_strengths`.
    falloffs : (h,) float array
    """
    handle = strength.argmax(axis=0)
    strongest = np.take_along_axis(strength, handle[None], axis=0)[0]
    ids = np.flatnonzero(free & (strongest > 0.0))
    strength, handle = strongest[ids], handle[ids]
    return SoftConstraints(ids, strength, _FIRMNESS * strength / falloffs[handle] ** 2, handle)
