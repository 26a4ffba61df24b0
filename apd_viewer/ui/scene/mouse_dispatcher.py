"""Who gets a mouse event: the tool that holds the button, else the first that wants it.

A tool may have ``press(event)``, ``move(event)``, ``release(event)`` and ``wheel(event)``, which
return True to consume the event; ``leave()``; ``cancel()`` and ``finish()``, which return True when there
was something to cancel or to finish; and ``paint(painter)``, which draws on the overlay.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QEvent, Qt

if TYPE_CHECKING:
    from PySide6.QtGui import QMouseEvent, QWheelEvent
    from PySide6.QtWidgets import QWidget

    from apd_viewer.ui.scene.navigation import Navigation


class MouseDispatcher:
    """Hands events to the tools of a viewport, and to the camera what no tool wants.

    Parameters
    ----------
    viewport : QWidget
    tools : list
        Of the viewport; looked at for every event.
    navigation : Navigation
    """

    def __init__(self, viewport: QWidget, tools: list[Any], navigation: Navigation) -> None:
        self._viewport = viewport
        self._tools = tools
        self._navigation = navigation
        self._holder: Any = None
        self._button = Qt.MouseButton.NoButton

    def press(self, event: QMouseEvent) -> None:
        """Offer a press; the one who takes it has the mouse until the button is up again."""
        if self._holder is not None:
            return
        self._button = event.button()
        takers = (tool for tool in self._everyone() if _ask(tool, "press", event))
        self._holder = next(takers, None)

    def move(self, event: QMouseEvent) -> None:
        """Let the holder have the move, else let the tools show what a press would do."""
        if self._holder is not None and not event.buttons() & self._button:
            self.release(event)  # the release went to another window
        elif self._holder is not None:
            _ask(self._holder, "move", event)
        elif event.buttons() == Qt.MouseButton.NoButton:
            self._hover(event)

    def release(self, event: QMouseEvent) -> None:
        """End the drag when the button that began it goes up."""
        if self._holder is not None and not event.buttons() & self._button:
            holder, self._holder = self._holder, None
            _ask(holder, "release", event)
        if event.type() == QEvent.Type.MouseButtonRelease and event.buttons() == Qt.MouseButton.NoButton:
            self._hover(event)

    def wheel(self, event: QWheelEvent) -> None:
        """Offer the wheel."""
        any(_ask(tool, "wheel", event) for tool in self._everyone())

    def leave(self) -> None:
        """Tell the tools that the cursor is gone, but not during a drag, which goes on outside."""
        if self._holder is None:
            for tool in self._tools:
                _ask(tool, "leave")

    def cancel(self) -> bool:
        """Ask the tools to cancel what they are doing; True if one did."""
        done = any(_ask(tool, "cancel") for tool in self._tools)
        if done:
            self._holder = None
        return done

    def finish(self) -> bool:
        """Ask the tools to end what takes several clicks; True if one did."""
        return any(_ask(tool, "finish") for tool in self._tools)

    def _everyone(self) -> tuple[Any, ...]:
        return (*self._tools, self._navigation)

    def _hover(self, event: QMouseEvent) -> None:
        """Offer a move; for the tools behind the one that takes it the cursor has left."""
        taken = False
        for tool in self._tools:
            if taken:
                _ask(tool, "leave")
            else:
                taken = _ask(tool, "move", event)
        if not taken:
            self._viewport.unsetCursor()


def _ask(tool: Any, name: str, *args: Any) -> bool:
    """Call a method that the tool may have; True if the tool consumed the event."""
    method = getattr(tool, name, None)
    return method is not None and bool(method(*args))
