"""Findings about seams and about double walls."""

from __future__ import annotations

from collections.abc import Iterator

from apd_viewer.geometry.analysis.double_wall import DoubleWall
from apd_viewer.geometry.analysis.mesh_findings import Finding
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.seams import Seams
from apd_viewer.language import tr

# The kind of the finding about seams that can be welded.
SEAMS = "open seams"


def seam_findings(mesh: Mesh) -> Iterator[Finding]:
    """Findings about seams to be welded, and about T-joints."""
    found = Seams.from_mesh(mesh.V, mesh.F, mesh.weld)
    if found.weldable_sentence:
        yield Finding.at_vertices(SEAMS, found.weldable_sentence, found.edges)
    if found.unweldable_sentence:
        yield Finding.at_vertices("T-joints", found.unweldable_sentence, found.joints)


def double_wall_findings(wall: DoubleWall | None) -> Iterator[Finding]:
    """Finding about a vessel with an outer and an inner surface."""
    if wall is None:
        return
    said = tr(
        "A vessel with two walls, {thickness:.3g} apart: its volume, {material:,.6g}, is that of its "
        "material, and it holds {capacity:,.6g}; to deform it as one wall, export one of its surfaces."
    )
    yield Finding.at_vertices("double wall", said.format(**wall._asdict()))
