"""Vertex colours: paint, falloff, preview and marks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from apd_viewer.geometry.pose.constraints import FREE, HANDLE
from apd_viewer.presentation.palette import falloff_colors, label_colors, tinted_colors
from apd_viewer.session.model.document_parts import have_same_paint

if TYPE_CHECKING:
    from apd_viewer.session.model.document import Document
    from apd_viewer.ui.scene.surface import Surface
    from apd_viewer.ui.scene.vertex_marks import VertexMarks


class Coloring:
    """Keeps the colours of a surface in step with the document.

    Parameters
    ----------
    surface : Surface
    marks : VertexMarks

    Attributes
    ----------
    previewed_ids : int array or None
        What is tinted, as a press would choose it.
    """

    def __init__(self, surface: Surface, marks: VertexMarks) -> None:
        self._surface, self._marks = surface, marks
        self._document: Document | None = None
        self._of_file = self._covered = False
        self.previewed_ids: np.ndarray | None = None

    def begin_mesh(self, document: Document) -> np.ndarray:
        """Colours of another mesh, (n, 4) uint8, without preview and marks."""
        self._document, self.previewed_ids = document, None
        self._marks.show(None)
        return colors_of(document, unpainted_colors=self._own)

    def show_file_colors(self, on: bool) -> None:
        """Show the vertex colours of the file under the paint, or none."""
        self._of_file = on
        self._repaint()

    def set_covered(self, on: bool) -> None:
        """Leave the colours of the file out while an overlay shows others."""
        if on != self._covered:
            self._covered = on
            self._repaint()

    @property
    def _own(self) -> np.ndarray | None:
        if self._document is None or not self._of_file or self._covered:
            return None
        return self._document.mesh.colors

    def _repaint(self) -> None:
        if self._document is not None and self._document.mesh.colors is not None:
            self._restore(np.arange(len(self._document.labels)))

    def follow(self, document: Document) -> None:
        """Update the colours to another document of the mesh."""
        before, self._document = self._document, document
        if before is not None and not _looks_like(before, document):
            self._restore(differing_vertices(before, document))

    def _restore(self, ids: np.ndarray) -> None:
        """Restore the vertices' own colours."""
        if self._document is not None:
            self._surface.set_colors(colors_of(self._document, ids, self._own), ids)
        if self._marks.ids is not None:
            self._surface.set_colors(self._marks.colors(), self._marks.ids)

    def preview(self, ids: np.ndarray | None, color: tuple[int, int, int]) -> None:
        """Tint the vertices ``ids``, and those at the same places, and no others any more."""
        document, before = self._document, self.previewed_ids
        if document is None or (ids is None and before is None):
            return
        self.previewed_ids = None if ids is None else document.mesh.weld.with_coincident(ids)
        if before is not None:
            self._restore(before)
        if self.previewed_ids is not None:
            colors = colors_of(document, self.previewed_ids, self._own)
            self._surface.set_colors(tinted_colors(colors, color), self.previewed_ids)

    def mark(self, vertices: np.ndarray | None) -> None:
        """Mark vertices; all for an empty array, none for None."""
        document, before = self._document, self._marks.ids
        if document is None:
            return
        if before is not None:
            self._marks.show(None)
            self._restore(before)
        if vertices is None:
            return
        every = np.arange(len(document.mesh.V))
        self._marks.show(document.mesh.weld.with_coincident(vertices) if len(vertices) else every, vertices)
        self._surface.set_colors(self._marks.colors(), self._marks.ids)


def colors_of(
    document: Document, ids: np.ndarray | None = None, unpainted_colors: np.ndarray | None = None
) -> np.ndarray:
    """RGBA of the vertices ``ids``, or of all, (k, 4) uint8 array.

    ``unpainted_colors``, (n, 3), are the colours of all vertices without paint.
    """
    some = slice(None) if ids is None else ids
    labels, member = drawn_labels(document, some)
    colors = label_colors(labels, member)
    if unpainted_colors is not None:
        bare = (labels == FREE) & (member == 0)
        colors[bare, :3] = unpainted_colors[some][bare]
    soft = document.soft_constraints
    if len(soft.ids):
        where = np.full(len(document.labels), -1)
        where[soft.ids] = np.arange(len(soft.ids))
        places = where[some]
        pulled = (places >= 0) & ~document.flags.hidden.labels[HANDLE + soft.handle[places]]
        colors[pulled] = falloff_colors(
            colors[pulled], soft.handle[places[pulled]], soft.strength[places[pulled]]
        )
    return colors


def drawn_labels(document: Document, ids: np.ndarray | slice) -> tuple[np.ndarray, np.ndarray]:
    """Labels and region numbers of ``ids`` as drawn: hidden parts as unpainted."""
    hidden = document.flags.hidden
    labels, member = document.labels[ids], document.member[ids]
    if hidden.labels.any():
        labels = np.where(hidden.labels[labels], FREE, labels)
    if hidden.regions.any():
        member = np.where(hidden.regions[member], 0, member)
    return labels, member


def _looks_like(old: Document, new: Document) -> bool:
    return (
        have_same_paint(old, new) and old.soft_constraints is new.soft_constraints and old.flags == new.flags
    )


def differing_vertices(old: Document, new: Document) -> np.ndarray:
    """Vertices of different colour in two documents, ascending."""
    (labels, member), (other, others) = drawn_labels(old, slice(None)), drawn_labels(new, slice(None))
    differ = (labels != other) | (member != others)
    if old.soft_constraints is not new.soft_constraints or old.flags != new.flags:
        differ[old.soft_constraints.ids] = differ[new.soft_constraints.ids] = True
    return np.flatnonzero(differ)
