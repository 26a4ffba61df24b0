"""Base class of the selection tools, with strokes, effect and preview."""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QColor, QInputEvent, QMouseEvent

from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.session.model.document_parts import PaintedPart
from apd_viewer.ui.scene.navigation import MouseTool
from apd_viewer.ui.scene.pointing import PenEvent
from apd_viewer.ui.scene.surface import Surface
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.tool_modes import Tool

if TYPE_CHECKING:
    from apd_viewer.session.model.document import Document


class StrokeEffect(Enum):
    """Effect of a stroke on the selection."""

    ADD = "add"
    REMOVE = "remove"
    REPLACE = "replace"


def stroke_effect(event: QInputEvent) -> StrokeEffect:
    """Stroke effect for the held keys: Alt removes, Ctrl replaces; an eraser removes."""
    modifiers = event.modifiers()
    if modifiers & Qt.KeyboardModifier.AltModifier or (isinstance(event, PenEvent) and event.erases):
        return StrokeEffect.REMOVE
    return StrokeEffect.REPLACE if modifiers & Qt.KeyboardModifier.ControlModifier else StrokeEffect.ADD


def may_begin_stroke(event: QMouseEvent) -> bool:
    """True if a press may begin a stroke; Shift is reserved for the camera."""
    left = event.button() == Qt.MouseButton.LeftButton
    return left and not event.modifiers() & Qt.KeyboardModifier.ShiftModifier


class SelectionTool(MouseTool, QObject):
    """Base class of tools to select vertices by strokes.

    Attributes
    ----------
    effect : StrokeEffect
        Effect of the current stroke, or of one beginning now.
    stroke_began : Signal(object)
        The Act.
    vertices_painted : Signal(object)
        Int array of vertices; of those at a seam one of each place.
    previewed : Signal(object)
        Int array of the vertices that a press or a release would choose; None where there are none.
    """

    stroke_began = Signal(object)
    vertices_painted = Signal(object)
    stroke_ended = Signal()
    stroke_cancelled = Signal()
    previewed = Signal(object)

    def __init__(self, viewport: Viewport, surface: Surface) -> None:
        super().__init__(viewport)
        self._viewport = viewport
        self._surface = surface
        self._enabled = False
        self._color = QColor("#ffffff")
        self.effect = StrokeEffect.ADD

    @property
    def enabled(self) -> bool:
        """True while the tool is active; any change cancels a stroke."""
        return self._enabled

    @enabled.setter
    def enabled(self, on: bool) -> None:
        self.cancel()
        self._enabled = on
        self.leave()

    @property
    def color(self) -> QColor:
        """Colour of the drawn outlines, matching the paint."""
        return self._color

    @color.setter
    def color(self, color: QColor | str) -> None:
        self._color = QColor(color)
        self._viewport.tool_layer.update()

    @property
    def _halo(self) -> QColor:
        """Halo colour to set lines off from the mesh."""
        return QColor(0, 0, 0, 150) if self._color.lightnessF() > 0.5 else QColor(255, 255, 255, 200)

    @property
    def _pen_style(self) -> Qt.PenStyle:
        return Qt.PenStyle.DashLine if self.effect is StrokeEffect.REMOVE else Qt.PenStyle.SolidLine

    @property
    def _view_key(self) -> tuple[object, ...]:
        """Key of shape and camera, to detect outdated hit tests."""
        return self._surface.revision, self._viewport.camera_controller.camera.key

    def _apply(self, act: StrokeEffect, vertices: np.ndarray) -> None:
        """Emit a whole stroke with the given vertices."""
        self.previewed.emit(None)
        self.stroke_began.emit(act)
        if len(vertices):
            self.vertices_painted.emit(vertices)
        self.stroke_ended.emit()


class SelectionStrokes(QObject):
    """Applies strokes of the selection tools as paint of the current part or region.

    Attributes
    ----------
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
        """Apply the strokes of a selection tool as paint."""
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
        """Vertices of ``ids`` changeable by a stroke, without those of locked parts."""
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
        """Paint vertices as a single stroke of the current tool."""
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
        """Erase base and handles at ``ids``; the eraser tool also erases regions there."""
        if self._document is None:
            return
        held = self._document.labels[ids] != FREE
        if held.any():
            self.painted.emit(ids[held], FREE)
        if self._tool is Tool.ERASE and not held.all():
            self.region_painted.emit(ids[~held], 0)

    def _end(self) -> None:
        erased = self._act is StrokeEffect.REMOVE
        tool = self._tool if self._tool.traits.is_brush else Tool.HANDLE  # as prepared
        self.ended.emit((Tool.ERASE if erased else tool).traits.title)
