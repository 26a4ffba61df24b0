"""Dialog that asks for options, runs a command, and shows its figure."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from PySide6.QtCore import QSize, Qt
from PySide6.QtWidgets import (
    QDialog,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QLayout,
    QVBoxLayout,
    QWidget,
)

from apd_viewer.ui.studies.run_bar import RunBar
from apd_viewer.ui.widgets.fields import NumberField
from apd_viewer.ui.widgets.figure_view import FigureView
from apd_viewer.ui.widgets.fit_to_screen import largest_on_screen, resize_on_screen

_WIDTH, _WIDTH_WITH_FIGURE = 640, 900  # px


class RunDialog(QDialog):
    """Options of a command above the bar that runs it; then its summary and figure.

    Parameters
    ----------
    window : QWidget
    title : str
    run : RunBar
    figure : str
        File name of the figure among the results.
    caption : str
        What is to be seen there, for those who do not see it.

    Attributes
    ----------
    run : RunBar
    figure : FigureView or None
    """

    def __init__(self, window: QWidget, title: str, run: RunBar, figure: str, caption: str) -> None:
        super().__init__(window, objectName="study")
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setWindowTitle(title)
        self.run, self._named, self._caption = run, figure, caption
        self.run.busy_changed.connect(self._show_busy)
        self.run.ended.connect(self._show)
        self.figure: FigureView | None = None

    def lay_out(self, description: str, rows: Sequence[tuple[str, QLayout]]) -> None:
        """Arrange a sentence and the rows of options, each with its title."""
        self._column = QVBoxLayout(self, spacing=12)
        self._column.setContentsMargins(20, 16, 20, 16)
        self._column.addWidget(QLabel(description, objectName="quiet", wordWrap=True))
        self._asks = QWidget()
        self._column.addWidget(self._asks)
        self._rows = grid = QGridLayout(self._asks, horizontalSpacing=16, verticalSpacing=8)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setColumnStretch(1, 1)
        for number, (title, row) in enumerate(rows):
            grid.addWidget(QLabel(title, objectName="heading"), number, 0)
            grid.addLayout(row, number, 1)
        self.summary = QLabel(wordWrap=True, visible=False)
        self.summary.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self._column.addWidget(self.summary)
        self._column.addStretch(1)
        self._column.addWidget(self.run)
        self._fit(_WIDTH)

    def _show_busy(self, on: bool) -> None:
        self._asks.setEnabled(not on)
        # Reserve room for the bar above the button: it would be taken from the fields.
        self._column.activate()
        if self._column.totalHeightForWidth(self.width()) > self.height():
            self._fit(self.width())

    def _show(self, folder: Path, said: str) -> None:
        # The first line names a temporary folder; runs of blanks line columns up on a terminal only.
        lines = re.sub(" +", " ", "\n".join(said.splitlines()[1:]))
        self.summary.setText(re.sub(r"-(?=\d)", "−", lines))
        self.summary.show()
        if self.figure is not None:
            self._column.removeWidget(self.figure)
            self.figure.deleteLater()
        self.figure = FigureView(folder / self._named, self._caption)
        self._column.insertWidget(self._column.indexOf(self.summary), self.figure)
        self.figure.show()  # hidden widgets take no room
        self._fit(max(self.width(), _WIDTH_WITH_FIGURE))

    def _fit(self, width: int) -> None:
        """Set the width, and the height it needs; on a low screen the figure gives way."""
        self._rows.activate()  # otherwise the column learns of a longer text when the event loop runs
        self._column.activate()
        if self.figure is not None:
            self.figure.shrink_by(0)
            lacking = self._column.totalHeightForWidth(width) - largest_on_screen(self).height()
            self.figure.shrink_by(max(0, lacking))
        resize_on_screen(self, QSize(width, self._column.totalHeightForWidth(width)))

    def done(self, result: int) -> None:
        """Close the dialog, and end a run in progress."""
        self.run.discard_run()
        super().done(result)


def count_field(name: str, least: int, most: int, value: int, suffix: str = "") -> NumberField:
    """Field for a whole number."""
    field = NumberField(
        accessibleName=name, minimum=least, maximum=most, value=value, decimals=0, suffix=suffix
    )
    field.setFixedWidth(72)
    return field


def widget_row(*widgets: QWidget, spacing: int = 16) -> QHBoxLayout:
    """Widgets side by side, from the left."""
    row = QHBoxLayout(spacing=spacing)
    for widget in widgets:
        row.addWidget(widget)
    row.addStretch(1)
    return row
