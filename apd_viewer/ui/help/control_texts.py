"""Title and tip of a control, from its widgets."""

from __future__ import annotations

from PySide6.QtWidgets import QAbstractButton, QWidget

from apd_viewer.ui.actions.action_maker import without_mnemonic
from apd_viewer.ui.widgets.slider_field import SliderField


def texts_of(widget: QWidget) -> tuple[str, str]:
    """Title and tip of a control, each on one line; empty if missing."""
    if isinstance(widget, SliderField):
        widget = widget.field
    title = widget.accessibleName()
    if isinstance(widget, QAbstractButton) and not title:
        title = without_mnemonic(widget.text())
    return _flat(title), _flat(widget.toolTip())


def _flat(text: str) -> str:
    """Text on one line."""
    return " ".join(text.split())
