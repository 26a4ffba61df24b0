"""The steps of the tutorial, by the keys that it names, on the bottle."""

import pytest
from driving import idle, work_off
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLabel

CONTROL = Qt.KeyboardModifier.ControlModifier


@pytest.mark.night
def test_motion_field_twists_a_bottle_by_a_typed_half_turn_as_the_tutorial_has_it(qtbot, sample):
    view, handles = sample.canvas.viewport, sample.panel.handles
    rest = sample.session.store.state.frame.volume
    sample.shell.activateWindow()
    qtbot.waitUntil(sample.shell.isActiveWindow)
    view.setFocus()
    QTest.keyClick(view, Qt.Key.Key_M, CONTROL)
    qtbot.waitUntil(lambda: sample.shell.focusWidget() is handles.motion.amount)
    assert handles.motion.choice.currentText() == "Twist"
    QTest.keyClicks(handles.motion.amount, "180deg")
    QTest.keyClick(handles.motion.amount, Qt.Key.Key_Return)
    work_off()
    idle(qtbot, sample)
    said = [label.text() for label in sample.panel.findChildren(QLabel) if label.isVisible()]
    assert {"100.000 %", "converged", "twisted +180.0°"} <= set(said)
    assert sample.session.store.state.frame.volume < 0.9 * rest
