"""What lies over the canvas keeps the mouse: a press on it paints nothing and turns nothing behind it."""

import pytest
from driving import Mouse
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from apd_viewer.ui.tools.tool_modes import SelectionMode, Tool


def number_card(window):
    window.actions_.select.by_expression.trigger()
    return window.edits.text_entries.vertices


def way_bar(window):
    return window.mode_bar


@pytest.mark.parametrize("over", [number_card, way_bar])
def test_block_mouse_events_lets_a_press_beside_the_buttons_go_no_farther(qtbot, bottle, over):
    bottle.tools.choose_tool(Tool.BASE)
    bottle.tools.choose_mode(SelectionMode.SLAB)
    widget, view = over(bottle), bottle.canvas.viewport
    qtbot.waitUntil(widget.isVisible)
    state, eye = bottle.session.store.state, view.camera_controller.camera.key
    reached = []
    view.mousePressEvent = lambda event: reached.append(event)
    view.mouseDoubleClickEvent = lambda event: reached.append(event)
    at = QPoint(3, widget.height() // 2)
    assert widget.childAt(at) is None
    QTest.mouseClick(widget, Qt.MouseButton.LeftButton, pos=at)
    QTest.mouseDClick(widget, Qt.MouseButton.LeftButton, pos=at)
    Mouse(widget).wheel(at, 1)
    del view.mousePressEvent, view.mouseDoubleClickEvent
    assert reached == []
    assert bottle.session.store.state is state
    assert view.camera_controller.camera.key == eye
    assert bottle.canvas.selectors[SelectionMode.SLAB].axis == 1, "the wheel has not taken another axis"
