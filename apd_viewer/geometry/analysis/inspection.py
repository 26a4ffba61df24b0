"""Inspection of a mesh: its contents and defects."""

from dataclasses import dataclass

import numpy as np

from apd_viewer.geometry.analysis.double_wall import DoubleWall, double_wall, is_too_large_for_double_wall
from apd_viewer.geometry.analysis.mesh_findings import (
    Finding,
    component_findings,
    face_findings,
    file_findings,
    nesting_findings,
    orientation_findings,
    size_findings,
    topology_findings,
    vertex_findings,
)
from apd_viewer.geometry.analysis.shape_check import double_wall_findings, seam_findings
from apd_viewer.geometry.mesh.arrays import extents, used_vertices
from apd_viewer.geometry.mesh.edges_and_components import missing_volume_reason, vertex_components
from apd_viewer.geometry.mesh.hole_caps import Caps, capped_volume
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.operators import encloses_nothing, face_areas, volume
from apd_viewer.language import tr


@dataclass(frozen=True)
class Inspection:
    """Counts, readings and findings of an undeformed mesh.

    Attributes
    ----------
    vertices, faces : int
        Counts of the file.
    components : int
        Connected pieces of the surface, after vertices at the same position are joined.
    area, volume : float
        Square and cubic mesh units; volume is None where ``missing_volume_reason`` says why.
    volume_capped : float or None
        Of an open surface with flat caps over its ``openings``; None where that encloses nothing.
    openings : int
        Number of capped openings.
    size : tuple of float
        Extent along x, y and z.
    double_wall : DoubleWall or None
        Wall of a vessel with an inner and an outer surface.
    findings : tuple of Finding
    """

    vertices: int
    faces: int
    components: int
    area: float
    volume: float | None
    missing_volume_reason: str | None
    volume_capped: float | None
    openings: int
    size: tuple[float, float, float]
    double_wall: DoubleWall | None
    findings: tuple[Finding, ...]

    @property
    def missing_volume_phrase(self) -> str:
        """Reason for a missing volume, as a phrase; empty if there is a volume."""
        return "" if self.volume else self.missing_volume_reason or tr("the surface encloses no volume")


def inspect(mesh: Mesh) -> Inspection:
    """Inspect the undeformed mesh as read from its file."""
    first, inverse = mesh.weld.first, mesh.weld.inverse
    F, opposite = inverse[mesh.F], mesh.opposite_half_edges
    why = missing_volume_reason(F, opposite)
    caps = Caps.from_triangles(F, opposite) if why else None
    capped = capped_volume(caps, mesh.V[first], F)
    areas = face_areas(mesh.V, mesh.F)
    area = float(areas.sum())
    inside = None if why else volume(mesh.V[first], F)
    if inside is not None and encloses_nothing(inside, area):
        inside = 0.0
    piece = vertex_components(F, len(first))
    surface = mesh.V[first], F, piece[F[:, 0]], areas
    wall = None if inside is None else double_wall(*surface, inside)
    is_unknown = inside is not None and is_too_large_for_double_wall(*surface, inside)
    dx, dy, dz = (float(extent) for extent in extents(mesh.V[used_vertices(mesh.F)]))
    return Inspection(
        vertices=len(mesh.V),
        faces=len(mesh.F),
        components=int(np.count_nonzero(np.bincount(piece[F[:, 0]]))),
        area=area,
        volume=inside,
        missing_volume_reason=why,
        volume_capped=capped,
        openings=0 if caps is None or capped is None else caps.count,
        size=(dx, dy, dz),
        double_wall=wall,
        findings=(
            *file_findings(mesh),
            *vertex_findings(mesh),
            *face_findings(mesh, areas),
            *topology_findings(mesh, F),
            *(seam_findings(mesh) if why else ()),  # a closed surface has no open seams
            *double_wall_findings(wall, is_unknown),
            *orientation_findings(capped if why else inside, area),
            *(() if why else nesting_findings(mesh, F, piece[F[:, 0]], areas)),
            *component_findings(mesh, F, piece),
            *size_findings(mesh),
        ),
    )
