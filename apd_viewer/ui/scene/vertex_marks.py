"""Marks of findings: colour on the surface, dots shining through."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QPen, QPolygonF

from apd_viewer.presentation.palette import MARK_COLOR
from apd_viewer.ui.scene.mouse_tool import MouseTool

if TYPE_CHECKING:
    from PySide6.QtGui import QPainter

    from apd_viewer.ui.scene.surface import Surface
    from apd_viewer.ui.scene.viewport import Viewport

_MOST_DOTS = 2000  # of more, the colour says enough, and they would hide it
_NONE = np.empty(0, dtype=np.int64)
_DOT, _HALO = 6.0, 9.5


class VertexMarks(MouseTool):
    """Marked vertices, visible from anywhere.

    A vertex of a large mesh is less than a pixel, one without a face is not drawn at all, and one at the
    back is hidden: a dot has the same size everywhere. It is a tool of the viewport that only paints.

    Parameters
    ----------
    viewport : Viewport
    surface : Surface

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

    def show(self, ids: np.ndarray | None, dotted: np.ndarray = _NONE) -> None:
        """Mark the vertices ``ids``, with dots at ``dotted`` if useful."""
        self.ids = ids
        self._dotted = dotted[:: 1 + len(dotted) // _MOST_DOTS] if self._bare(dotted) else _NONE
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

    def _bare(self, ids: np.ndarray) -> bool:
        """True if dots are needed: few vertices, or none with a face."""
        if len(ids) <= _MOST_DOTS or self._surface.surface_index is None:
            return True
        used = np.zeros(len(self._surface.U), dtype=bool)
        used[self._surface.surface_index.F.ravel()] = True
        return not used[ids].any()
