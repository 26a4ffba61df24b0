"""Current tool and current mode of selection."""

from __future__ import annotations

from PySide6.QtCore import QObject, Signal

from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.tools.tool_modes import SelectionMode, Tool


class ToolChoice(QObject):
    """Chooses tool and way on a canvas, and tells the other parts of the window.

    Parameters
    ----------
    canvas : Canvas

    Attributes
    ----------
    tool_chosen : Signal(Tool)
    mode_chosen : Signal(Way)
    """

    tool_chosen = Signal(object)
    mode_chosen = Signal(object)

    def __init__(self, canvas: Canvas) -> None:
        super().__init__(canvas)
        self._canvas = canvas

    def choose_tool(self, tool: Tool) -> None:
        """Use another tool."""
        self._canvas.choose_tool(tool)
        self.tool_chosen.emit(tool)

    def choose_mode(self, mode: SelectionMode) -> None:
        """Select vertices in another way, with a painting tool if none is in use."""
        self.set_mode(mode)
        if not self._canvas.tool.words.is_brush:
            self.choose_tool(Tool.HANDLE)

    def set_mode(self, mode: SelectionMode) -> None:
        """Have the painting tools select in another way, whichever is in use."""
        self._canvas.choose_mode(mode)
        self.mode_chosen.emit(mode)
        self.choose_tool(self._canvas.tool)
