"""Dispatch of mouse events to the tools of a viewport."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QEvent, Qt

if TYPE_CHECKING:
    from PySide6.QtGui import QMouseEvent, QWheelEvent
    from PySide6.QtWidgets import QWidget

    from apd_viewer.ui.scene.mouse_tool import MouseTool
    from apd_viewer.ui.scene.navigation import Navigation


class MouseDispatcher:
    """Dispatches mouse events to the tools in order, then to the camera.

    Parameters
    ----------
    viewport : QWidget
    tools : list
        Of the viewport; looked at for every event.
    navigation : Navigation
    """

    def __init__(self, viewport: QWidget, tools: list[MouseTool], navigation: Navigation) -> None:
        self._viewport = viewport
        self._tools = tools
        self._navigation = navigation
        self._holder: MouseTool | None = None
        self._button = Qt.MouseButton.NoButton

    def press(self, event: QMouseEvent) -> None:
        """Offer a press; its taker holds the mouse until the button is released."""
        if self._holder is not None:
            return
        self._button = event.button()
        takers = (tool for tool in self._everyone() if tool.press(event))
        self._holder = next(takers, None)

    def move(self, event: QMouseEvent) -> None:
        """Send the move to the holder, or to all tools for a preview."""
        if self._holder is not None and not event.buttons() & self._button:
            self.release(event)  # the release went to another window
        elif self._holder is not None:
            self._holder.move(event)
        elif event.buttons() == Qt.MouseButton.NoButton:
            self._hover(event)

    def release(self, event: QMouseEvent) -> None:
        """End the drag on release of its button."""
        if self._holder is not None and not event.buttons() & self._button:
            holder, self._holder = self._holder, None
            holder.release(event)
        if event.type() == QEvent.Type.MouseButtonRelease and event.buttons() == Qt.MouseButton.NoButton:
            self._hover(event)

    def wheel(self, event: QWheelEvent) -> None:
        """Offer the wheel."""
        any(tool.wheel(event) for tool in self._everyone())

    def leave(self) -> None:
        """Notify the tools of the cursor's leaving, except during a drag."""
        if self._holder is None:
            for tool in self._tools:
                tool.leave()

    def cancel(self) -> bool:
        """Cancel the tools' work; True if there was any."""
        done = any(tool.cancel() for tool in self._tools)
        if done:
            self._holder = None
        return done

    def finish(self) -> bool:
        """Finish a shape of several clicks; True if there was one."""
        return any(tool.finish() for tool in self._tools)

    def _everyone(self) -> tuple[MouseTool, ...]:
        return (*self._tools, self._navigation)

    def _hover(self, event: QMouseEvent) -> None:
        """Offer a move; for tools behind its taker the cursor has left."""
        taken = False
        for tool in self._tools:
            if taken:
                tool.leave()
            else:
                taken = tool.move(event)
        if not taken:
            self._viewport.unsetCursor()
