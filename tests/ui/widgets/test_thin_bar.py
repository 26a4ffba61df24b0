"""A bar of progress: what it shows, and how often the window is composed for it."""

import re

import pytest
from PySide6.QtCore import QEvent, QObject
from PySide6.QtWidgets import QApplication, QMainWindow

from apd_viewer.ui.widgets.thin_bar import ElidedLabel, ThinBar, elided_text


class Paints(QObject):
    """Counts how often a widget is drawn."""

    def __init__(self, widget):
        super().__init__(widget)
        self.count = 0
        widget.installEventFilter(self)

    def eventFilter(self, _widget, event):
        self.count += event.type() == QEvent.Type.Paint
        return False


@pytest.fixture
def bar(qtbot):
    """A bar, where cursors blink."""
    before, window, bar = QApplication.cursorFlashTime(), QMainWindow(), ThinBar()
    QApplication.setCursorFlashTime(1000)
    window.setCentralWidget(bar)
    window.show()
    qtbot.waitExposed(window)
    yield bar
    QApplication.setCursorFlashTime(before)
    window.close()
    window.deleteLater()


def test_thin_bar_shows_a_share_of_the_work(bar):
    for share in (0.0, 0.25, None, 0.75, 1.0):
        bar.show_fraction(share)
        assert bar.maximum() == (0 if share is None else 1000)
        assert bar.value() == round(1000 * (share or 0.0))


def test_thin_bar_moves_until_its_length_is_known(qtbot, bar):
    paints = Paints(bar)
    bar.show_fraction(None)
    qtbot.waitUntil(lambda: paints.count > 3)
    bar.show_fraction(0.0)
    qtbot.wait(100)
    known = paints.count
    qtbot.wait(200)
    assert paints.count == known
    bar.show_fraction(None)
    qtbot.waitUntil(lambda: paints.count > known + 3)


def test_thin_bar_moves_seldom_where_no_cursor_blinks(qtbot, bar):
    QApplication.setCursorFlashTime(0)
    paints = Paints(bar)
    bar.show_fraction(None)
    qtbot.wait(500)
    assert 1 <= paints.count <= 4


@pytest.mark.parametrize("text", ["iteration 1,305, 281.7 ms per iteration", "at 3 of 14"])
def test_elided_text_shows_no_part_of_a_number_as_a_number(qtbot, text):
    label = ElidedLabel()
    qtbot.addWidget(label)
    label.setText(text)
    drawn = [elided_text(text, label.fontMetrics(), width) for width in range(label.room_for(text))]
    assert drawn[-1] == text
    numbers = set(re.findall(r"\d[\d.,]*\d|\d", text))
    for each in drawn:
        assert each == text or each.endswith("…") or not each
        assert set(re.findall(r"\d[\d.,]*\d|\d", each)) <= numbers, each
    assert len(set(drawn)) > 2, "what is no number is cut as before"
