"""Field to search in, beside the cross that closes what it searches."""

from __future__ import annotations

from PySide6.QtWidgets import QHBoxLayout, QLineEdit

from apd_viewer.language import tr
from apd_viewer.ui.widgets.fields import small_button
from apd_viewer.ui.widgets.icons import icon
from apd_viewer.ui.widgets.theme import Theme


class SearchRow(QHBoxLayout):
    """Search field and cross.

    Parameters
    ----------
    name, prompt : str
        Of the field.
    closing : str
        Name of the cross.

    Attributes
    ----------
    field : QLineEdit
    close_button : QToolButton
    """

    def __init__(self, name: str, prompt: str, closing: str) -> None:
        super().__init__(spacing=8)
        self.field = QLineEdit(accessibleName=name, placeholderText=prompt, clearButtonEnabled=True)
        self.close_button = small_button(closing, tr("Close (Esc)"))
        self.addWidget(self.field, 1)
        self.addWidget(self.close_button)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the cross."""
        self.close_button.setIcon(icon("cancel", theme))
