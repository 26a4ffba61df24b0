"""Readings of a shape between two plates, or on a timeline, as texts and curves."""

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from apd_viewer.language import tr
from apd_viewer.presentation import obstacle_readings, readings
from apd_viewer.presentation.number_format import format_length, format_significant
from apd_viewer.session.model import memo
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.named_obstacle import ObstacleKind
from apd_viewer.session.model.obstacle_pair import ObstaclePair, obstacle_pair
from apd_viewer.session.model.state import State
from apd_viewer.session.model.timeline import Timeline
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.session.quantities.newton_conversion import NewtonConversion
from apd_viewer.session.quantities.units import Unit

FindConversion = Callable[[State], NewtonConversion | None]
_LOAD_TIP = tr("Mean force on the plates, of a material of stiffness 1; in newtons where the wall is known")
_EXCESS_TIP = tr("By how much the load is too high, as the cells of the mesh bend, too")
_CRUMPLING_TIP = tr("Without stiffness, walls crumple and loads mean little")

_SHORT_NOTE = 12  # characters of a note that has room beside the second column


class ReadingText(NamedTuple):
    """A reading: its title, value, a note beside it, and a tip.

    ``other`` and ``other_note`` are value and note of another solution of the same step, if there is one.
    """

    title: str
    value: str
    note: str = ""
    tip: str = ""
    other: str = ""
    other_note: str = ""


def plate_reading_texts(
    state: State,
    unit: Unit,
    newtons: NewtonConversion | None,
    other: tuple[State, NewtonConversion | None] | None = None,
    yield_radius: float | None = None,
) -> tuple[ReadingText, ...]:
    """Distance, load, volume, area and tightest bend of a shape between plates.

    Parameters
    ----------
    other : (State, NewtonConversion or None), optional
        Another solution of the same step, whose readings are put beside those of the shape.
    yield_radius : float, optional
        Radius below which the wall keeps a crease, mesh units.
    """
    own = _readings(state, unit, newtons, yield_radius)
    if other is None:
        return own
    return tuple(map(_with_other, own, _readings(other[0], unit, other[1], None)))


def main_plate_readings(
    state: State, unit: Unit, newtons: NewtonConversion | None
) -> tuple[ReadingText, ...]:
    """Distance, load, volume and area of a shape between plates."""
    area = ReadingText(tr("Area"), readings.area_percent(state), "", tr("In percent of the area at rest"))
    return _distance(state, unit), _load(state, newtons), volume_reading(state, unit), area


def _readings(
    state: State, unit: Unit, newtons: NewtonConversion | None, yield_radius: float | None
) -> tuple[ReadingText, ...]:
    return *main_plate_readings(state, unit, newtons), _bend(state, unit, yield_radius)


def _with_other(own: ReadingText, other: ReadingText) -> ReadingText:
    """Reading beside that of another solution; a long note of that goes into the tip."""
    if len(other.note) <= _SHORT_NOTE:
        return own._replace(other=other.value, other_note=other.note)
    tip = tr("{tip}. In the second column: {reading}").format(tip=own.tip.rstrip("."), reading=_joined(other))
    return own._replace(other=other.value, tip=f"{tip}.")


def _bend(state: State, unit: Unit, yield_radius: float | None) -> ReadingText:
    tip = tr("Radius of the tightest bend, and of the one below which the wall keeps a crease")
    if not state.frame.settled:
        return ReadingText(tr("Tightest bend"), readings.PENDING, "", tip)
    mesh, size = state.document.mesh, float(max(state.inspection.size))
    radius = memo.tightest_bend(mesh.V, mesh.joined_F, state.frame.U)
    if radius is None:
        return ReadingText(tr("Tightest bend"), readings.NO_VALUE, "", tip)
    note = ""
    if yield_radius is not None:
        crease = unit.format_length(format_significant(yield_radius, 3))
        note = tr("creases below {radius}").format(radius=crease)
    return ReadingText(tr("Tightest bend"), unit.format_length(format_length(radius, size)), note, tip)


def _distance(state: State, unit: Unit) -> ReadingText:
    pair, tip = (
        obstacle_pair(state.document),
        tr("Distance of the plates, and in percent of the extent at rest"),
    )
    if pair is None:
        return ReadingText(tr("Distance"), readings.NO_VALUE, "", tip)
    distance = pair.distance(state)
    length = unit.format_length(format_length(distance, float(max(state.inspection.size))))
    percent = readings.rest_percent(distance, pair.extent(state.document))
    return ReadingText(tr("Distance"), length, percent, tip)


def _load(state: State, newtons: NewtonConversion | None) -> ReadingText:
    pair, tip = obstacle_pair(state.document), obstacle_readings.force_tip(newtons, _LOAD_TIP)
    if pair is None or not state.frame.settled:
        return ReadingText(tr("Load"), readings.NO_VALUE if pair is None else readings.PENDING, "", tip)
    load, excess = pair.reading(state).load, state.load_excess
    if load <= obstacle_readings.NO_LOAD * float(max(state.inspection.size)):
        return ReadingText(tr("Load"), "0", "", tip)
    text = obstacle_readings.force_text(load, newtons)
    if excess is None:
        tip = obstacle_readings.force_tip(newtons, _LOAD_TIP, _CRUMPLING_TIP)
        return ReadingText(tr("Load"), text, tr("means little"), tip)
    note = tr("excess {percent} %").format(percent=format_significant(100.0 * excess, 2))
    off = "" if newtons is None else obstacle_readings.error_factor_phrase(newtons.underestimate_factor())
    tip = obstacle_readings.force_tip(newtons, _LOAD_TIP, _EXCESS_TIP)
    return ReadingText(tr("Load"), text, off or note, tip)


def _joined(reading: ReadingText) -> str:
    return f"{reading.value} ({reading.note})" if reading.note else reading.value


def volume_reading(state: State, unit: Unit) -> ReadingText:
    """Enclosed volume of a shape, and its percentage of that at rest."""
    tip = tr("Enclosed volume, and in percent of that at rest")
    now, rest = readings.volumes(state.frame, state.inspection)
    if not rest or now is None:
        return ReadingText(tr("Volume"), readings.NO_VALUE, "", tip)
    note = readings.rest_percent(now, rest)
    litres = unit.to_litres(now)
    if litres is None:
        return ReadingText(tr("Volume"), unit.format_volume(format_significant(now, 4)), note, tip)
    symbol, factor = unit.capacity_unit(unit.to_litres(rest) or litres)
    return ReadingText(tr("Volume"), f"{format_significant(factor * litres, 4)}\u00a0{symbol}", note, tip)


class PressDirection(NamedTuple):
    """Axis to press along, by plates, or by two fingers that squeeze."""

    axis: int
    is_squeeze: bool


def press_directions(up: UpAxis) -> list[PressDirection]:
    """Directions to press in; fingers squeeze from the sides."""
    by_plates = [PressDirection(axis, False) for axis in range(3)]
    return by_plates + [PressDirection(axis, True) for axis in range(3) if axis != up.index]


def direction_titles(state: State, unit: Unit, up: UpAxis) -> list[str]:
    """Titles of the directions, with the extent of the mesh along each."""
    size, titles = state.inspection.size, []
    for axis, is_squeeze in press_directions(up):
        title = tr("{axis}, two fingers ({length})") if is_squeeze else tr("{axis}, side load ({length})")
        title = tr("{axis}, top load ({length})") if axis == up.index else title
        length = unit.format_length(format_length(float(size[axis]), float(max(size))))
        titles.append(title.format(axis="XYZ"[axis], length=length))
    return titles


def direction_number(pair: ObstaclePair, document: Document, up: UpAxis) -> int:
    """Number of the direction in which a pair presses; 0 if it is none of them."""
    is_squeeze = document.obstacles[pair.low].kind is ObstacleKind.SPHERE
    direction = PressDirection(int(np.argmax(np.abs(pair.axis))), is_squeeze)
    directions = press_directions(up)
    return directions.index(direction) if direction in directions else 0


def rest_verdict(
    state: State,
    unsettled: str = tr("Not at rest: the load is not known yet."),
    stopped: str = tr("Contact stops the plates here."),
) -> tuple[str, bool]:
    """Sentence saying whether a shape is in equilibrium, and True if it is.

    ``unsettled`` and ``stopped`` are the sentences for a shape not in equilibrium or stopped by contact.
    """
    if not state.frame.settled:
        return unsettled, False
    if state.frame.share_reached < 1.0:
        return stopped, False
    if state.frame.stable is False:
        return tr("At rest, but on a saddle: a push may make it give way."), False
    pair = obstacle_pair(state.document)
    if pair is not None and (found := pair.reading(state)).deflection > 0.0 and found.load == 0.0:
        return tr("At rest; nothing touches it here."), True
    return tr("At rest."), True


# Relative fall of a load that is no error of an equilibrium.
_FALLS = 0.01


def has_given_way(states: Sequence[State]) -> bool:
    """True if a load fell from one state to the next while the plates closed."""
    pairs = ((obstacle_pair(state.document), state) for state in states)
    found = [pair.reading(state) for pair, state in pairs if pair is not None and state.frame.settled]
    return any(
        after.deflection > before.deflection and after.load < (1.0 - _FALLS) * before.load
        for before, after in pairwise(found)
    )


class PlateCurves(NamedTuple):
    """Readings along a timeline; NaN if unknown.

    Attributes
    ----------
    states : tuple of State or None
        State of each step.
    deflection : (s,) float array
        Reduction of the distance of the plates, mesh units.
    load : (s,) float array
        Load of a material of stiffness 1, or in newtons.
    volume : (s,) float array
        Percent of the volume at rest.
    settled : (s,) bool array
    """

    states: tuple[State | None, ...]
    deflection: np.ndarray
    load: np.ndarray
    volume: np.ndarray
    settled: np.ndarray


def plate_curves(states: Sequence[State | None], newtons: FindConversion) -> PlateCurves:
    """Curves of load and volume over states; None makes a gap."""
    rows = [_NO_ROW if state is None else _curve_row(state, newtons(state)) for state in states]
    deflection, load, volume, settled = np.array(rows).reshape(-1, 4).T
    return PlateCurves(tuple(states), deflection, load, volume, settled > 0.0)


_NO_ROW = np.nan, np.nan, np.nan, 1.0


def _curve_row(state: State, newtons: NewtonConversion | None) -> tuple[float, float, float, float]:
    pair = obstacle_pair(state.document)
    now, rest = readings.volumes(state.frame, state.inspection)
    volume = 100.0 * now / rest if rest and now is not None else np.nan
    if pair is None:
        return np.nan, np.nan, volume, float(state.frame.settled)
    found, factor = pair.reading(state), 1.0 if newtons is None else newtons.newtons_per_load
    return found.deflection, factor * max(0.0, found.load), volume, float(state.frame.settled)


_LOCAL_TIP = tr("Largest relative change of the area of a triangle")
_STRAIN_TIP = tr("Of the edge whose length has changed most")


def step_reading_texts(state: State, unit: Unit) -> tuple[ReadingText, ...]:
    """Area, volume, local change and edge strain of a shape."""
    return (
        ReadingText(tr("Area"), readings.area_percent(state), "", tr("In percent of the area at rest")),
        volume_reading(state, unit),
        ReadingText(tr("Local change"), readings.local_change(state), "", _LOCAL_TIP),
        ReadingText(tr("Edge strain"), readings.largest_edge_strain(state), "", _STRAIN_TIP),
    )


def step_verdict(state: State) -> tuple[str, bool]:
    """Sentence saying whether a shape is in equilibrium; True if it needs no warning."""
    if state.frame.settled and state.document.paint_problem is not None:
        return tr("As it is in the file."), True
    return rest_verdict(state, tr("Not at rest."), tr("Contact stops the motion here."))


class StepCurves(NamedTuple):
    """Readings along a timeline, each (s,); NaN if unknown.

    Attributes
    ----------
    area, volume : float array
        Percent of rest.
    energy : float array
        Squared lengths.
    strain : float array
        Mean absolute strain of the edges, percent.
    settled : bool array
    """

    area: np.ndarray
    volume: np.ndarray
    energy: np.ndarray
    strain: np.ndarray
    settled: np.ndarray


def step_curves(timeline: Timeline) -> StepCurves:
    """Curves of area, volume, energy and strain along a timeline."""
    rows = np.array([_step_row(step.state) for step in timeline.steps]).reshape(-1, 5)
    area, volume, energy, strain, settled = rows.T
    return StepCurves(area, volume, energy, strain, settled > 0.0)


def _step_row(state: State) -> tuple[float, ...]:
    frame = state.frame
    now, rest = readings.volumes(frame, state.inspection)
    volume = 100.0 * now / rest if rest and now is not None else np.nan
    energy = np.nan if frame.energy is None else frame.energy
    return (
        100.0 * (1.0 + frame.area_error),
        volume,
        energy,
        100.0 * frame.mean_edge_strain,
        float(frame.settled),
    )
