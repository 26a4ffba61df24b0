"""Base of the selection tools: stroke, effect and preview."""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QColor

from apd_viewer.ui.scene.mouse_tool import MouseTool

if TYPE_CHECKING:
    import numpy as np
    from PySide6.QtGui import QInputEvent, QMouseEvent

    from apd_viewer.ui.scene.surface import Surface
    from apd_viewer.ui.scene.viewport import Viewport


class StrokeEffect(Enum):
    """Effect of a stroke on the selection."""

    ADD = "add"
    REMOVE = "remove"
    REPLACE = "replace"


def stroke_effect(event: QInputEvent) -> StrokeEffect:
    """Effect by the modifiers: Alt removes, Ctrl replaces."""
    modifiers = event.modifiers()
    if modifiers & Qt.KeyboardModifier.AltModifier:
        return StrokeEffect.REMOVE
    return StrokeEffect.REPLACE if modifiers & Qt.KeyboardModifier.ControlModifier else StrokeEffect.ADD


def may_begin_stroke(event: QMouseEvent) -> bool:
    """True if a press may begin a stroke: Shift is the camera's."""
    left = event.button() == Qt.MouseButton.LeftButton
    return left and not event.modifiers() & Qt.KeyboardModifier.ShiftModifier


class SelectionTool(MouseTool, QObject):
    """Tool to select vertices by strokes, for any listener.

    Parameters
    ----------
    viewport : Viewport
    surface : Surface

    Attributes
    ----------
    effect : StrokeEffect
        Of the stroke, or of one that would begin now.
    stroke_began : Signal(object)
        The Act.
    vertices_painted : Signal(object)
        Int array of vertices; of those at a seam one of each place.
    stroke_ended, stroke_cancelled : Signal()
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
        """True while in use; any change cancels a stroke."""
        return self._enabled

    @enabled.setter
    def enabled(self, on: bool) -> None:
        self.cancel()
        self._enabled = on
        self.leave()

    @property
    def color(self) -> QColor:
        """Colour of the drawing, the same as of the paint."""
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
    def _sight(self) -> tuple[object, ...]:
        """Key of anything found under the cursor: the shape and the camera."""
        return self._surface.revision, self._viewport.camera_controller.camera.key

    def _apply(self, act: StrokeEffect, vertices: np.ndarray) -> None:
        """A whole stroke at once."""
        self.previewed.emit(None)
        self.stroke_began.emit(act)
        if len(vertices):
            self.vertices_painted.emit(vertices)
        self.stroke_ended.emit()
