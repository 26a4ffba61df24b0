"""Collar: the free surface next to held vertices, solved for alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import KDTree

from apd_viewer.geometry.energy.elastic_surface import ElasticSurface
from apd_viewer.geometry.energy.solve_mesh import SolveMesh

# Rings of triangles around the free vertices: bending reaches so far.
_RINGS = 2
# With more vertices a factorization takes too long.
_MOST = 100_000


class Collar:
    """The free vertices within a distance of held ones, all others in place.

    A surface that follows a coarse one bends as sharply as that beside what is held. Next to there a global
    step of its own makes it smooth.

    Parameters
    ----------
    elastic : ElasticSurface
        The whole surface; it is not touched.
    width : float
        The distance, mesh units.
    """

    def __init__(self, elastic: ElasticSurface, width: float) -> None:
        V, F = elastic.rest.V, elastic.rest.F
        held = np.zeros(len(V), dtype=bool)
        held[elastic.fixed] = True
        border = np.unique(F[held[F].any(axis=1) & ~held[F].all(axis=1)])
        away = KDTree(V[border[held[border]]]).query(V, distance_upper_bound=width, workers=-1)[0]
        solved = np.isfinite(away) & ~held
        self._part = self._vertices = None
        if 0 < solved.sum() <= _MOST:
            self._part, self._vertices = _subsurface(elastic, solved)

    def smoothed(self, U: np.ndarray) -> np.ndarray:
        """The positions ``U`` (n, 3) after an iteration of the collar."""
        if self._part is None:
            return U
        part, start = self._part, U[self._vertices]
        part.restart(start)
        part.iterate(start[part.fixed])
        smoothed = U.copy()
        smoothed[self._vertices] = part.U
        return smoothed


def _subsurface(elastic: ElasticSurface, solved: np.ndarray) -> tuple[ElasticSurface, np.ndarray]:
    """Surface around the vertices ``solved`` (n,) bool, and its vertices in the whole."""
    rest, near = elastic.rest, solved.copy()
    F = rest.F
    for _ in range(_RINGS):
        near[F[near[F].any(axis=1)]] = True
    F = F[near[F].all(axis=1)]
    vertices, corners = np.unique(F, return_inverse=True)
    shape = SolveMesh(rest.V[vertices], corners.reshape(-1, 3))
    # Both are in proportion to the area of the mesh.
    growth, material = rest.vertex_areas.sum() / shape.vertex_areas.sum(), elastic.material
    material = replace(material, bending=growth * material.bending, coupling=growth * material.coupling)
    return ElasticSurface(shape, np.flatnonzero(~solved[vertices]), material), vertices
