"""The menus: opened by keys of their own; what is checked and what is hovered look different."""

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QKeySequence
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu

SCHEMES = Qt.ColorScheme.Light, Qt.ColorScheme.Dark


@pytest.fixture
def window(kept_window):
    """The window of all tests of this file."""
    return kept_window


def opened(qtbot, window, title):
    """The menu of the bar with a title, opened by its own key."""
    action = next(a for a in window.shell.menuBar().actions() if a.text() == title)
    letter = QKeySequence.mnemonic(action.text()).toString()[-1]
    QTest.keyClick(window.shell, getattr(Qt.Key, f"Key_{letter}"), Qt.KeyboardModifier.AltModifier)
    qtbot.waitUntil(lambda: QApplication.activePopupWidget() is not None)
    return QApplication.activePopupWidget()


def test_actions_open_every_menu_by_its_own_key(qtbot, window):
    window.shell.activateWindow()
    qtbot.waitUntil(window.shell.isActiveWindow)
    for action in window.shell.menuBar().actions():
        menu = opened(qtbot, window, action.text())
        assert menu is action.menu()
        menu.close()


def test_actions_give_help_and_appearance_the_keys_that_one_tries(qtbot, window):
    window.shell.activateWindow()
    qtbot.waitUntil(window.shell.isActiveWindow)
    QTest.keyClick(window.shell, Qt.Key.Key_H, Qt.KeyboardModifier.AltModifier)
    qtbot.waitUntil(lambda: QApplication.activePopupWidget() is not None)
    assert QApplication.activePopupWidget().title() == "&Help"
    QApplication.activePopupWidget().close()
    view = opened(qtbot, window, "&View")
    QTest.keyClick(view, Qt.Key.Key_P)
    appearance = QApplication.activePopupWidget()
    assert appearance.title() == "A&ppearance"
    appearance.close()
    view.close()


@pytest.mark.parametrize("scheme", SCHEMES)
def test_theme_marks_checked_entries_of_menus_and_fills_only_the_hovered_one(qtbot, window, scheme):
    actions = window.actions_
    actions.view.schemes[scheme].trigger()
    actions.view.edges.trigger()
    window.shell.activateWindow()
    qtbot.waitUntil(window.shell.isActiveWindow)
    view = opened(qtbot, window, "&View")
    hovered, checked, plain = actions.view.frame, actions.view.edges, actions.display.switches["cut"]
    assert view.activeAction() is hovered
    assert checked.isChecked()
    picture = view.grab().toImage()
    ratio = picture.devicePixelRatio()

    def fill(action):
        corner = view.actionGeometry(action).topRight() + QPoint(-8, 8)
        return picture.pixelColor(corner * ratio).name()

    def inked(action):
        box = view.actionGeometry(action)
        box.setWidth(28)
        colors = [
            picture.pixelColor(QPoint(x, y) * ratio).name()
            for x in range(box.left() + 4, box.right())
            for y in range(box.top() + 4, box.bottom() - 4)
        ]
        return any(color != fill(action) for color in colors)

    assert fill(checked) == fill(plain) != fill(hovered)
    assert inked(checked)
    assert not inked(plain)
    view.close()


def test_actions_keep_every_menu_within_the_smallest_window_and_view_within_a_small_screen(window):
    bar = window.shell.menuBar()
    heights = {menu.title(): menu.sizeHint().height() for menu in bar.findChildren(QMenu)}
    assert max(heights.values()) <= 700 - bar.height()
    assert heights["&View"] <= 520
