"""Mnemonics: of two entries with the same letter, Qt selects one after the other and starts neither."""

from collections import Counter

from PySide6.QtGui import QKeySequence
from PySide6.QtWidgets import QMenu


def submenus(menu):
    yield menu
    for action in menu.actions():
        if action.menu() is not None:
            yield from submenus(action.menu())


def mnemonics(menu):
    sequences = [QKeySequence.mnemonic(action.text()).toString() for action in menu.actions()]
    return [sequence for sequence in sequences if sequence]


def test_mnemonics_are_unique_in_each_menu(window):
    bar = window.shell.menuBar()
    others = window.shell.findChildren(QMenu)
    menus = [
        bar,
        *dict.fromkeys([*(menu for top in bar.actions() for menu in submenus(top.menu())), *others]),
    ]
    assert len(menus) > 10
    units = mnemonics(window.panel.area.unit.menu())
    assert [letter.removeprefix("Alt+") for letter in units] == ["N", "L", "C", "M", "I", "F"]
    assert len(mnemonics(bar)) == len(bar.actions())
    twice = [
        (menu.title() if menu is not bar else "menu bar", letter)
        for menu in menus
        for letter, n in Counter(mnemonics(menu)).items()
        if n > 1
    ]
    assert twice == []
