"""Words of the kinds of measurements."""

from __future__ import annotations

from typing import NamedTuple

from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.language import tr


class KindWords(NamedTuple):
    """Title in a menu, icon, tip, and hint for the status line."""

    title: str
    icon: str
    tip: str
    hint: str


KIND_WORDS = {
    MeasurementKind.DISTANCE: KindWords(
        tr("&Distance"),
        "measure-distance",
        tr("Measure the straight distance between two points"),
        tr("Measure distance: click two points on the mesh; Esc cancels"),
    ),
    MeasurementKind.ANGLE: KindWords(
        tr("&Angle"),
        "measure-angle",
        tr("Measure the angle of three points, at the second one"),
        tr("Measure angle: click three points on the mesh, the vertex second; Esc cancels"),
    ),
    MeasurementKind.GEODESIC: KindWords(
        tr("&Geodesic"),
        "measure-geodesic",
        tr("Measure the shortest path over the surface between two points"),
        tr("Measure geodesic: click two points on the mesh; Esc cancels"),
    ),
    MeasurementKind.SECTION: KindWords(
        tr("&Section"),
        "measure-section",
        tr("Measure the contour in which a plane cuts the mesh, and the area in it"),
        tr("Measure section: click where the plane cuts the mesh, wheel changes the axis, Ctrl+wheel zooms"),
    ),
}
