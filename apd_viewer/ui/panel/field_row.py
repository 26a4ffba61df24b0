"""Row of a label and a number field."""

from __future__ import annotations

from PySide6.QtWidgets import QHBoxLayout, QLabel, QWidget

from apd_viewer.ui.widgets.fields import NumberField


def field_row(title: str, field: NumberField) -> QWidget:
    """Row with the title at the left and the field at the right."""
    row = QWidget()
    line = QHBoxLayout(row)
    line.setContentsMargins(0, 0, 0, 0)
    label = QLabel(title, toolTip=field.toolTip())
    label.setBuddy(field)
    line.addWidget(label)
    line.addStretch(1)
    line.addWidget(field)
    return row
