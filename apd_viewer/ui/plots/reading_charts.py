"""Charts of readings along a gesture and of the current shape."""

import numpy as np

from apd_viewer.geometry.analysis.area_change import LocalChange
from apd_viewer.geometry.pose.frame import TARGET_ACCURACY
from apd_viewer.language import tr
from apd_viewer.presentation import number_format
from apd_viewer.presentation.axis import (
    Axis,
    decade_axis,
    linear_axis,
    power_of_ten,
    ratio_axis,
    rounded_axis,
)
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import goal_percentages
from apd_viewer.session.model.state import State
from apd_viewer.session.model.trace import Trace
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.plots.chart_drawing import Bars, Chart, Curve, ReferenceLine

_ROUNDING = 1e-15  # a smaller area error is only rounding
_DEEPEST = 1e-4
_ROUGHLY = 1e-2  # stands in for the tolerance if the area has no target
_BINS = 41  # odd, so that one bin is centred at no change
# Candidate ends of a histogram axis, as area ratios.
_REACHES = (1.001, 1.002, 1.005, 1.01, 1.02, 1.05, 1.1, 1.2, 1.5, 2.0, 4.0, 16.0, 256.0, 1024.0)
_SMALLEST = 0.02  # %: smallest range of the axis for area and volume, so tiny changes look tiny


def area_error(state: State | None, trace: Trace) -> Chart:
    """Chart of the area error by iteration, against the tolerance."""
    title = tr("Area error by iteration")
    if state is None or len(trace) < 2:
        return Chart(title, empty_text=tr("Move a handle to see the area error here."))
    limit, name = _area_tolerance(state.document)
    # Clip errors far below the tolerance; their size is irrelevant to the reader.
    miss = np.maximum(trace["area_miss"], _DEEPEST * (limit or _ROUGHLY))
    reached = [float(miss.min()), float(miss.max()), *([limit] if limit else [])]
    now = float(trace["area_miss"][-1])
    text = tr("{error} %").format(error=_percent(now))
    across = (ReferenceLine(float(np.log10(limit)), color="warm"),) if limit else ()
    return Chart(
        title,
        ((text, "ink"), *(((name, "warm"),) if limit else ())),
        linear_axis(0.0, float(trace["iteration"][-1]), whole=True),
        decade_axis(min(reached), max(reached)),
        (Curve(trace["iteration"], np.log10(miss)),),
        horizontal_lines=across,
    )


def _area_tolerance(document: Document) -> tuple[float | None, str]:
    """Area tolerance and its label; None if the area is free."""
    if goal_percentages(document)[0] is None:
        return None, ""
    if document.settings.traits.has_tolerance:
        limit = document.settings.tolerance
        return limit, tr("tolerance {percent} %").format(percent=number_format.format_short(100.0 * limit))
    return TARGET_ACCURACY, tr("exact: {percent} %").format(percent=power_of_ten(-7))


def energy(trace: Trace, unit: Unit) -> Chart:
    """Chart of the energy along the gesture."""
    title = tr("Energy along the gesture")
    E = trace["energy"]
    known = E[np.isfinite(E)]
    if len(trace) < 2 or len(known) == 0:
        return Chart(title, empty_text=tr("Move a handle to see the energy here."))
    last = (
        unit.format_area(number_format.format_significant(float(E[-1]), 5))
        if np.isfinite(E[-1])
        else tr("available when the preview ends")
    )
    axis = rounded_axis(0.0, float(known.max()))
    return Chart(
        title,
        ((last, "ink"),),
        _seconds(trace),
        axis,
        (Curve(trace["seconds"], E),),
        vertical_lines=_release_lines(trace),
    )


def area_and_volume(state: State | None, trace: Trace) -> Chart:
    """Chart of area and volume changes from rest along the gesture."""
    title = tr("Area and volume along the gesture")
    if state is None or len(trace) < 2:
        return Chart(title, empty_text=tr("Move a handle to see area and volume here."))
    area, rest = 100.0 * trace["area_error"], state.inspection.volume
    volume = 100.0 * (trace["volume"] / rest - 1.0) if rest else np.full(len(area), np.nan)
    texts = [(tr("area {change} %").format(change=number_format.format_signed(float(area[-1]), 3)), "accent")]
    if np.isfinite(volume[-1]):
        texts.append(
            (tr("volume {change} %").format(change=number_format.format_signed(float(volume[-1]), 2)), "warm")
        )
    both = np.concatenate([area, volume[np.isfinite(volume)]])
    y = rounded_axis(min(float(both.min()), -_SMALLEST), max(float(both.max()), _SMALLEST), " %")
    curves = Curve(trace["seconds"], volume, "warm"), Curve(trace["seconds"], area, "accent")
    return Chart(title, tuple(texts), _seconds(trace), y, curves, vertical_lines=_release_lines(trace))


def local_change(change: LocalChange | None, empty: str = "") -> Chart:
    """Histogram of the surface by local area change."""
    title = tr("Local area change")
    if change is None:
        return Chart(title, empty_text=empty)
    reach = next((r for r in _REACHES if r - 1.0 >= 1.25 * change.p99), _REACHES[-1])
    x = ratio_axis(reach)
    edges = np.linspace(x.low, x.high, _BINS + 1)
    # The outermost bins include all values beyond the axis.
    fractions = 100.0 * change.surface_fractions(np.concatenate([[-np.inf], edges[1:-1], [np.inf]]))
    texts = (
        (tr("mean {percent} %").format(percent=_percent(change.mean)), "ink"),
        (tr("99th {percent} %").format(percent=_percent(change.p99)), "quiet"),
        (tr("max {percent} %").format(percent=_percent(change.largest)), "quiet"),
    )
    y = rounded_axis(0.0, float(fractions.max()), " %")
    return Chart(title, texts, x, y, bars=Bars(edges, fractions))


def _seconds(trace: Trace) -> Axis:
    return linear_axis(0.0, float(trace["seconds"][-1]), tr(" s"))


def _release_lines(trace: Trace) -> tuple[ReferenceLine, ...]:
    """Reference line at the end of the drag; after it the solver only converges."""
    moment, last = trace.released_at, float(trace["seconds"][-1])
    return (ReferenceLine(moment, tr("released")),) if moment is not None and moment < last else ()


def _percent(fraction: float) -> str:
    """Fraction as percent text with three digits; rounding errors appear as 0."""
    percent = 100.0 * fraction
    if percent < 100.0 * _ROUNDING:
        return "0"
    if percent < 1e-3:
        exponent = int(np.floor(np.log10(percent)))
        return (
            f"{number_format.format_grouped(percent / 10.0**exponent, 1)}·{power_of_ten(exponent)}"
            if exponent < -3
            else number_format.format_exact(percent, 1)
        )
    return number_format.format_short(percent)
