"""Charts of a timeline: loads and volume of a press, or readings by step."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from apd_viewer.geometry.solver.methods import METHODS
from apd_viewer.language import tr
from apd_viewer.presentation.axis import Axis, linear_axis, rounded_axis
from apd_viewer.presentation.number_format import format_grouped, format_short, format_significant
from apd_viewer.presentation.obstacle_readings import LOAD_DIGITS, newtons_text
from apd_viewer.presentation.plate_readings import PlateCurves, StepCurves, plate_curves, step_curves
from apd_viewer.presentation.readings import percent_text
from apd_viewer.session.model.obstacle_pair import obstacle_pair
from apd_viewer.session.model.timeline import Timeline
from apd_viewer.session.session import Session
from apd_viewer.ui.plots.chart_drawing import Chart, Curve, Dots, ReferenceLine
from apd_viewer.ui.simulate.known_wall import KnownWall
from apd_viewer.ui.widgets.theme import LIGHT, Theme

_LEAST, _LEAST_OF_STEPS = 1.0, 0.02  # %: smallest range of the volume axis, and of the axes of StepCharts


class PressCharts:
    """Load and volume over the deflection of a press, with the displayed step.

    One curve shows the states by the methods of the motions, another with dots those by the Wall method.

    Attributes
    ----------
    timeline : Timeline
        Timeline to draw.
    reach : float
        Requested deflection of the plates, mesh units.
    theme : Theme
    """

    def __init__(self, session: Session, wall: KnownWall) -> None:
        self._session, self._wall = session, wall
        self.timeline, self.reach = Timeline(), 0.0
        self.theme: Theme = LIGHT
        self._curves: tuple[PlateCurves, ...] = ()
        self._curves_of: tuple[Timeline | None, object] = None, None

    def load_chart(self) -> Chart:
        """Chart of the load against the deflection."""
        points = [np.column_stack([part.deflection, part.load]) for part in self._read_curves()]
        loads = np.vstack(points)[:, 1]
        state = self._session.store.state
        suffix = tr(" N") if state is not None and self._wall.newtons(state) is not None else ""
        if not np.isfinite(loads).any():
            return Chart("", empty_text=tr("Press to see the load here."))
        y = rounded_axis(0.0, float(np.nanmax(loads)) or 1.0, suffix)
        title = tr("Load") if suffix else tr("Load, at stiffness 1")
        said = newtons_text if suffix else partial(format_significant, digits=LOAD_DIGITS)
        return self._chart((title, *self.names), points, "accent", y, said)

    def volume_chart(self) -> Chart:
        """Chart of the volume against the deflection, in percent of rest."""
        points = [np.column_stack([part.deflection, part.volume]) for part in self._read_curves()]
        known = np.vstack(points)
        known = known[np.isfinite(known).all(axis=1), 1]
        if not len(known):
            return Chart("", empty_text=tr("Press to see the volume of a closed mesh here."))
        y = rounded_axis(min(float(known.min()), 100.0 - _LEAST), max(float(known.max()), 100.0), " %")
        first, wall = self.names
        # Short titles: the legend has no room for longer ones.
        words = tr("Volume"), first, METHODS["wall"].short_title if wall else ""
        return self._chart(words, points, "warm", y, percent_text)

    def _read_curves(self) -> tuple[PlateCurves, ...]:
        """Curves of the motions and of the Wall method, updated after changes."""
        given, steps = (self._wall.text(), self._session.store.unit), self.timeline.steps
        if self._curves_of[0] is not self.timeline or self._curves_of[1] != given:
            self._curves = (
                plate_curves([step.non_wall_state for step in steps], self._wall.newtons),
                plate_curves([step.wall_state for step in steps], self._wall.newtons_as_pressed),
            )
            self._curves_of = self.timeline, given
        return self._curves

    def _chart(
        self,
        words: tuple[str, str, str],
        points: Sequence[np.ndarray],
        color: str,
        y: Axis,
        said: Callable[[float], str],
    ) -> Chart:
        """Chart of curves (s, 2), broken between runs, with the displayed step.

        ``words`` are its title and the names of the curves, ``said`` formats their values.
        """
        title, *names = words
        state = self._session.store.state
        pair = None if state is None else obstacle_pair(state.document)
        way = np.nan if state is None or pair is None else pair.reading(state).deflection
        number = None if state is None else self.timeline.index_of(state)
        starts = [k for k, step in enumerate(self.timeline.steps) if step.begins_run]
        drawn, places, crosses = [], [np.empty((0, 2))], []
        for rows, each, its_color in zip(points, self._curves, (color, "ink"), strict=True):
            known = np.isfinite(rows).all(axis=1)
            if known.any():
                x, broken = (np.insert(row, starts, np.nan) for row in rows.T)
                drawn.append(Curve(x, broken, its_color, has_dots=its_color != color))
                crosses.append(rows[known & ~each.settled])
            if number is not None and known[number]:
                places.append(rows[[number]])
        at = np.vstack(places)
        reach = np.nanmax([*np.vstack(points)[:, 0].tolist(), way, self.reach, 0.0])
        return Chart(
            "",
            ((title, "quiet"), *self._legend(names, points, number, color, said)),
            linear_axis(0.0, float(reach) or 1.0, self._session.store.unit.format_length("")),
            y,
            tuple(drawn),
            dots=Dots(*at.T, (self.theme.ink,) * len(at), np.vstack(crosses)),
            vertical_lines=(ReferenceLine(way),) if np.isfinite(way) else (),
        )

    @staticmethod
    def _legend(
        names: Sequence[str],
        points: Sequence[np.ndarray],
        number: int | None,
        color: str,
        said: Callable[[float], str],
    ) -> list[tuple[str, str]]:
        """Value of the curve at a step, or the names of two with values beside them."""
        first, wall = names
        if first and wall:
            return [(first, color), (f"\u25cf\u00a0{wall}", "ink")]
        values = [np.nan if number is None else rows[number, 1] for rows in points]
        colors = color, "ink"
        return [(said(value), its) for value, its in zip(values, colors, strict=True) if np.isfinite(value)]

    @property
    def names(self) -> tuple[str, str]:
        """Names of the two curves; empty for a missing one."""
        first, wall = (
            [state.document.settings for state in each.states if state is not None]
            for each in self._read_curves()
        )
        return first[-1].traits.short_title if first else "", self._wall.title(wall[-1]) if wall else ""


class StepCharts:
    """Measurements over the steps of a timeline, with the displayed step.

    Attributes
    ----------
    timeline : Timeline
        Timeline to draw.
    shown_number : int or None
        Number of its displayed step; None for any other shape.
    ahead : int
        Number of remaining steps of the current motion.
    theme : Theme
    """

    def __init__(self) -> None:
        self.timeline, self.ahead = Timeline(), 0
        self.shown_number: int | None = None
        self.theme: Theme = LIGHT
        self._curves = step_curves(self.timeline)
        self._curves_of = self.timeline

    def _read_curves(self) -> StepCurves:
        """Curves of the timeline, updated after changes."""
        if self._curves_of is not self.timeline:
            self._curves, self._curves_of = step_curves(self.timeline), self.timeline
        return self._curves

    def size_chart(self) -> Chart:
        """Chart of area and volume, in percent of rest."""
        found = self._read_curves()
        rows = (
            (tr("Area"), tr("area {percent} %"), found.area, "accent", 3),
            (tr("Volume"), tr("volume {percent} %"), found.volume, "warm", 1),
        )
        number, said = self.shown_number, []
        for title, words, values, color, decimals in rows:
            if number is not None and np.isfinite(values[number]):
                said.append((words.format(percent=format_grouped(float(values[number]), decimals)), color))
            elif np.isfinite(values).any():
                said.append((title, color))
        known = np.concatenate([values[np.isfinite(values)] for *_, values, _, _ in rows])
        low = float(known.min(initial=100.0 - _LEAST_OF_STEPS))
        high = float(known.max(initial=100.0 + _LEAST_OF_STEPS))
        curves = [(values, color) for *_, values, color, _ in reversed(rows)]
        return self._chart(curves, rounded_axis(low, high, " %"), said)

    def effort_chart(self) -> Chart:
        """Chart of the energy if it is known, else of the mean edge strain."""
        found = self._read_curves()
        has_energy = np.isfinite(found.energy).sum() > 1  # that of the rest shape is always known
        values = found.energy if has_energy else found.strain
        said, number = [(tr("Energy") if has_energy else tr("Mean edge strain"), "quiet")], self.shown_number
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
        """Chart of values by step, broken between runs, with the displayed step."""
        steps, count = self.timeline.steps, len(self.timeline.steps)
        if count < 2:
            return Chart("", empty_text=tr("The steps of a motion are drawn here."))
        x, starts = np.arange(1.0, count + 1.0), [k for k in range(1, count) if steps[k].begins_run]
        curves = [
            Curve(np.insert(x, starts, np.nan), np.insert(values, starts, np.nan), color)
            for values, color in rows
        ]
        number = self.shown_number
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
            x_title=tr("Step"),
        )
