"""Parts beside each other, and behind tabs in a narrow room."""

import pytest
from PySide6.QtCore import QSize
from PySide6.QtWidgets import QVBoxLayout, QWidget
from study_driving import click

from apd_viewer.ui.widgets.pane_splitter import Pane, PaneSplitter


@pytest.fixture
def parts(qtbot):
    window = QWidget()
    qtbot.addWidget(window)
    column = QVBoxLayout(window)
    found = PaneSplitter([Pane(name, QWidget(), 1) for name in ("One", "Two", "Three")])
    column.addWidget(found.tabs)
    column.addWidget(found, 1)
    window.show()
    qtbot.waitExposed(window)
    yield found
    window.close()


def shown(parts):
    return [not parts.widget(k).isHidden() for k in range(parts.count())]


def test_side_by_side_shows_all_in_a_wide_room(parts):
    parts.arrange(QSize(1200, 240))
    assert shown(parts) == [True] * 3
    assert not parts.tabs.isVisible()


def test_side_by_side_shows_the_part_of_a_tab_in_a_narrow_room(parts):
    parts.arrange(QSize(900, 240))
    assert shown(parts) == [True, False, False]
    click(parts.buttons[2])
    assert shown(parts) == [False, False, True]
    parts.arrange(QSize(1200, 240))
    assert shown(parts) == [True] * 3
    parts.arrange(QSize(900, 240))
    assert shown(parts) == [False, False, True], "the tab is remembered"


def test_side_by_side_shows_all_above_each_other_in_a_tall_room(parts):
    parts.arrange(QSize(400, 900))
    assert shown(parts) == [True] * 3
    assert not parts.tabs.isVisible()
    for k in range(3):
        assert parts.widget(k).width() == parts.width()
