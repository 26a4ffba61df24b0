"""Flat caps over the openings of a surface, to define the volume of open bottles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.edges_and_components import (
    boundary_edges,
    edge_defect_counts,
    vertex_components,
)
from apd_viewer.geometry.mesh.operators import encloses_nothing, face_areas, volume

# Least mean depth below the caps (volume over their area), over the root of their area. A sheet that is
# nearly flat has less: it holds nothing, and its volume would only be that of its hems and waves. A vessel
# has more: a hemisphere 0.38, a tray 0.05 times as deep as it is wide 0.05, a long tube ever more.
_SHALLOW = 0.02


@dataclass(frozen=True, eq=False)
class Caps:
    """Triangle fans from each opening's border to the mean of its vertices.

    Over a border in one plane the fan is the flat cap, whatever the shape of the border; over another one it
    is a choice, which changes smoothly with the shape.

    Attributes
    ----------
    ends : (b, 2) int array
        The edges of the borders as the caps pass them, opening by opening.
    start : (openings,) int array
        Index of the first edge of each opening.
    """

    ends: np.ndarray
    start: np.ndarray

    @classmethod
    def from_triangles(cls, F: np.ndarray, opposite: np.ndarray) -> Caps | None:
        """Caps of triangles ``F`` (m, 3); None if closed, or other defects exist.

        ``opposite`` (m, 3) are their :func:`.opposite_half_edges`.
        """
        border, crowded, one_way = edge_defect_counts(F, opposite)
        if not border or crowded or one_way:
            return None
        ends = boundary_edges(F, opposite)[:, ::-1].copy()
        names, corner = np.unique(ends, return_inverse=True)
        corner = corner.reshape(-1, 2)
        opening = vertex_components(corner[:, [0, 1, 1]], len(names))[corner[:, 0]]
        order = np.argsort(opening, kind="stable")
        start = np.flatnonzero(np.diff(opening[order], prepend=-1))
        return cls(frozen(ends[order]), frozen(start))

    @property
    def count(self) -> int:
        """Number of openings."""
        return len(self.start)

    def at(self, vertices: np.ndarray) -> np.ndarray:
        """Mask (openings,) of those with one of ``vertices`` at their border."""
        return np.logical_or.reduceat(np.isin(self.ends[:, 0], vertices), self.start)

    def closed_surface(
        self, U: np.ndarray, F: np.ndarray, closed: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Positions and triangles with the caps of a mask ``closed`` (openings,)."""
        size = np.diff(self.start, append=len(self.ends))
        apex = np.add.reduceat(U[self.ends[:, 0]], self.start) / size[:, None]
        fans = np.column_stack([self.ends, len(U) + np.repeat(np.arange(self.count), size)])
        return np.vstack([U, apex]), np.vstack([F, fans[np.repeat(closed, size)]])

    def volume(self, U: np.ndarray, origin: np.ndarray) -> float:
        """Signed volume between ``origin`` (3,) and the caps at ``U`` (n, 3)."""
        p, q = U[self.ends[:, 0]] - origin, U[self.ends[:, 1]] - origin
        size = np.diff(self.start, append=len(p))
        apex = np.repeat(np.add.reduceat(p, self.start) / size[:, None], size, axis=0)
        return float(np.einsum("ij,ij->", apex, np.cross(p, q))) / 6.0

    def volume_and_gradient(self, U: np.ndarray, origin: np.ndarray, g: np.ndarray) -> float:
        """Volume under the caps; adds its gradient at a fixed origin to ``g`` (n, 3)."""
        p, q = U[self.ends[:, 0]] - origin, U[self.ends[:, 1]] - origin
        size = np.diff(self.start, append=len(p))
        apex = np.repeat(np.add.reduceat(p, self.start) / size[:, None], size, axis=0)
        across = np.cross(p, q)
        pull = np.repeat(np.add.reduceat(across, self.start) / size[:, None], size, axis=0)
        np.add.at(g, self.ends[:, 0], (np.cross(q, apex) + pull) / 6.0)
        np.add.at(g, self.ends[:, 1], np.cross(apex, p) / 6.0)
        return float(np.einsum("ij,ij->", apex, across)) / 6.0

    def area(self, U: np.ndarray) -> float:
        """Total area of the caps, each projected along its area vector."""
        origin = U[self.ends[0, 0]]
        p, q = U[self.ends[:, 0]] - origin, U[self.ends[:, 1]] - origin
        return 0.5 * float(np.linalg.norm(np.add.reduceat(np.cross(p, q), self.start), axis=1).sum())


def capped_volume(caps: Caps | None, U: np.ndarray, F: np.ndarray) -> float | None:
    """Signed volume inside ``F`` (m, 3) and its caps; None without a volume.

    A sheet has none. To be decided at rest: a sheet encloses nothing when it is folded, either.
    """
    if caps is None:
        return None
    inside = volume(U, F) + caps.volume(U, U[F[0, 0]])
    is_sheet = abs(inside) <= _SHALLOW * caps.area(U) ** 1.5
    return None if is_sheet or encloses_nothing(inside, float(face_areas(U, F).sum())) else inside
