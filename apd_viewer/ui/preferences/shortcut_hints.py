"""Tooltips with the current shortcut of an action."""

from __future__ import annotations

from typing import TYPE_CHECKING

from apd_viewer.language import tr
from apd_viewer.ui.preferences.shortcuts import keys_of, native_keys

if TYPE_CHECKING:
    from PySide6.QtGui import QAction
    from PySide6.QtWidgets import QWidget


def with_keys(words: str, action: QAction) -> str:
    """Text with the action's current keys appended, if any."""
    keys = native_keys(keys_of(action))
    return tr("{words} ({keys})").format(words=words, keys=keys) if keys else words


def show_keys_in_tip(widget: QWidget, action: QAction) -> None:
    """Keep the shortcut of an equivalent action in a widget's tooltip."""
    tip = widget.toolTip()

    def say() -> None:
        widget.setToolTip(with_keys(tip, action))

    action.changed.connect(say)
    say()
