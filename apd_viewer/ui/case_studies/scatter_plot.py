"""Scatter plot of two columns of the results, with the colour of a third."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from PySide6.QtWidgets import QGridLayout, QLabel, QVBoxLayout, QWidget

from apd_viewer.language import tr
from apd_viewer.studies.case_file import FAILED
from apd_viewer.ui.case_studies.case_colors import axis_of, color_bar_colors, dot_colors, uniform_colors
from apd_viewer.ui.case_studies.column_choice import ColumnChoice
from apd_viewer.ui.case_studies.result_columns import ResultColumn
from apd_viewer.ui.case_studies.result_model import ResultModel
from apd_viewer.ui.plots.chart import Chart, ColorBar, Dots
from apd_viewer.ui.plots.scatter_view import ScatterView


class ScatterPlot(QWidget):
    """The plot, and the choices of its columns.

    Parameters
    ----------
    model : ResultModel

    Attributes
    ----------
    across, upright, color : ColumnChoice
    view : ScatterView
    """

    def __init__(self, model: ResultModel) -> None:
        super().__init__()
        self._model = model
        self._drawn: Chart | None = None
        self.upright = ColumnChoice(tr("Upright axis"))
        self.across = ColumnChoice(tr("Axis across"))
        self.color = ColumnChoice(tr("Colour"), may_be_none=True)
        self.view = ScatterView(self._chart, self._about)
        for choice in (self.across, self.upright, self.color):
            choice.chosen.connect(self.redraw)
        self._lay_out()

    def _lay_out(self) -> None:
        head = QGridLayout(horizontalSpacing=6, verticalSpacing=0)
        head.setContentsMargins(8, 4, 8, 0)
        for k, (word, choice) in enumerate(
            ((tr("y"), self.upright), (tr("x"), self.across), (tr("colour"), self.color))
        ):
            label = QLabel(word, objectName="quiet")
            label.setBuddy(choice)
            head.addWidget(label, 0, 2 * k)
            head.addWidget(choice, 0, 2 * k + 1)
        head.setColumnStretch(head.columnCount(), 1)
        column = QVBoxLayout(self, spacing=0)
        column.setContentsMargins(0, 0, 0, 0)
        column.addLayout(head)
        column.addWidget(self.view, 1)

    def refresh(self) -> None:
        """Offer the columns of the model, and draw them."""
        columns = self._model.numeric_columns
        asked = [column for column in columns if column.is_from_plan]
        found = [column for column in columns if not column.is_from_plan]
        volume, energy = ([c for c in found if c.name == name] for name in ("volume_error", "energy"))
        self.across.set_columns(columns, [*asked, *found])
        self.upright.set_columns(columns, [*volume, *found, *asked[1:], *asked])
        # The area is the same in all cases, as a rule; the energy is not.
        self.color.set_columns(columns, [*asked[1:2], *energy, *found[:1]])
        self.redraw()

    def mark_rows(self, rings: Mapping[int, str]) -> None:
        """Mark rows of the plan by rings of these colours."""
        self.view.rings = rings
        self.view.update()

    def redraw(self) -> None:
        """Draw anew."""
        self._drawn = None
        self.view.update()

    def _chart(self) -> Chart:
        if self._drawn is None:
            self._drawn = self._made()
        return self._drawn

    def _made(self) -> Chart:
        columns = {column.name: column for column in self._model.columns}
        x, y = columns.get(self.across.name), columns.get(self.upright.name)
        if x is None or y is None or not (x.is_numeric and y.is_numeric):
            return Chart("", empty_text=tr("Finished cases appear here."))
        (across, at_x), (upright, at_y) = axis_of(x), axis_of(y)
        color = columns.get(self.color.name)
        ramp, colors = None, uniform_colors(len(at_x))
        if color is not None and color.is_numeric:
            axis, places = axis_of(color)
            ramp, colors = ColorBar(axis, color_bar_colors()), dot_colors(axis, places)
        failed = np.array([row.status == FAILED for row in self._model.rows], dtype=bool)
        crosses = np.column_stack([at_x, np.where(np.isfinite(at_y), at_y, upright.low)])[failed]
        dots = Dots(
            at_x,
            np.where(failed, np.nan, at_y),
            colors,
            crosses[np.isfinite(crosses).all(axis=1)],
        )
        return Chart("", x=across, y=upright, dots=dots, color_bar=ramp)

    def _about(self, row: int) -> str:
        """Line of the plan and the values of the axes."""
        named = {self.upright.name, self.across.name, self.color.name}
        shown: list[ResultColumn] = [self._model.columns[0]]
        shown += [column for column in self._model.columns if column.name in named]
        return "\n".join(f"{column.title}: {column.texts[row]}" for column in shown)
