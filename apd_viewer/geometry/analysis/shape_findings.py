"""Findings about seams and about double walls."""

from __future__ import annotations

from collections.abc import Iterator

from apd_viewer.geometry.analysis.double_wall import DoubleWall
from apd_viewer.geometry.analysis.findings import Finding
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.seams import Seams
from apd_viewer.language import tr

# The kind of the finding about seams that can be welded.
SEAMS = "open seams"


def of_seams(mesh: Mesh) -> Iterator[Finding]:
    """Findings about seams to be welded, and about T-joints."""
    found = Seams.of(mesh.V, mesh.F, mesh.weld)
    if found.weldable:
        yield Finding.of(SEAMS, found.weldable, found.edges)
    if found.unweldable:
        yield Finding.of("T-joints", found.unweldable, found.joints)


def of_double_wall(wall: DoubleWall | None) -> Iterator[Finding]:
    """Finding about a vessel with an outer and an inner surface."""
    if wall is None:
        return
    said = tr(
        "A vessel with two walls, {thickness:.3g} apart: its volume, {material:,.6g}, is that of its "
        "material, and it holds {capacity:,.6g}; to deform it as one wall, export one of its surfaces."
    )
    yield Finding.of("double wall", said.format(**wall._asdict()))
