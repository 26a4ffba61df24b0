"""Choice of the active tool and the selection mode."""

from PySide6.QtCore import QObject, Signal

from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.tools.tool_modes import SelectionMode, Tool


class ToolChoice(QObject):
    """Active tool and selection mode of a canvas, with signals for their changes.

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
        """Make ``tool`` the active tool, and announce it."""
        self._canvas.choose_tool(tool)
        self.tool_chosen.emit(tool)

    def choose_mode(self, mode: SelectionMode) -> None:
        """Set the selection mode, and activate a painting tool if none is active."""
        self.set_mode(mode)
        if not self._canvas.tool.traits.is_brush:
            self.choose_tool(Tool.HANDLE)

    def set_mode(self, mode: SelectionMode) -> None:
        """Set the selection mode of all painting tools, and announce it."""
        self._canvas.choose_mode(mode)
        self.mode_chosen.emit(mode)
        self.choose_tool(self._canvas.tool)
