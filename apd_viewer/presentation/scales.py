"""Measures displayed as colours on a shape, and their colour scales."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum
from functools import cache
from typing import NamedTuple

import numpy as np

from apd_viewer.geometry.analysis.deviation import Deviation
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.frame import TARGET_ACCURACY
from apd_viewer.language import tr
from apd_viewer.presentation.color_maps import DIVERGING, SEQUENTIAL, ColorMap
from apd_viewer.presentation.number_format import format_short, format_short_signed, round_step
from apd_viewer.session.quantities.units import Unit

_NOTHING = 5e-5  # fraction of the scale displayed as zero
_ROUNDING = 1e-9  # values below this fraction of the default scale are rounding errors
_MOST_GAINED = 10.0  # largest gain on a scale, since a vanished area gives an infinite ratio


class ScaleKind(Enum):
    """Kind of a measured value: log ratio, fraction, length or curvature."""

    RATIO = "ratio"
    SHARE = "share"
    LENGTH = "length"
    CURVATURE = "curvature"

    @property
    def factor(self) -> float:
        """Factor from a value to its displayed number."""
        return 100.0 if self in (ScaleKind.RATIO, ScaleKind.SHARE) else 1.0

    def suffix(self, unit: Unit) -> str:
        """Unit suffix of a displayed number."""
        if self in (ScaleKind.RATIO, ScaleKind.SHARE):
            return "\u00a0%"
        return unit.format_curvature("") if self is ScaleKind.CURVATURE else unit.format_length("")


class MeasureTraits(NamedTuple):
    """Title, tooltip and computation of a measure.

    ``values(deviation, U, is_cancelled)`` gives the values (n,) at the vertices of a shape ``U`` (n, 3); None
    if ``is_cancelled()`` has ended a slow measure. The ``note`` is written below the colours, or
    ``missing_note`` if no vertex has a value.
    """

    title: str
    tip: str
    key: str
    kind: ScaleKind
    values: Callable[[Deviation, np.ndarray, Callable[[], bool]], np.ndarray | None]
    note: str = ""
    missing_note: str = ""

    def note_for(self, values: np.ndarray | None) -> str:
        """Note below the colour scale for values (n,)."""
        return (
            self.missing_note
            if self.missing_note and values is not None and np.isnan(values).all()
            else self.note
        )


class Measure(Enum):
    """Measure displayed as colours on a shape."""

    AREA = "area"
    STRAIN = "strain"
    BENDING = "bending"
    DISPLACEMENT = "displacement"
    DISTANCE = "distance"
    TARGET_DISTANCE = "target_distance"
    TARGET_DISPLACEMENT = "target_displacement"
    CALMNESS = "calmness"
    CONTACT = "contact"
    WRINKLING = "wrinkling"
    THICKNESS = "thickness"

    @property
    def traits(self) -> MeasureTraits:
        """Title, tooltip and computation of the measure."""
        return _measure_traits()[self]

    @property
    def is_signed(self) -> bool:
        """True if values have a sign."""
        return self.traits.kind in (ScaleKind.RATIO, ScaleKind.CURVATURE)

    @property
    def colors(self) -> ColorMap:
        """Colour map of the measure."""
        return DIVERGING if self.is_signed else SEQUENTIAL

    @property
    def follows_shape(self) -> bool:
        """True if the values depend on the shape, not only on labels or the wall."""
        return self not in (Measure.CALMNESS, Measure.THICKNESS)

    @property
    def follows_document(self) -> bool:
        """True if the values depend on painted labels, settings or the wall."""
        return self in (Measure.CALMNESS, Measure.CONTACT, Measure.THICKNESS)

    @property
    def waits_for_convergence(self) -> bool:
        """True if measured only once the shape has stopped moving."""
        return self in (Measure.DISTANCE, Measure.TARGET_DISTANCE, Measure.CALMNESS)

    @property
    def is_delayed(self) -> bool:
        """True if measured on a thread, lagging behind a moving shape."""
        return self is Measure.CONTACT


def measures_of(
    mesh: Mesh, target: TargetShape | None, thickness: np.ndarray | None = None
) -> tuple[Measure, ...]:
    """Measures available for a mesh, its target shape, and thickness at vertices."""
    missing: tuple[Measure, ...] = ()
    has_thickness = thickness is not None and len(thickness) == len(mesh.V)
    if target is None:
        missing = Measure.TARGET_DISTANCE, Measure.TARGET_DISPLACEMENT
    elif not target.has_same_triangles(mesh):
        missing = (Measure.TARGET_DISPLACEMENT,)
    missing += () if has_thickness else (Measure.THICKNESS,)
    return tuple(measure for measure in Measure if measure not in missing)


@cache
def _measure_traits() -> dict[Measure, MeasureTraits]:
    return {
        Measure.AREA: MeasureTraits(
            tr("Local area change"),
            tr("Colour by local area change: the most changed triangle at each vertex, compared with rest"),
            "Alt+1",
            ScaleKind.RATIO,
            lambda deviation, U, _: deviation.area_change(U),
        ),
        Measure.STRAIN: MeasureTraits(
            tr("Edge strain"),
            tr("Colour by edge strain: the largest stretch or shortening of the edges at each vertex"),
            "Alt+2",
            ScaleKind.RATIO,
            lambda deviation, U, _: deviation.edge_strain(U),
        ),
        Measure.BENDING: MeasureTraits(
            tr("Bending"),
            tr("Colour by change of mean curvature from rest: more convex or more concave"),
            "Alt+3",
            ScaleKind.CURVATURE,
            lambda deviation, U, _: deviation.bending(U),
        ),
        Measure.DISPLACEMENT: MeasureTraits(
            tr("Displacement"),
            tr("Colour by the distance of each vertex from its rest position"),
            "Alt+4",
            ScaleKind.LENGTH,
            lambda deviation, U, _: deviation.displacement(U),
        ),
        Measure.DISTANCE: MeasureTraits(
            tr("Distance to rest"),
            tr("Colour by the distance from the rest surface, measured when the shape has converged"),
            "Alt+5",
            ScaleKind.LENGTH,
            lambda deviation, U, is_cancelled: deviation.rest_distance(U, is_cancelled),
        ),
        Measure.TARGET_DISTANCE: MeasureTraits(
            tr("Target: closest point"),
            tr("Colour by the distance from the closest point of the target shape, when converged"),
            "Alt+6",
            ScaleKind.LENGTH,
            lambda deviation, U, is_cancelled: deviation.target_distance(U, is_cancelled),
        ),
        Measure.TARGET_DISPLACEMENT: MeasureTraits(
            tr("Target: same vertex"),
            tr("Colour by the distance of each vertex from the same vertex of the target shape"),
            "Alt+7",
            ScaleKind.LENGTH,
            lambda deviation, U, _: deviation.target_displacement(U),
        ),
        Measure.CALMNESS: MeasureTraits(
            tr("Calmness"),
            tr("Colour by calmness: how little of the gesture reaches each vertex, given the paint"),
            "Alt+8",
            ScaleKind.SHARE,
            lambda deviation, *_: deviation.calmness(),
        ),
        Measure.CONTACT: MeasureTraits(
            tr("Contact pressure"),
            tr(
                "Colour by contact pressure: force per area in percent of the largest; grey where contact "
                "keeps nothing apart"
            ),
            "Alt+9",
            ScaleKind.SHARE,
            lambda deviation, U, _: deviation.contact_pressure(U),
            tr("In percent of the largest pressure."),
            tr("Nothing is kept apart: turn on Contact in the section Method."),
        ),
        Measure.WRINKLING: MeasureTraits(
            tr("Wrinkling"),
            tr("Colour by wrinkling: by how much the wall is shortened at each vertex, across its folds"),
            "",
            ScaleKind.SHARE,
            lambda deviation, U, _: deviation.wrinkling(U),
        ),
        Measure.THICKNESS: MeasureTraits(
            tr("Wall thickness"),
            tr("Colour by wall thickness, of a wall distribution: see the section Size and mass"),
            "",
            ScaleKind.LENGTH,
            lambda deviation, *_: deviation.thickness,
        ),
    }


@dataclass(frozen=True)
class Scale:
    """Colour scale of a measure.

    Attributes
    ----------
    reach : float
        End of the scale: for ratios the relative gain, 0.1 for 10 %, with the inverse ratio at the other end;
        otherwise a length or a curvature, in mesh units.
    neutral : float
        Largest change displayed as none, in the same form; 0 for values without a sign. At most half of the
        reach, so that no negligible change lies near the ends, where the colours are strongest.
    """

    measure: Measure
    reach: float
    neutral: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "neutral", min(self.neutral, 0.5 * self.reach))

    @property
    def end(self) -> float:
        """Upper end of the scale in units of the measure."""
        return self._to_measure_unit(self.reach)

    @property
    def tick_values(self) -> tuple[float, ...]:
        """Labelled values of the scale: its ends, and zero."""
        return (-self.end, 0.0, self.end) if self.measure.is_signed else (0.0, self.end)

    @property
    def fits_any_size(self) -> bool:
        """True if the scale does not depend on the size of the mesh."""
        return self.measure.traits.kind in (ScaleKind.RATIO, ScaleKind.SHARE)

    def fitted_to(self, span: tuple[float, float], size: float = 1.0) -> Scale:
        """Scale fitted to the largest absolute value of a span.

        A span of rounding errors on a mesh of this ``size`` leaves the scale unchanged.
        """
        reach = max(map(abs, span))
        if self.measure.traits.kind is ScaleKind.RATIO:
            reach = min(math.expm1(min(reach, _MOST_GAINED)), _MOST_GAINED)
        if reach <= _ROUNDING * default_scale(self.measure, size).reach:
            return self
        return replace(self, reach=round_step(reach))

    @property
    def neutral_fraction(self) -> float:
        """Neutral fraction of the scale around its middle, 0 to 1."""
        return self._to_measure_unit(self.neutral) / self.end

    def position(self, value: float) -> float:
        """Position of a value on the scale, from 0 to 1."""
        fraction = min(max(value / self.end, -1.0), 1.0)
        return 0.5 + 0.5 * fraction if self.measure.is_signed else max(fraction, 0.0)

    def colors(self, positions: np.ndarray) -> np.ndarray:
        """RGB (k, 3) uint8 at ``positions`` (k,) of the scale, 0 to 1."""
        if self.measure.is_signed:
            positions = np.where(np.abs(positions - 0.5) < 0.5 * self.neutral_fraction, 0.5, positions)
        return self.measure.colors.colors(positions)

    def displayed_changes(self, values: np.ndarray) -> np.ndarray:
        """Changes as displayed: log ratios as relative changes, other values unchanged."""
        return np.expm1(values) if self.measure.traits.kind is ScaleKind.RATIO else values

    def largest_change(self, span: tuple[float, float]) -> float:
        """End of a span with the larger displayed change."""
        return span[int(np.abs(self.displayed_changes(np.array(span))).argmax())]

    def format_value(self, value: float, unit: Unit) -> str:
        """Text of a value with its unit."""
        if math.isnan(value):
            return tr("no value")
        kind = self.measure.traits.kind
        if abs(value) < (TARGET_ACCURACY if kind is ScaleKind.RATIO else _NOTHING * self.end):
            value = 0.0
        if kind is ScaleKind.RATIO:
            return f"{format_short_signed(100.0 * math.expm1(value))}\u00a0%"
        if kind is ScaleKind.SHARE:
            return f"{format_short(100.0 * value)}\u00a0%"
        if kind is ScaleKind.CURVATURE:
            return unit.format_curvature(format_short_signed(value))
        return unit.format_length(format_short(value))

    def _to_measure_unit(self, value: float) -> float:
        return math.log1p(value) if self.measure.traits.kind is ScaleKind.RATIO else value


def default_scale(measure: Measure, size: float) -> Scale:
    """Default scale of a measure for a mesh of extent ``size``."""
    if measure.traits.kind is ScaleKind.RATIO:
        return Scale(measure, 0.1, 0.001)
    if measure.traits.kind is ScaleKind.SHARE:
        return Scale(measure, 0.1 if measure is Measure.WRINKLING else 1.0)
    if measure.traits.kind is ScaleKind.CURVATURE:
        return Scale(measure, round_step(8.0 / size), round_step(0.08 / size))
    return Scale(measure, round_step((0.25 if measure is Measure.DISPLACEMENT else 0.1) * size))


def span_of(values: np.ndarray | None) -> tuple[float, float] | None:
    """Minimum and maximum of values (n,), ignoring NaN; None if there is none."""
    if values is None or np.isnan(values).all():
        return None
    return float(np.fmin.reduce(values)), float(np.fmax.reduce(values))
