"""Rest mesh, with all quantities independent of the held vertices."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.solve_mesh import SolveMesh
from apd_viewer.geometry.linalg.threads import cores_for
from apd_viewer.geometry.mesh.arrays import diagonal, frozen, local_origin, mesh_arrays
from apd_viewer.geometry.mesh.decimation import Decimation
from apd_viewer.geometry.mesh.edges_and_components import missing_volume_reason, opposite_half_edges
from apd_viewer.geometry.mesh.hole_caps import Caps, capped_volume
from apd_viewer.geometry.mesh.operators import encloses_nothing, face_areas
from apd_viewer.geometry.mesh.seams import Seams
from apd_viewer.geometry.mesh.weighted_areas import SLIVER, edge_lengths, shape_readings
from apd_viewer.geometry.mesh.weld import SEAM_TOLERANCE, Weld
from apd_viewer.language import tr


class ShapeMeasures(NamedTuple):
    """Area and volume readings of a shape, named as in :class:`Frame`.

    Attributes
    ----------
    area : float
    volume : float or None
        None if the mesh is not closed.
    local_change : float
        Largest relative change of a triangle's area, up or down.
    largest_edge_strain, mean_edge_strain : float
        As in :class:`Frame <apd_viewer.geometry.pose.frame.Frame>`.
    volume_capped : float or None
        With flat caps over the openings; None if there are none, or they would not close the mesh.
    """

    area: float
    volume: float | None
    local_change: float
    largest_edge_strain: float
    mean_edge_strain: float
    volume_capped: float | None


class RestMesh:
    """Rest mesh of a deformation, computed once per mesh.

    A mesh far from the origin is solved relative to its :attr:`centre`, since squares of its coordinates
    would leave no digits for its shape. Local positions are relative to it.

    Parameters
    ----------
    V : (n, 3) float array, rest positions
    F : (m, 3) int array, triangles
    weld : Weld, optional
        The maps to the vertices of the solve, where they are known already.
    decimations : sequence of Decimation
        Of :attr:`solve_mesh` and of those thinner, as far as they are known already.

    Attributes
    ----------
    centre : (3,) float array
        Place of the local origin; that of the mesh's own coordinates unless they are far from it.
    V : (n, 3) float array
        Rest positions, local.
    """

    def __init__(
        self, V: np.ndarray, F: np.ndarray, weld: Weld | None = None, decimations: Sequence[Decimation] = ()
    ) -> None:
        used = np.zeros(len(V), dtype=bool)
        used[F.ravel()] = True
        self.centre = local_origin(V[used])
        self.F, self._is_far = F, bool(self.centre.any())
        weld = weld or Weld.from_positions(V, F)
        self.V = V = self.to_local(V)
        self.weld = Weld.from_maps(V, weld.first, weld.inverse) if self._is_far else weld
        self.face_areas = face_areas(V, F)
        self.area = float(self.face_areas.sum())
        if self.area <= 0.0:
            raise InputError(tr("The mesh has no area: all its faces are degenerate; export it again."))
        self.solve_mesh = SolveMesh(V[self.weld.first], self.weld.inverse[F], decimations)
        self.diagonal = diagonal(V[used])

    def to_local(self, X: np.ndarray) -> np.ndarray:
        """Local positions, relative to the centre, of ``X`` (k, 3) in mesh coordinates."""
        return X - self.centre if self._is_far else X

    def to_mesh_coordinates(self, X: np.ndarray) -> np.ndarray:
        """Mesh coordinates of the local positions ``X`` (k, 3)."""
        return X + self.centre if self._is_far else X

    @classmethod
    def from_arrays(cls, V: object, F: object, weld: bool = False) -> RestMesh:
        """Rest mesh of checked arrays; with ``weld`` its seams are welded."""
        V, F = mesh_arrays(V, F)
        return cls(V, F, Weld.from_positions(V, F, SEAM_TOLERANCE) if weld else None)

    @property
    def in_place_tolerance(self) -> float:
        """Distance within which held vertices count as in place, mesh units."""
        return self.weld.in_place_tolerance(self.diagonal)

    @cached_property
    def seams(self) -> Seams:
        """Unjoined coincident boundary edges."""
        return Seams.from_mesh(self.V, self.F, self.weld, self._opposite_half_edges)

    @cached_property
    def missing_volume_reason(self) -> str | None:
        """Reason for an undefined volume, as a phrase; None if the mesh encloses one."""
        return missing_volume_reason(self.solve_mesh.F, self._opposite_half_edges)

    @cached_property
    def _opposite_half_edges(self) -> np.ndarray:
        return frozen(opposite_half_edges(self.solve_mesh.F, len(self.solve_mesh.V)))

    @cached_property
    def volume(self) -> float | None:
        """Enclosed volume of the rest shape, 0 if flat; None if the mesh is not closed."""
        with cores_for(len(self.solve_mesh.V)):
            found = self.measure(self.solve_mesh.V).volume
        return 0.0 if found is not None and encloses_nothing(found, self.area) else found

    @cached_property
    def caps(self) -> Caps | None:
        """Caps of the openings; None if absent or unable to close the mesh."""
        caps = Caps.from_triangles(self.solve_mesh.F, self._opposite_half_edges)
        return caps if capped_volume(caps, self.solve_mesh.V, self.solve_mesh.F) is not None else None

    @property
    def openings(self) -> int:
        """Number of openings capped for :attr:`volume_capped`."""
        return self.caps.count if self.caps is not None else 0

    @cached_property
    def volume_capped(self) -> float | None:
        """Rest volume with flat caps over the openings; None if not enclosed."""
        with cores_for(len(self.solve_mesh.V)):
            return self.measure(self.solve_mesh.V).volume_capped

    def measure(self, U: np.ndarray) -> ShapeMeasures:
        """Readings of the shape ``U`` (k, 3), positions of the solve mesh's vertices."""
        least = SLIVER * self.area / len(self.F)
        F, caps = self.solve_mesh.all_triangles.F, self.caps
        area, volume, change, strain, strains = shape_readings(
            U, F, self.face_areas, self._edge_lengths, least
        )
        return ShapeMeasures(
            area=float(area),
            volume=None if self.missing_volume_reason else float(volume),
            local_change=float(change),
            largest_edge_strain=float(strain),
            mean_edge_strain=float(strains) / self.area,
            volume_capped=None if caps is None else float(volume) + caps.volume(U, U[F[0, 0]]),
        )

    @cached_property
    def _edge_lengths(self) -> np.ndarray:
        return edge_lengths(self.solve_mesh.V, self.solve_mesh.F)

    def energy(self, U: np.ndarray) -> float:
        """ARAP energy (Eq. 1) of the positions ``U`` (n, 3)."""
        with cores_for(len(self.solve_mesh.V)):
            return self.solve_mesh.energy(self.to_local(U[self.weld.first]))
