"""Words that name the keys of an action, and go on naming them when it gets others."""

from __future__ import annotations

from typing import TYPE_CHECKING

from apd_viewer.language import tr
from apd_viewer.ui.preferences.shortcuts import keys_of, native

if TYPE_CHECKING:
    from PySide6.QtGui import QAction
    from PySide6.QtWidgets import QWidget


def with_keys(words: str, action: QAction) -> str:
    """The words, and behind them the keys that the action has now, if it has any."""
    keys = native(keys_of(action))
    return tr("{words} ({keys})").format(words=words, keys=keys) if keys else words


def name_keys(widget: QWidget, action: QAction) -> None:
    """Have the tip of a widget name the keys of the action that does the same."""
    tip = widget.toolTip()

    def say() -> None:
        widget.setToolTip(with_keys(tip, action))

    action.changed.connect(say)
    say()
