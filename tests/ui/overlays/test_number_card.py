"""The card to choose vertices by numbers, typed into with real keys."""

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from apd_viewer.geometry.pose.constraints import BASE
from apd_viewer.ui.scene.coloring import colors_of
from apd_viewer.ui.tools.tool_modes import Tool

ALT = Qt.KeyboardModifier.AltModifier
CONTROL = Qt.KeyboardModifier.ControlModifier


@pytest.fixture
def card(bottle):
    bottle.tools.choose_tool(Tool.BASE)
    bottle.actions_.select.by_expression.trigger()
    return bottle.edits.text_entries.vertices


def base_of(window):
    return window.session.store.state.document.labels == BASE


def test_text_entry_card_previews_what_is_typed_and_adds_it_by_return(qtbot, bottle, card):
    before = base_of(bottle)
    y = bottle.session.store.state.document.mesh.V[:, 1]
    QTest.keyClicks(card.text, "y < 5")
    assert f"{(y < 5).sum():,} vertices" in card.message_label.text()
    np.testing.assert_array_equal(bottle.canvas.coloring.previewed_ids, np.flatnonzero(y < 5))
    qtbot.keyClick(card.text, Qt.Key.Key_Return)
    np.testing.assert_array_equal(base_of(bottle), before | (y < 5))
    assert bottle.session.gestures.history.next_undo_name == "Paint base"
    assert card.isHidden()
    assert bottle.shell.focusWidget() is bottle.canvas.viewport, "so that a key chooses a tool"
    bottle.session.gestures.undo()
    np.testing.assert_array_equal(base_of(bottle), before)


def test_text_entry_card_removes_with_alt_and_replaces_with_ctrl(qtbot, bottle, card):
    before = base_of(bottle)
    card.text.setText("0-99")
    qtbot.keyClick(card.text, Qt.Key.Key_Return, CONTROL)
    assert np.flatnonzero(base_of(bottle)).tolist() == list(range(100))
    bottle.actions_.select.by_expression.trigger()
    assert card.text.selectedText() == "0-99", "what was entered last, to be typed over"
    card.text.setText("50-99")
    qtbot.keyClick(card.text, Qt.Key.Key_Return, ALT)
    assert np.flatnonzero(base_of(bottle)).tolist() == list(range(50))
    bottle.session.gestures.undo()
    bottle.session.gestures.undo()
    np.testing.assert_array_equal(base_of(bottle), before)


def test_escape_closes_card_and_message_before_it_leaves_the_tool(qtbot, bottle, card):
    view = bottle.canvas.viewport
    bottle.notice.show_failure("Nothing is to be done.")
    view.setFocus()  # as by a click beside the card
    for shown, message in ((True, True), (False, True), (False, False)):
        assert (not card.isHidden(), bool(bottle.notice.text)) == (shown, message)
        assert bottle.canvas.tool is Tool.BASE
        qtbot.keyClick(view, Qt.Key.Key_Escape)
    assert bottle.canvas.tool is Tool.ORBIT


def test_text_entry_card_says_what_cannot_be_read_and_leaves_no_trace_on_escape(qtbot, bottle, card):
    state = bottle.session.store.state
    QTest.keyClicks(card.text, "y > 5 furlong")
    assert "furlong" in card.message_label.text()
    assert bottle.canvas.coloring.previewed_ids is None
    qtbot.keyClick(card.text, Qt.Key.Key_Return)
    assert bottle.session.store.state is state
    card.text.setText("0-500")
    qtbot.keyClick(card.text, Qt.Key.Key_Escape)
    assert card.isHidden()
    assert bottle.session.store.state is state
    np.testing.assert_array_equal(bottle.canvas.surface.arrays.rgba, colors_of(state.document))
    assert bottle.shell.focusWidget() is bottle.canvas.viewport
