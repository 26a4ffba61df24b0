"""A mouse tool with a misnamed method cannot be defined: nobody would call the method."""

import pytest
from PySide6.QtCore import QObject, Signal

from apd_viewer.ui.scene.navigation import MouseTool


def pres(self, event):
    return True


def on_move(self, _event):
    return True


def draw(self, painter):
    pass


@pytest.mark.parametrize("method", [pres, on_move, draw])
@pytest.mark.parametrize("bases", [(MouseTool,), (MouseTool, QObject)])
def test_mouse_tool_refuses_a_method_that_nobody_would_call(method, bases):
    with pytest.raises(TypeError, match=method.__name__):
        type(QObject)("Misnamed", bases, {method.__name__: method})


def test_mouse_tool_accepts_what_overrides_or_takes_no_event(qapp):
    class Tool(MouseTool, QObject):
        chosen = Signal(int)

        def press(self, _event):
            return True

        def eventFilter(self, _watched, _event):
            return False

        def paint(self, painter):
            pass

        def place(self, point):
            self._note(point)

        def _note(self, event):
            pass

    tool = Tool()
    assert tool.press(None)
    assert not tool.move(None)
    assert not tool.cancel()


def test_mouse_tool_looks_at_a_tool_of_a_tool_too():
    class Brush(MouseTool):
        pass

    with pytest.raises(TypeError, match="Soft"):
        type("Soft", (Brush,), {"pres": pres})
