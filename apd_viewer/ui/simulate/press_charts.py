"""Charts of load and volume over the travel of two plates."""

from collections.abc import Callable

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.solver.methods import wall_material
from apd_viewer.language import tr
from apd_viewer.presentation.axis import Axis, linear_axis, rounded_axis
from apd_viewer.presentation.number_format import format_significant
from apd_viewer.presentation.plate_readings import plate_curves
from apd_viewer.session.model.plate_pair import plate_pair
from apd_viewer.session.model.state import State
from apd_viewer.session.model.timeline import Timeline
from apd_viewer.session.quantities.newton_conversion import NewtonConversion, newton_conversion
from apd_viewer.session.quantities.wall import WallText, parse_wall
from apd_viewer.session.session import Session
from apd_viewer.ui.plots.chart_drawing import Chart, Curve, Dots, ReferenceLine
from apd_viewer.ui.widgets.theme import LIGHT, Theme

_LEAST = 1.0  # %: smallest range of the axis of volume


class PressCharts:
    """Charts of a timeline, with the step on screen.

    Parameters
    ----------
    wall : callable
        The wall as typed, for loads in newtons.

    Attributes
    ----------
    timeline : Timeline
        Timeline to draw.
    reach : float
        Way to where the plates are asked to go, mesh units.
    theme : Theme
    """

    def __init__(self, session: Session, wall: Callable[[], WallText]) -> None:
        self._session, self._wall = session, wall
        self.timeline, self.reach = Timeline(), 0.0
        self.theme: Theme = LIGHT
        self._conversion: tuple[tuple[object, ...], NewtonConversion | None] = (), None
        self._curves = plate_curves(self.timeline, self.newtons)
        self._curves_of: tuple[Timeline, object] = self.timeline, None

    def newtons(self, state: State) -> NewtonConversion | None:
        """Conversion of loads into newtons; None for an unknown wall."""
        document, unit = state.document, self._session.store.unit
        try:
            wall = parse_wall(self._wall(), unit)
        except InputError:
            return None
        if wall.rigidity is None or unit.metres is None:
            return None
        settings, mesh = document.settings.in_effect, document.mesh
        key = mesh, settings, wall
        if self._conversion[0] != key:
            rest, material = RestMesh(mesh.V, mesh.F, mesh.weld), settings.material
            if settings.traits.is_wall:
                material = wall_material(rest.diagonal, settings.wall_thickness, settings.poisson)
            self._conversion = key, newton_conversion(wall, material, rest)
        return self._conversion[1]

    def load_chart(self) -> Chart:
        """Chart of the load."""
        load = self._read_curves()
        state = self._session.store.state
        suffix = tr(" N") if state is not None and self.newtons(state) is not None else ""
        if not np.isfinite(load).any():
            return Chart("", empty_text=tr("Press to see the load here."))
        y = rounded_axis(0.0, float(np.nanmax(load)) or 1.0, suffix)
        return self._chart(tr("Load"), Curve(self._curves.deflection, load), y, suffix)

    def volume_chart(self) -> Chart:
        """Chart of the volume."""
        self._read_curves()
        deflection, volume = self._curves.deflection, self._curves.volume
        known = volume[np.isfinite(volume) & np.isfinite(deflection)]
        if not len(known):
            return Chart("", empty_text=tr("Press a closed mesh to see its volume here."))
        y = rounded_axis(min(float(known.min()), 100.0 - _LEAST), max(float(known.max()), 100.0), " %")
        return self._chart(tr("Volume"), Curve(deflection, volume, "warm"), y, " %")

    def _read_curves(self) -> np.ndarray:
        """Loads of the timeline, updated after a change of timeline, wall or unit."""
        given = self._wall(), self._session.store.unit
        if self._curves_of[0] is not self.timeline or self._curves_of[1] != given:
            self._curves, self._curves_of = plate_curves(self.timeline, self.newtons), (self.timeline, given)
        return self._curves.load

    def _chart(self, title: str, curve: Curve, y: Axis, suffix: str) -> Chart:
        """Chart of a curve, broken between runs, with the step on screen."""
        state = self._session.store.state
        pair = None if state is None else plate_pair(state.document)
        way = np.nan if state is None or pair is None else pair.reading(state).deflection
        number = None if state is None else self.timeline.index_of(state)
        at = [] if number is None else [number]
        values = [value for value in curve.y[at].tolist() if np.isfinite(value)]
        readings = [(f"{format_significant(value, 4)}{suffix}", curve.color) for value in values]
        points = np.column_stack([curve.x, curve.y])
        unsettled = points[~self._curves.settled & np.isfinite(points).all(axis=1)]
        reach = np.nanmax([*curve.x.tolist(), way, self.reach, 0.0])
        x, broken = (np.insert(row, self._curves.starts, np.nan) for row in points.T)
        return Chart(
            "",
            ((title, "quiet"), *readings),
            linear_axis(0.0, float(reach) or 1.0, self._session.store.unit.format_length("")),
            y,
            (Curve(x, broken, curve.color),),
            dots=Dots(curve.x[at], curve.y[at], (self.theme.ink,) * len(at), unsettled),
            vertical_lines=(ReferenceLine(way),) if np.isfinite(way) else (),
        )
