"""Mouse tools of a viewport."""

from __future__ import annotations

from inspect import isfunction, signature
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from PySide6.QtGui import QMouseEvent, QPainter, QWheelEvent

_GIVEN = {"event", "painter"}  # names of arguments, with or without an underscore


class MouseTool:
    """A tool of a viewport; its methods do nothing until a subclass overrides them.

    Raises
    ------
    TypeError
        When a subclass has a public method that takes an event or a painter and overrides nothing:
        nobody would call it.
    """

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        for name, method in vars(cls).items():
            if name.startswith("_") or not isfunction(method) or hasattr(super(cls, cls), name):
                continue
            if _GIVEN & {argument.lstrip("_") for argument in signature(method).parameters}:
                raise TypeError(f"{cls.__name__}.{name} is no method of mouse tools: is it misspelled?")

    def press(self, _event: QMouseEvent) -> bool:
        """Begin a drag at a press; True holds the mouse until the button is up again."""
        return False

    def move(self, _event: QMouseEvent) -> bool:
        """Continue a drag or preview a press; True hides the cursor from later tools."""
        return False

    def release(self, _event: QMouseEvent) -> None:
        """End a drag."""

    def wheel(self, _event: QWheelEvent) -> bool:
        """Turn the wheel; True consumes the event."""
        return False

    def leave(self) -> None:
        """Forget the cursor, now outside the viewport or taken by another tool."""

    def cancel(self) -> bool:
        """Cancel a drag or a stroke; True if there was one."""
        return False

    def finish(self) -> bool:
        """Finish a shape of several clicks; True if there was one."""
        return False

    def paint(self, painter: QPainter) -> None:
        """Draw on the overlay."""
