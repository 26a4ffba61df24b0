"""Strokes of the selection tools as paint for the document."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject, Signal

from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.session.model.document_parts import PaintedPart
from apd_viewer.ui.tools.selection_tool import StrokeEffect
from apd_viewer.ui.tools.toolbox import Tool

if TYPE_CHECKING:
    from apd_viewer.session.model.document import Document
    from apd_viewer.ui.tools.selection_tool import SelectionTool


class Strokes(QObject):
    """Paints the selected vertices with the part of the current tool.

    Attributes
    ----------
    began : Signal()
    painted : Signal(object, int)
        Vertices, and the label that they are painted with.
    region_painted : Signal(object, int)
        Vertices, and the number of the region, from 1; 0 erases.
    ended : Signal(str)
        Name of the gesture.
    part : PaintedPart
        Painted by the current tool; the active handle if the tool paints nothing.
    """

    began = Signal()
    painted = Signal(object, int)
    region_painted = Signal(object, int)
    ended = Signal(str)

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.part = PaintedPart(HANDLE)
        self._tool = Tool.ORBIT
        self._act = StrokeEffect.ADD
        self._document: Document | None = None

    def connect_tool(self, tool: SelectionTool) -> None:
        """Paint with the strokes of a selection tool."""
        tool.stroke_began.connect(self._begin)
        tool.vertices_painted.connect(self._paint)
        tool.stroke_ended.connect(self._end)

    def prepare(self, tool: Tool, handle: int, region: int, document: Document | None) -> None:
        """Set the tool, the active parts and the document of the next strokes."""
        self._tool, self._document = tool, document
        if tool is Tool.REGION:
            self.part = PaintedPart(region + 1, is_region=True)
        else:
            self.part = PaintedPart(BASE if tool is Tool.BASE else HANDLE + handle)

    def changeable_vertices(self, ids: np.ndarray, erases: bool) -> np.ndarray:
        """The vertices of ``ids`` that a stroke can change: locked parts keep theirs."""
        if self._document is None:
            return ids
        locked = self._document.flags.locked
        codes, closed = (
            self.part.codes(self._document),
            locked.regions if self.part.is_region else locked.labels,
        )
        if closed[self.part.code] and not erases:
            return ids[:0]
        return ids[~closed[codes[ids]]]

    def paint_vertices(self, ids: np.ndarray, effect: StrokeEffect) -> None:
        """Paint vertices at once, like a stroke of the current tool."""
        self._begin(effect)
        self._paint(ids)
        self._end()

    def _begin(self, act: StrokeEffect) -> None:
        self._act = act
        self.began.emit()
        if act is StrokeEffect.REPLACE and self._tool is not Tool.ERASE and self._document is not None:
            self._emit(np.flatnonzero(self.part.mask(self._document)), self.part.unpainted_code)

    def _paint(self, ids: np.ndarray) -> None:
        erases = self._act is StrokeEffect.REMOVE or self._tool is Tool.ERASE
        if erases and not self.part.is_region:
            self._erase(ids)
        else:
            self._emit(ids, self.part.unpainted_code if erases else self.part.code)

    def _emit(self, ids: np.ndarray, code: int) -> None:
        (self.region_painted if self.part.is_region else self.painted).emit(ids, code)

    def _erase(self, ids: np.ndarray) -> None:
        """Erase base and handles; the eraser also erases regions elsewhere."""
        if self._document is None:
            return
        held = self._document.labels[ids] != FREE
        if held.any():
            self.painted.emit(ids[held], FREE)
        if self._tool is Tool.ERASE and not held.all():
            self.region_painted.emit(ids[~held], 0)

    def _end(self) -> None:
        erased = self._act is StrokeEffect.REMOVE
        self.ended.emit((Tool.ERASE if erased else self._tool).words.title)
