"""Findings about the loose parts of a document."""

from collections.abc import Iterator

import numpy as np

from apd_viewer.geometry.analysis.mesh_findings import Finding
from apd_viewer.geometry.pose.constraints import FREE
from apd_viewer.language import tr, trn
from apd_viewer.session.model import memo
from apd_viewer.session.model.document import Document

# Number of parts listed individually, the largest first; the first finding includes all.
_MOST = 100


def loose_component_findings(document: Document) -> Iterator[tuple[Finding, tuple[int, ...]]]:
    """Findings about all loose parts, then about each with its lowest vertex ID.

    Before anything is painted, the largest part is left out, since it will probably be painted.
    """
    parts = document.loose_components
    if not (document.labels != FREE).any():
        parts = parts[1:]
    if len(parts) > 1:
        said = tr("All {n:,} loose parts").format(n=len(parts))
        yield _finding(document, said, tuple(part.first for part in parts))
    for part in parts[:_MOST]:
        said = trn("Loose part, {n:,} triangle", "Loose part, {n:,} triangles", part.triangles)
        yield _finding(document, said.format(n=part.triangles), (part.first,))


def _finding(document: Document, sentence: str, firsts: tuple[int, ...]) -> tuple[Finding, tuple[int, ...]]:
    mesh = document.mesh
    vertices = np.unique(mesh.F[np.isin(memo.triangle_components(mesh.joined_F), firsts)])
    return Finding("loose part", sentence, vertices), firsts
