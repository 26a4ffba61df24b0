"""Paint of a document as a selection, and back."""

from __future__ import annotations

from dataclasses import replace

from apd_viewer.files.selections.selection import Selection
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.handles_and_regions import Handle, NamedRegion


def selection_of(document: Document) -> Selection:
    """The paint, with the names of its parts."""
    names = [handle.name for handle in document.handles], [region.name for region in document.regions]
    areas = [region.area for region in document.regions]
    return Selection.with_default_names(document.labels, document.member, *names, areas)


def with_selection(document: Document, selection: Selection) -> Document:
    """The same document, painted in another way."""
    regions = map(NamedRegion, selection.regions, selection.areas)
    weld = document.mesh.weld
    codes = selection.labels, selection.member
    if len(weld.first) < len(weld.inverse):  # both sides of a seam are painted alike
        codes = frozen(codes[0][weld.first][weld.inverse]), frozen(codes[1][weld.first][weld.inverse])
    labels, member = codes
    return replace(
        document,
        labels=labels,
        member=member,
        handles=tuple(map(Handle, selection.handles)),
        regions=tuple(regions),
    )
