"""Vertex colours: paint, falloff, preview and marks of findings."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF

from apd_viewer.geometry.pose.constraints import FREE, HANDLE
from apd_viewer.presentation.palette import MARK_COLOR, falloff_colors, label_colors, tinted_colors
from apd_viewer.session.model.document_parts import have_same_paint
from apd_viewer.ui.scene.navigation import MouseTool
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.viewport import Viewport

if TYPE_CHECKING:
    from apd_viewer.session.model.document import Document


class Coloring:
    """Keeps the colours of a surface in step with the document.

    Attributes
    ----------
    previewed_ids : int array or None
        Tinted vertices of a preview.
    """

    def __init__(self, surface: Surface, marks: VertexMarks) -> None:
        self._surface, self._marks = surface, marks
        self._document: Document | None = None
        self._of_file = self._covered = False
        self._pictured: np.ndarray | None = None
        self._member = self._shown_member = np.empty(0)
        self.previewed_ids: np.ndarray | None = None

    def begin_mesh(self, document: Document) -> np.ndarray:
        """Set a new mesh; return its colours (n, 4) uint8, without preview or marks."""
        if self._document is None or self._document.mesh.F is not document.mesh.F:
            self._pictured = None
        self._document, self.previewed_ids = self.without_pictured(document), None
        self._marks.mark_vertices(None)
        return colors_of(self._document, unpainted_colors=self._file_colors)

    def hide_regions_at(self, pictured: np.ndarray | None, document: Document) -> None:
        """Hide the colours of regions where a picture is, (n,) bool, or nowhere."""
        self._pictured, self._member = pictured, np.empty(0)
        self.follow_document(document)

    def without_pictured(self, document: Document) -> Document:
        """Document whose regions end where a picture is."""
        if self._pictured is None:
            return document
        if self._member is not document.member:
            self._member = document.member
            self._shown_member = np.where(self._pictured, np.uint8(0), document.member)
        return replace(document, member=self._shown_member)

    def show_file_colors(self, on: bool) -> None:
        """Show or hide the file's vertex colours under the paint."""
        self._of_file = on
        self._repaint()

    def suppress_file_colors(self, on: bool) -> None:
        """Suppress the file's vertex colours while an overlay or texture is shown."""
        if on != self._covered:
            self._covered = on
            self._repaint()

    @property
    def _file_colors(self) -> np.ndarray | None:
        if self._document is None or not self._of_file or self._covered:
            return None
        return self._document.mesh.colors

    def _repaint(self) -> None:
        if self._document is not None and self._document.mesh.colors is not None:
            self._restore(np.arange(len(self._document.labels)))

    def follow_document(self, document: Document) -> None:
        """Update the colours to a new document of the mesh."""
        before, self._document = self._document, self.without_pictured(document)
        if before is not None and not _have_same_colors(before, self._document):
            self._restore(differing_vertices(before, self._document))

    def _restore(self, ids: np.ndarray) -> None:
        """Restore the colours of the vertices ``ids`` without preview."""
        if self._document is not None:
            self._surface.set_colors(colors_of(self._document, ids, self._file_colors), ids)
        if self._marks.ids is not None:
            self._surface.set_colors(self._marks.colors(), self._marks.ids)

    def preview(self, ids: np.ndarray | None, color: tuple[int, int, int]) -> None:
        """Tint only the vertices ``ids`` and coincident ones; None removes the tint."""
        document, before = self._document, self.previewed_ids
        if document is None or (ids is None and before is None):
            return
        self.previewed_ids = None if ids is None else document.mesh.weld.with_coincident_vertices(ids)
        if before is not None:
            self._restore(before)
        if self.previewed_ids is not None:
            colors = colors_of(document, self.previewed_ids, self._file_colors)
            self._surface.set_colors(tinted_colors(colors, color), self.previewed_ids)

    def mark(self, vertices: np.ndarray | None) -> None:
        """Mark vertices; an empty array marks all, None removes the marks."""
        document, before = self._document, self._marks.ids
        if document is None:
            return
        if before is not None:
            self._marks.mark_vertices(None)
            self._restore(before)
        if vertices is None:
            return
        every = np.arange(len(document.mesh.V))
        self._marks.mark_vertices(
            document.mesh.weld.with_coincident_vertices(vertices) if len(vertices) else every, vertices
        )
        self._surface.set_colors(self._marks.colors(), self._marks.ids)


def colors_of(
    document: Document, ids: np.ndarray | None = None, unpainted_colors: np.ndarray | None = None
) -> np.ndarray:
    """RGBA colours (k, 4) uint8 of the vertices ``ids``, or of all.

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
    """Labels and region numbers of ``ids``, with hidden parts as unpainted."""
    hidden = document.flags.hidden
    labels, member = document.labels[ids], document.member[ids]
    if hidden.labels.any():
        labels = np.where(hidden.labels[labels], FREE, labels)
    if hidden.regions.any():
        member = np.where(hidden.regions[member], 0, member)
    return labels, member


def _have_same_colors(old: Document, new: Document) -> bool:
    return (
        have_same_paint(old, new) and old.soft_constraints is new.soft_constraints and old.flags == new.flags
    )


def differing_vertices(old: Document, new: Document) -> np.ndarray:
    """Sorted vertices whose colours differ between two documents."""
    (labels, member), (other, others) = drawn_labels(old, slice(None)), drawn_labels(new, slice(None))
    differ = (labels != other) | (member != others)
    if old.soft_constraints is not new.soft_constraints or old.flags != new.flags:
        differ[old.soft_constraints.ids] = differ[new.soft_constraints.ids] = True
    return np.flatnonzero(differ)


_MOST_DOTS = 2000  # with more vertices their colour suffices, and dots would hide it
_NONE = np.empty(0, dtype=np.int64)
_DOT, _HALO = 6.0, 9.5


class VertexMarks(MouseTool):
    """Tool to mark vertices visibly, even hidden or tiny ones.

    A vertex of a large mesh is smaller than a pixel, one without a face is not drawn, and one at the back is
    hidden, whereas a dot is always visible. The tool only paints, without handling events.

    Attributes
    ----------
    ids : int array or None
        Vertices that are marked; None where nothing is.
    """

    def __init__(self, viewport: Viewport, surface: Surface) -> None:
        self._viewport = viewport
        self._surface = surface
        self.ids: np.ndarray | None = None
        self._dotted = _NONE

    def mark_vertices(self, ids: np.ndarray | None, dotted: np.ndarray = _NONE) -> None:
        """Mark the vertices ``ids``, with dots at ``dotted`` if few or without faces."""
        self.ids = ids
        self._dotted = dotted[:: 1 + len(dotted) // _MOST_DOTS] if self._needs_dots(dotted) else _NONE
        self._viewport.tool_layer.update()

    def colors(self) -> np.ndarray:
        """RGBA of each marked vertex, (k, 4) uint8 array."""
        count = 0 if self.ids is None else len(self.ids)
        return np.tile(np.array([*MARK_COLOR, 255], dtype=np.uint8), (count, 1))

    def paint(self, painter: QPainter) -> None:
        """Draw dots at the vertices' current positions."""
        if not len(self._dotted):
            return
        points, eye = self._surface.U[self._dotted], self._viewport.camera_controller.camera
        places = np.unique(np.rint(eye.project(points[eye.depth(points) > 0.0])), axis=0)
        dots = QPolygonF([QPointF(x, y) for x, y in places.tolist()])
        for color, width in ((QColor(255, 255, 255, 220), _HALO), (QColor(*MARK_COLOR), _DOT)):
            painter.setPen(QPen(color, width, c=Qt.PenCapStyle.RoundCap))
            painter.drawPoints(dots)

    def _needs_dots(self, ids: np.ndarray) -> bool:
        """True if dots are needed: few vertices, or none with a face."""
        if len(ids) <= _MOST_DOTS or self._surface.surface_index is None:
            return True
        used = np.zeros(len(self._surface.U), dtype=bool)
        used[self._surface.surface_index.F.ravel()] = True
        return not used[ids].any()
