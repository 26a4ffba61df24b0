"""Curves of chosen cases above each other."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from PySide6.QtCore import QSize
from PySide6.QtWidgets import QHBoxLayout, QLabel, QVBoxLayout, QWidget

from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.presentation.axis import linear_axis, rounded_axis
from apd_viewer.studies.case_file import DONE, read_case
from apd_viewer.ui.case_studies.column_choice import ColumnChoice
from apd_viewer.ui.case_studies.result_columns import ResultColumn, reading_words
from apd_viewer.ui.case_studies.result_model import ResultModel
from apd_viewer.ui.plots.chart_drawing import Chart, Curve
from apd_viewer.ui.plots.plots import ChartTexts, ChartView

_ABSCISSA = "part"
_OFFERED = (
    "volume_error",
    "area_error",
    "energy",
    "local_change",
    "handle_drift",
    "volume",
    "volume_capped",
    "area",
    "share_reached",
)
_LOWEST = QSize(200, 120)
_Curves = Mapping[str, list[float | None]]


class CaseCurves(QWidget):
    """A measurement along the motion of each chosen case.

    Parameters
    ----------
    model : ResultModel

    Attributes
    ----------
    reading : ColumnChoice
    view : ChartView
    """

    def __init__(self, model: ResultModel) -> None:
        super().__init__()
        self._model = model
        self._folder: Path | None = None
        self._kept: dict[str, _Curves] = {}
        self._shown: Mapping[int, str] = {}
        self.reading = ColumnChoice(tr("Measurement along the motion"))
        nothing = np.empty(0)
        offered = [
            ResultColumn(name, reading_words(name).title, reading_words(name).tip, nothing, ())
            for name in _OFFERED
        ]
        self.reading.set_columns(offered, offered)
        self.reading.chosen.connect(self._redraw)
        self.view = ChartView(ChartTexts(tr("Curves of the chosen cases"), ""), self._chart)
        self.view.setMinimumSize(_LOWEST)
        head = QHBoxLayout(spacing=6)
        head.setContentsMargins(8, 4, 8, 0)
        head.addWidget(self.reading)
        head.addWidget(QLabel(tr("by motion"), objectName="quiet"))
        head.addStretch(1)
        column = QVBoxLayout(self, spacing=0)
        column.setContentsMargins(0, 0, 0, 0)
        column.addLayout(head)
        column.addWidget(self.view, 1)

    def show_study(self, folder: Path) -> None:
        """Show cases of another study."""
        self._folder, self._kept, self._shown = folder, {}, {}
        self._redraw()

    def show_cases(self, colors: Mapping[int, str]) -> None:
        """Show the curves of rows of the plan, each in a colour."""
        self._shown = dict(colors)
        self._redraw()

    def _redraw(self) -> None:
        self.view.update()

    def _curves(self, row: int) -> _Curves:
        """Curves of a case; none if it is not done or its file cannot be read."""
        found = self._model.rows[row]
        if found.status != DONE or self._folder is None:
            return {}
        if found.key not in self._kept:
            try:
                self._kept[found.key] = read_case(self._folder, found.key).curves
            except InputError:
                return {}
        return self._kept[found.key]

    def _chart(self) -> Chart:
        name = self.reading.name
        scale = 100.0 if reading_words(name).percent else 1.0
        curves, legend = [], []
        for row, color in self._shown.items():
            found = self._curves(row)
            y = scale * np.array(found.get(name, []), dtype=float)
            if np.isfinite(y).any():
                curves.append(Curve(100.0 * np.array(found[_ABSCISSA], dtype=float), y, color))
                legend += [("━", color), (f"{self._model.rows[row].line}", "quiet")]
        if not curves:
            return Chart("", empty_text=tr("Choose finished cases to see their curves; Ctrl adds one."))
        every = np.concatenate([curve.y for curve in curves])
        end = max(float(curve.x[-1]) for curve in curves)
        y_axis = rounded_axis(float(np.nanmin(every)), float(np.nanmax(every)), " %" if scale > 1.0 else "")
        return Chart("", tuple(legend), linear_axis(0.0, end, " %"), y_axis, tuple(curves))
