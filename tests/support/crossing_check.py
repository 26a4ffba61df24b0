"""Crossings of a surface as another library finds them."""

import ipctk
import numpy as np


class CrossingCheck:
    """Crossings of the triangles of a mesh, without those at exempt vertices."""

    def __init__(self, V, F, exempt=()):
        F = np.asfortranarray(F[~np.isin(F, exempt).any(axis=1)], dtype=np.int32)
        self._mesh = ipctk.CollisionMesh(np.asfortranarray(V), ipctk.edges(F), F)

    def crosses(self, U):
        return ipctk.has_intersections(self._mesh, np.asfortranarray(U))
