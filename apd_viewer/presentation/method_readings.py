"""Measurements of the compared methods, as numbers and as table texts."""

import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

from apd_viewer.cases.comparison import MethodOutcome, OutcomeOrigin
from apd_viewer.files.tables import write_table
from apd_viewer.geometry.solver.methods import METHODS
from apd_viewer.language import tr, trc
from apd_viewer.presentation import number_format
from apd_viewer.presentation.readings import volumes
from apd_viewer.session.model.state import State
from apd_viewer.session.quantities.units import Unit

_FINEST = 1e-6  # relative error; smaller ones are written with a power of ten
_ROUNDING = 1e-15
_LONGEST_NAME = 12  # letters of a region in the title of its column

ReadingsByName = dict[str, float]


def method_readings(state: State, method: str, outcome: MethodOutcome) -> ReadingsByName:
    """Measurements of one method; NaN if unknown.

    ``area_error`` is relative to rest, as in reports, and ``area_miss`` to the target, for every method. The
    volume of an open surface includes its capped openings. The iterations and seconds of a whole path are
    unknown, where only its last part has been counted. ``contact`` is 1 where walls were kept apart.
    """
    rest, frame, cost = state.inspection, outcome.frame, outcome.cost
    if frame is None:
        return {}
    is_counted = outcome.origin.has_same_path
    volume, volume_rest = volumes(frame, rest)
    regions = zip(frame.regions, state.document.rest_areas, strict=False)
    return {
        "area": frame.area,
        "area_rest": rest.area,
        "area_error": frame.area_error,
        "area_miss": (1.0 + frame.area_error) / (state.document.settings.area / 100.0) - 1.0,
        "volume": math.nan if volume is None else volume,
        "volume_rest": volume_rest or math.nan,
        "energy": math.nan if cost is None else cost.energy,
        "handle_drift": frame.handle_drift,
        "local_change": frame.local_change,
        "largest_edge_strain": frame.largest_edge_strain,
        "mean_edge_strain": frame.mean_edge_strain,
        "iterations": float(frame.iteration) if is_counted else math.nan,
        "converged": float(frame.converged),
        "seconds": cost.seconds if cost is not None and is_counted else math.nan,
        "taken_from_window": float(outcome.origin is not OutcomeOrigin.COMPARISON),
        "contact": float(state.document.settings.contact and METHODS[method].may_use_contact),
        **{
            f"region_{k}{suffix}": value
            for k, areas in enumerate(regions, 1)
            for suffix, value in zip(("", "_rest"), areas, strict=True)
        },
    }


def missing_contact(state: State, method: str) -> str:
    """Sentence about a method that cannot use the contact that is on; else empty."""
    document, traits = state.document, METHODS[method]
    if not document.settings.contact or traits.may_use_contact:
        return ""
    sentence = tr("The method {method} cannot use contact: walls may pass through each other.")
    return traits.obstacle_problem if document.obstacles else sentence.format(method=traits.title)


class ReadingColumn(NamedTuple):
    """Column of the comparison table: title, tooltip and cell text."""

    title: str
    tip: str
    cell_text: Callable[[ReadingsByName], str]
    name: str = ""

    def cell_tip(self, readings: ReadingsByName) -> str:
        """Tooltip of a cell: that of the column, or the origin of another kind of value."""
        if self.name not in _OF_PATH or not readings.get("taken_from_window"):
            return self.tip
        return _NOT_COUNTED if math.isnan(readings[self.name]) else _OF_PATH[self.name] or self.tip


_NOT_COUNTED = tr("Not known: the shape was reached in the main window, by way of other shapes.")
# Readings of the path from rest to a shape, and the tooltip where it was solved in the main window.
_OF_PATH = {
    "iterations": "",
    "seconds": tr(
        "Time spent in the main window, which drew the shapes and may have factored beforehand; "
        "not comparable with the other times"
    ),
}


def reading_columns(state: State, unit: Unit) -> list[ReadingColumn]:
    """Columns of the comparison table of a document, with lengths in ``unit``."""
    size = float(max(state.inspection.size))
    asked = number_format.format_exact(state.document.settings.area)
    energy = tr(
        "Deviation from rigidity: Eq. 1 of the paper for every method, each edge counted twice,"
        " whichever energy the method minimises"
    )
    return [
        ReadingColumn(
            tr("Area"),
            tr("Total area in percent of the rest area"),
            lambda x: f"{number_format.format_grouped(100.0 * x['area'] / x['area_rest'], 4)}\u00a0%",
            "area",
        ),
        ReadingColumn(
            trc("column", "Area error"),
            tr("Deviation of the area from its target of {percent} %").format(percent=asked),
            lambda x: _error(x["area_miss"]),
        ),
        *_region_columns(state),
        ReadingColumn(
            tr("Volume"),
            _about_volume(state),
            lambda x: _text_or_dash(
                x["volume"] / x["volume_rest"] - 1.0,
                lambda v: f"{number_format.format_signed(100.0 * v, 2)}\u00a0%",
            ),
            "volume",
        ),
        ReadingColumn(
            tr("Energy"),
            energy,
            lambda x: _text_or_dash(
                x["energy"], lambda v: unit.format_area(number_format.format_significant(v, 5))
            ),
        ),
        ReadingColumn(
            tr("Handle drift"),
            tr("Distance between the handle and the position you gave it"),
            lambda x: unit.format_length(number_format.format_length(x["handle_drift"], size)),
        ),
        ReadingColumn(
            tr("Local change"),
            tr("Largest area change of any triangle, up or down"),
            lambda x: f"{number_format.format_grouped(100.0 * x['local_change'], 2)}\u00a0%",
        ),
        ReadingColumn(
            trc("column", "Edge strain"),
            tr("Strain of the most stretched (+) or shortened (−) edge"),
            lambda x: f"{number_format.format_signed(100.0 * x['largest_edge_strain'], 2)}\u00a0%",
        ),
        ReadingColumn(
            tr("Mean strain"),
            tr("Mean absolute strain of the edges, weighted by rest area"),
            lambda x: f"{number_format.format_grouped(100.0 * x['mean_edge_strain'], 2)}\u00a0%",
        ),
        ReadingColumn(
            trc("column", "Iterations"),
            tr("Iterations from the rest shape to convergence"),
            lambda x: _text_or_dash(x["iterations"], lambda n: number_format.format_grouped(n, 0)),
            "iterations",
        ),
        ReadingColumn(
            tr("Time"),
            tr("Time for factoring and iterations on this computer"),
            lambda x: _text_or_dash(x["seconds"], lambda v: f"{number_format.format_grouped(v, 2)}\u00a0s"),
            "seconds",
        ),
    ]


def _region_columns(state: State) -> Iterator[ReadingColumn]:
    """Columns of the regions with a target for their area."""
    for k, region in enumerate(state.document.regions, 1):
        if region.area is None:
            continue
        asked, name = number_format.format_exact(region.area), region.name
        title = name if len(name) <= _LONGEST_NAME else f"{name[: _LONGEST_NAME - 1]}…"
        tip = tr("Area of {name} in percent of its rest area; its target is {percent} %")
        yield ReadingColumn(title, tip.format(name=name, percent=asked), partial(_region_area, f"region_{k}"))


def _region_area(name: str, readings: ReadingsByName) -> str:
    rest = readings.get(f"{name}_rest", math.nan)
    percent = 100.0 * readings[name] / rest if rest > 0.0 else math.nan
    return _text_or_dash(percent, lambda x: f"{number_format.format_grouped(x, 4)}\u00a0%")


def _about_volume(state: State) -> str:
    inspection = state.inspection
    if inspection.volume_capped is not None:
        return tr("Change of the volume from rest, with the openings capped flat")
    if why := inspection.missing_volume_phrase:
        return tr("There is no volume: {why}.").format(why=why)
    return tr("Change of the enclosed volume from rest")


def _text_or_dash(value: float, written: Callable[[float], str]) -> str:
    return "–" if math.isnan(value) else written(value)


def _error(value: float) -> str:
    if abs(value) >= _FINEST:
        return f"{number_format.format_signed(100.0 * value, 4)}\u00a0%"
    if abs(value) < _ROUNDING:
        return "0\u00a0%"
    mantissa, exponent = f"{abs(100.0 * value):.0e}".split("e")
    return f"{'+' if value > 0.0 else '−'}{mantissa}·10{number_format.superscript(int(exponent))}\u00a0%"


def write_outcomes(path: Path, state: State, outcomes: Sequence[tuple[str, MethodOutcome]]) -> None:
    """Write the measurements of each method as CSV; raises InputError."""
    rows = [
        (method, method_readings(state, method, outcome))
        for method, outcome in outcomes
        if outcome.frame is not None
    ]
    names = list(rows[0][1]) if rows else []
    write_table(path, ["method", *names], [[method, *found.values()] for method, found in rows])
