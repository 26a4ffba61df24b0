"""Findings about boundary edges on others."""

from __future__ import annotations

from collections.abc import Iterator

from apd_viewer.geometry.analysis.findings import Finding
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.seams import Seams

# The kind of the finding about seams that can be welded.
SEAMS = "open seams"


def of_seams(mesh: Mesh) -> Iterator[Finding]:
    """Findings about seams to be welded, and about T-joints."""
    found = Seams.of(mesh.V, mesh.F, mesh.weld)
    if found.weldable:
        yield Finding.of(SEAMS, found.weldable, found.edges)
    if found.unweldable:
        yield Finding.of("T-joints", found.unweldable, found.joints)
