"""Measurements of a shape as text, for panel and report; no Qt."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from apd_viewer.geometry.analysis.hull_readings import compactness
from apd_viewer.geometry.pose.constraints import HANDLE
from apd_viewer.geometry.pose.frame import TARGET_ACCURACY, Frame
from apd_viewer.geometry.pose.waypoint_path import signed_angle
from apd_viewer.language import comma_separated, tr, trc
from apd_viewer.presentation.number_format import (
    format_grouped,
    format_length,
    format_short,
    format_short_signed,
    format_signed,
    format_significant,
)
from apd_viewer.session.model.document_parts import goal_percentages
from apd_viewer.session.model.status_text import caps_phrase

if TYPE_CHECKING:
    from apd_viewer.geometry.analysis.inspection import Inspection
    from apd_viewer.geometry.analysis.shape_check import ShapeCheck
    from apd_viewer.geometry.analysis.surface_distance import SurfaceDistance
    from apd_viewer.session.model.document import Document
    from apd_viewer.session.model.state import State
    from apd_viewer.session.quantities.units import Unit

NO_VALUE, PENDING = "–", "…"
DISTANCE_COLUMNS = (tr("Largest"), "largest"), (tr("RMS"), "rms"), (tr("Mean"), "mean")
_ALIGNED = math.cos(math.radians(1.0))  # cosine of the angle tolerance between a rotation and a twist axis
_KEPT = 1e-6  # tolerance of a region's target, in percent of its rest area


def area_percent(state: State) -> str:
    """Area in percent of the rest area."""
    return f"{format_grouped(100 * (1 + state.frame.area_error), 3)} %"


def area(state: State, unit: Unit) -> str:
    """Text of the current area and the rest area."""
    return _now_and_rest(state.frame.area, state.inspection.area, unit, 2)


def _now_and_rest(now: float, rest: float, unit: Unit, power: int) -> str:
    """Current and rest area or volume, in one unit suited to both."""
    larger, factor = unit.legible_unit(max(now, rest, key=abs), power)
    text = tr("{now} of {rest}").format(
        now=format_significant(factor * now), rest=format_significant(factor * rest)
    )
    return larger.format_area(text) if power == 2 else larger.format_volume(text)


def area_verdict(state: State) -> str:
    """Text of the change of the total area, compared with its target."""
    document, change = state.document, format_signed(100 * state.frame.area_error, 3)
    asked = goal_percentages(document)[0]
    if asked is None:
        return f"{change} %"
    wanted = asked / 100.0
    miss = abs(1.0 + state.frame.area_error - wanted)
    if document.settings.traits.has_tolerance:
        near, tolerance = (
            miss <= document.settings.tolerance * wanted,
            format_short(100 * document.settings.tolerance),
        )
        if asked == 100.0:
            said = tr("{change} %, within {tolerance} %") if near else tr("{change} %, outside {tolerance} %")
        elif near:
            said = tr("{change} %, within {tolerance} % of {asked} %")
        else:
            said = tr("{change} %, outside {tolerance} % of {asked} %")
        return said.format(change=change, tolerance=tolerance, asked=format_short(asked))
    if miss > TARGET_ACCURACY * wanted:
        return tr("{change} %, target {asked} %").format(
            change=change, asked=format_signed(asked - 100.0, 3, brief=True)
        )
    return (
        tr("{change} %, exact").format(change=change)
        if asked == 100.0
        else tr("{change} %, exactly on target").format(change=change)
    )


def distances(found: SurfaceDistance | None, unit: Unit, size: float) -> tuple[str, ...]:
    """Texts of the largest, RMS and mean distance; dashes if unknown."""
    if found is None:
        return (NO_VALUE,) * len(DISTANCE_COLUMNS)
    return tuple(
        unit.format_length(format_length(getattr(found, name), size)) for _, name in DISTANCE_COLUMNS
    )


def local_change(state: State) -> str:
    """Text of the largest local area change."""
    return f"{format_short(100 * _rounded(state.frame.local_change))} %"


def largest_edge_strain(state: State) -> str:
    """Text of the strain of the most stretched or shortened edge, with its sign."""
    return f"{format_short_signed(100 * _rounded(state.frame.largest_edge_strain))} %"


def mean_edge_strain(state: State) -> str:
    """Text of the mean absolute strain of the edges."""
    return f"{format_short(100 * _rounded(state.frame.mean_edge_strain))} %"


def _rounded(change: float) -> float:
    return change if abs(change) > TARGET_ACCURACY else 0.0


class VolumeReadingText(NamedTuple):
    """Texts about the volume: change, values or the reason for none, and remarks."""

    change: str
    volumes: str
    remarks: tuple[str, ...] = ()


def volumes(frame: Frame, rest: Inspection) -> tuple[float | None, float | None]:
    """Current and rest volume, with openings capped; None if unknown."""
    if rest.volume_capped is None:
        return frame.volume, rest.volume
    return frame.volume_capped, rest.volume_capped


def volume(state: State, unit: Unit) -> VolumeReadingText:
    """Texts about the volume; openings of an open surface are capped."""
    inspection, capped = state.inspection, state.inspection.volume_capped is not None
    now, rest = volumes(state.frame, inspection)
    if not rest or now is None:
        why = inspection.missing_volume_phrase
        return VolumeReadingText(
            trc("volume", "none"), tr("{reason}.").format(reason=why[0].upper() + why[1:])
        )
    change = format_signed(100 * (now / rest - 1), 2)
    said = tr("unchanged") if change == format_signed(0.0, 2) else f"{change} %"
    lines = [caps_phrase(inspection.openings)] if capped else []  # always mention capped openings
    litres, at_rest = unit.to_litres(now), unit.to_litres(rest)
    if litres is not None and at_rest is not None:
        symbol, factor = unit.capacity_unit(at_rest)
        now_, rest_ = format_significant(factor * litres, 4), format_significant(factor * at_rest, 4)
        lines.insert(0, tr("{now} of {rest}").format(now=now_, rest=rest_) + f"\u00a0{symbol}")
    return VolumeReadingText(
        tr("{change}, capped").format(change=said) if capped else said,
        _now_and_rest(now, rest, unit, 3),
        tuple(lines),
    )


class ContactReadingText(NamedTuple):
    """Texts about contact: pairs, smallest gap and fraction of the path reached."""

    pairs: str
    least_gap: str
    path_fraction: str


def contact(state: State, unit: Unit) -> ContactReadingText:
    """Texts about self-contact of the shape; an ellipsis while unknown."""
    touch = state.frame.contact
    path_fraction = NO_VALUE if state.is_at_rest else f"{math.floor(100.0 * state.frame.share_reached)} %"
    if touch is None and not state.is_at_rest:
        return ContactReadingText(PENDING, PENDING, PENDING)
    if touch is None or touch.least_gap is None:
        return ContactReadingText(trc("pairs in contact", "none"), NO_VALUE, path_fraction)
    gap = unit.format_length(format_length(touch.least_gap, max(state.inspection.size)))
    return ContactReadingText(format_grouped(touch.pairs, 0), gap, path_fraction)


def compactness_text(state: State) -> tuple[str, str]:
    """Text of the compactness of a closed shape, and its change."""
    rest, now = state.inspection, state.frame
    if not rest.volume or now.volume is None or not now.area > 0.0:
        return NO_VALUE, ""
    value = compactness(now.volume, now.area)
    return format_grouped(value, 3), change_percent(value, compactness(rest.volume, rest.area))


def extent(found: ShapeCheck | None, unit: Unit) -> str:
    """Text of the side lengths of the axis-aligned bounding box."""
    if found is None or math.isnan(found.packed_box):
        return PENDING if found is None else NO_VALUE
    return unit.format_length(" × ".join(format_short(side) for side in found.size))


def box_volume(volume: float | None, rest_volume: float | None, unit: Unit) -> tuple[str, str]:
    """Volume of a bounding box and its change; an ellipsis if not measured yet."""
    if volume is None:
        return PENDING, ""
    larger, factor = unit.legible_unit(volume, 3)
    written = NO_VALUE if math.isnan(volume) else larger.format_volume(format_significant(factor * volume, 4))
    return written, "" if rest_volume is None else change_percent(volume, rest_volume)


def rest_percent(now: float, rest: float) -> str:
    """Value in percent of that at rest."""
    return percent_text(100.0 * now / rest)


def percent_text(percent: float) -> str:
    """Text of a percentage of a value at rest."""
    return f"{format_grouped(percent, 1)} %"


def change_percent(now: float, rest: float) -> str:
    """Change from rest in percent; empty if unknown."""
    if not rest > 0.0 or math.isnan(now):
        return ""
    return f"{format_signed(100.0 * (now / rest - 1.0), 1)} %"


def material_volume(state: State) -> float | None:
    """Volume of the material of a double wall, cubic mesh units; else None."""
    wall = state.inspection.double_wall
    return None if wall is None else wall.material


def double_wall(state: State, unit: Unit) -> str:
    """Text about material and capacity of a double wall; empty if there is none."""
    wall = state.inspection.double_wall
    if wall is None:
        return ""
    said = tr("Double wall: {material} of material (thickness ignored); holds {capacity} at rest")
    return said.format(material=_capacity(wall.material, unit), capacity=_capacity(wall.capacity, unit))


def _capacity(volume: float, unit: Unit) -> str:
    litres = unit.to_litres(volume)
    if litres is None:
        return format_significant(volume, 4)
    symbol, factor = unit.capacity_unit(litres)
    return f"{format_significant(factor * litres, 4)}\u00a0{symbol}"


def mass(grams: float | None, unit: Unit) -> str:
    """Text of a mass in a suitable unit."""
    if grams is None:
        return NO_VALUE
    symbol, factor = unit.mass_unit(grams)
    return f"{format_significant(grams * factor, 4)}\u00a0{symbol}"


def drift(state: State, unit: Unit) -> str:
    """Text of the handle drift."""
    if not state.document.label_counts[HANDLE:].any():
        return NO_VALUE
    return unit.format_length(format_length(state.frame.handle_drift, max(state.inspection.size)))


def motion(state: State, k: int, unit: Unit) -> str:
    """Displacement, rotation and scale of a handle from rest, if not trivial.

    Both the requested and the reached motion while contact delays the handle.
    """
    document, frame = state.document, state.frame
    if not document.label_counts[HANDLE + k]:
        return tr("Paint it with Paint handle")
    size, reached = float(max(state.inspection.size)), None
    asked = _amounts(document, k, unit, size)
    if frame.share_reached < 1.0:
        # Imported here because it loads SciPy.
        from apd_viewer.session.posing.initial_positions import reached_handle

        reached = _amounts(document.with_handle(k, reached_handle(document, k, frame)), k, unit, size)
    said = tr("twisted {angle}°") if asked.twists else tr("rotated {angle}°")
    parts = (
        (
            tr("moved {length}").format(length=asked.displacement),
            asked.displacement,
            unit.format_length("0"),
            reached and reached.displacement,
        ),
        (
            said.format(angle=asked.angle[:-1]),
            asked.angle,
            f"{format_signed(0.0, 1)}°",
            reached and reached.angle,
        ),
        (
            tr("scaled by {factors}").format(factors=asked.scale),
            asked.scale,
            format_grouped(1.0, 2),
            reached and reached.scale,
        ),
    )
    still = state.is_handle_moved(k) and not document.relative_to_rest.handles[k].is_moved
    unmoved = tr("not moved since it was painted") if still else tr("at rest")
    return comma_separated(text for part in parts if (text := _requested_and_reached(*part))) or unmoved


def _requested_and_reached(names: str, requested: str, none: str, reached: str | None) -> str:
    """Text of one component of a motion; empty if zero."""
    if reached in (None, requested):
        return names if requested != none else ""
    return tr("{motion}, reached {amount}").format(motion=names, amount=reached)


class _Amounts(NamedTuple):
    """Texts of the amounts of a motion, and a flag for a twist."""

    displacement: str
    angle: str
    scale: str
    twists: bool


def _amounts(document: Document, k: int, unit: Unit, size: float) -> _Amounts:
    document = document.relative_to_rest
    handle, centre = document.handles[k], document.centre(k)
    assert centre is not None
    now = handle.pose[:3, :3] @ centre + handle.pose[:3, 3]
    way = unit.format_length(format_length(float(np.linalg.norm(now - centre)), size))
    scale = format_grouped(float(np.cbrt(np.linalg.det(handle.pose[:3, :3]))), 2)
    angle, twists = _rotation(document, k, now)
    return _Amounts(way, f"{angle}°", scale, twists)


def _rotation(document: Document, k: int, centre: np.ndarray) -> tuple[str, bool]:
    """Total rotation in degrees, and a flag for a twist.

    A twist has the sign as typed, about the line from the base to the handle.
    """
    handle = document.handles[k]
    rotation, lines = handle.rotation, [] if handle.former_twist_axis is None else [handle.former_twist_axis]
    if document.base_centre is not None:
        lines.append(centre - document.base_centre)
    for axis in lines:
        along = float(rotation @ axis)
        if abs(along) > _ALIGNED * float(np.linalg.norm(rotation) * np.linalg.norm(axis)):
            return format_signed(math.degrees(math.copysign(float(np.linalg.norm(rotation)), along)), 1), True
    return format_signed(math.degrees(signed_angle(rotation)), 1), False


def regions(state: State, unit: Unit) -> list[tuple[str, str]]:
    """Text of each region's area, in percent of its rest area and square units."""
    document, said = state.document, []
    rest, targets = document.rest_areas, [region.area for region in document.regions]
    for at_rest, now, target in zip(rest, state.frame.regions, targets, strict=False):
        part = f"{format_grouped(100 * now / at_rest, 2)} %" if at_rest > 0.0 else tr("empty")
        kept = at_rest > 0.0 and target is not None and abs(100 * now / at_rest - target) <= _KEPT
        if kept and not document.settings.traits.keeps_only_total_area:
            part = tr("{area}, kept").format(area=part)
        said.append((part, _now_and_rest(now, at_rest, unit, 2)))
    return said
