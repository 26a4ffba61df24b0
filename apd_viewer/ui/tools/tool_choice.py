"""Current tool and current mode of selection."""

from __future__ import annotations

from PySide6.QtCore import QObject, Signal

from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.tools.toolbox import Tool, Way


class ToolChoice(QObject):
    """Chooses tool and way on a canvas, and tells the other parts of the window.

    Parameters
    ----------
    canvas : Canvas

    Attributes
    ----------
    taken : Signal(Tool)
    way_chosen : Signal(Way)
    """

    taken = Signal(object)
    way_chosen = Signal(object)

    def __init__(self, canvas: Canvas) -> None:
        super().__init__(canvas)
        self._canvas = canvas

    def take(self, tool: Tool) -> None:
        """Use another tool."""
        self._canvas.take(tool)
        self.taken.emit(tool)

    def choose_way(self, way: Way) -> None:
        """Select vertices in another way, with a painting tool if none is in use."""
        self.set_way(way)
        if not self._canvas.tool.words.is_brush:
            self.take(Tool.HANDLE)

    def set_way(self, way: Way) -> None:
        """Have the painting tools select in another way, whichever is in use."""
        self._canvas.choose_way(way)
        self.way_chosen.emit(way)
        self.take(self._canvas.tool)
