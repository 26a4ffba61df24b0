"""Transparent widget over the viewport for the tools' drawings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import Qt
from PySide6.QtGui import QPainter
from PySide6.QtWidgets import QWidget

if TYPE_CHECKING:
    from PySide6.QtGui import QPaintEvent

    from apd_viewer.ui.scene.mouse_tool import MouseTool


class ToolLayer(QWidget):
    """Widget as large as the viewport, blind to the mouse.

    QPainter draws smooth lines and letters where a software OpenGL draws neither, and a tool that
    only changes its own looks costs no VTK draw.

    Parameters
    ----------
    viewport : QWidget
    tools : list
        Of the viewport; looked at in every paint.
    """

    def __init__(self, viewport: QWidget, tools: list[MouseTool]) -> None:
        super().__init__(viewport)
        self._tools = tools
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAttribute(Qt.WidgetAttribute.WA_NoSystemBackground)

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Let the tools paint, the first one on top."""
        with QPainter(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            for tool in reversed(self._tools):
                tool.paint(painter)
