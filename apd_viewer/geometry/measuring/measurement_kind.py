"""Kinds of measurements."""

from __future__ import annotations

from enum import Enum

from apd_viewer.language import tr


class MeasurementKind(Enum):
    """A kind of measurement; its value is its name in files."""

    DISTANCE = "distance"
    ANGLE = "angle"
    GEODESIC = "geodesic"
    SECTION = "section"

    @property
    def title(self) -> str:
        """Title of the kind."""
        return _TITLES[self]

    @property
    def points(self) -> int:
        """Number of points of the surface that it is measured between."""
        return {MeasurementKind.ANGLE: 3, MeasurementKind.SECTION: 0}.get(self, 2)

    @property
    def powers(self) -> tuple[int, ...]:
        """Power of the unit of length of each of its values; 0 is an angle in radians."""
        return {MeasurementKind.ANGLE: (0,), MeasurementKind.SECTION: (1, 2)}.get(self, (1,))


_TITLES = {
    MeasurementKind.DISTANCE: tr("Distance"),
    MeasurementKind.ANGLE: tr("Angle"),
    MeasurementKind.GEODESIC: tr("Geodesic"),
    MeasurementKind.SECTION: tr("Section"),
}
