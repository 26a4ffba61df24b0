"""The steps of the tutorial, by the keys that it names, on a bottle with fewer vertices."""

import pytest
from driving import idle, work_off
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLabel

CONTROL = Qt.KeyboardModifier.ControlModifier


@pytest.mark.night
def test_motion_field_twists_a_bottle_by_a_typed_half_turn_as_the_tutorial_has_it(qtbot, bottle):
    view, handles = bottle.canvas.viewport, bottle.panel.handles
    rest = bottle.session.store.state.frame.volume
    bottle.shell.activateWindow()
    qtbot.waitUntil(bottle.shell.isActiveWindow)
    view.setFocus()
    QTest.keyClick(view, Qt.Key.Key_M, CONTROL)
    qtbot.waitUntil(lambda: bottle.shell.focusWidget() is handles.motion.amount)
    assert handles.motion.choice.currentText() == "Twist"
    QTest.keyClicks(handles.motion.amount, "180deg")
    QTest.keyClick(handles.motion.amount, Qt.Key.Key_Return)
    work_off()
    idle(qtbot, bottle)
    said = [label.text() for label in bottle.panel.findChildren(QLabel) if label.isVisible()]
    assert {"100.000 %", "converged", "twisted +180.0°"} <= set(said)
    assert bottle.session.store.state.frame.volume < 0.9 * rest
