"""Charts of a timeline by step: area and volume, energy or strain."""

from collections.abc import Callable, Sequence

import numpy as np

from apd_viewer.language import tr
from apd_viewer.presentation.axis import Axis, linear_axis, rounded_axis
from apd_viewer.presentation.number_format import format_short, format_signed, format_significant
from apd_viewer.presentation.step_readings import StepCurves, step_curves
from apd_viewer.session.model.timeline import Timeline
from apd_viewer.ui.plots.chart_drawing import Chart, Curve, Dots, ReferenceLine
from apd_viewer.ui.widgets.theme import LIGHT, Theme

_LEAST = 0.02  # %: smallest range of the axes of percentages


class StepCharts:
    """Charts of a timeline, with the step on screen.

    Parameters
    ----------
    shown : callable
        Number of the step on screen; None if it is another shape.

    Attributes
    ----------
    timeline : Timeline
        What is drawn.
    ahead : int
        Steps of the motion under way that are still to come.
    theme : Theme
    """

    def __init__(self, shown: Callable[[], int | None]) -> None:
        self._shown = shown
        self.timeline, self.ahead = Timeline(), 0
        self.theme: Theme = LIGHT
        self._curves = step_curves(self.timeline)
        self._curves_of = self.timeline

    def _read_curves(self) -> StepCurves:
        """Curves of the timeline, read anew where it changed."""
        if self._curves_of is not self.timeline:
            self._curves, self._curves_of = step_curves(self.timeline), self.timeline
        return self._curves

    def size_chart(self) -> Chart:
        """Chart of the changes of area and volume."""
        found = self._read_curves()
        rows = (
            (tr("area {change} %"), found.area, "accent"),
            (tr("volume {change} %"), found.volume, "warm"),
        )
        number, said = self._shown(), []
        for words, values, color in rows:
            if number is not None and np.isfinite(values[number]):
                said.append((words.format(change=format_signed(float(values[number]), 2)), color))
        known = np.concatenate([values[np.isfinite(values)] for _, values, _ in rows])
        low, high = float(known.min(initial=-_LEAST)), float(known.max(initial=_LEAST))
        curves = [(values, color) for _, values, color in reversed(rows)]
        return self._chart(curves, rounded_axis(low, high, " %"), said or [(tr("Area and volume"), "quiet")])

    def effort_chart(self) -> Chart:
        """Chart of the energy where it is known, of the mean edge strain otherwise."""
        found = self._read_curves()
        has_energy = np.isfinite(found.energy).sum() > 1  # that of rest is always known
        values = found.energy if has_energy else found.strain
        said, number = [(tr("Energy") if has_energy else tr("Mean edge strain"), "quiet")], self._shown()
        if number is not None and np.isfinite(values[number]):
            value = float(values[number])
            text = format_significant(value, 4) if has_energy else f"{format_short(value)} %"
            said.append((text, "accent"))
        known = values[np.isfinite(values)]
        y = rounded_axis(0.0, float(known.max(initial=0.0)) or 1.0, "" if has_energy else " %")
        return self._chart([(values, "accent")], y, said)

    def _chart(
        self, rows: Sequence[tuple[np.ndarray, str]], y: Axis, said: Sequence[tuple[str, str]]
    ) -> Chart:
        """Chart of values by step, broken between runs, with the step on screen."""
        steps, count = self.timeline.steps, len(self.timeline.steps)
        if count < 2:
            return Chart("", empty_text=tr("The steps of a motion are drawn here."))
        x, starts = np.arange(1.0, count + 1.0), [k for k in range(1, count) if steps[k].begins_run]
        curves = [
            Curve(np.insert(x, starts, np.nan), np.insert(values, starts, np.nan), color)
            for values, color in rows
        ]
        number = self._shown()
        at = [] if number is None else [number]
        points = np.vstack([np.column_stack([x, values])[at] for values, _ in rows])
        unsettled = ~self._curves.settled
        crosses = np.vstack([np.column_stack([x, v])[unsettled & np.isfinite(v)] for v, _ in rows])
        return Chart(
            "",
            tuple(said),
            linear_axis(1.0, float(count + self.ahead), whole=True),
            y,
            tuple(curves),
            dots=Dots(*points.T, (self.theme.ink,) * len(points), crosses),
            vertical_lines=tuple(ReferenceLine(float(x[k])) for k in at),
        )
