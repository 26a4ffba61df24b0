"""Kinds of measurements."""

from enum import Enum

from apd_viewer.language import tr


class MeasurementKind(Enum):
    """Kind of measurement; the value is its name in files."""

    DISTANCE = "distance"
    ANGLE = "angle"
    GEODESIC = "geodesic"
    SECTION = "section"

    @property
    def title(self) -> str:
        """Displayed title of the kind of measurement."""
        return _TITLES[self]

    @property
    def points(self) -> int:
        """Number of surface points needed for the measurement."""
        return {MeasurementKind.ANGLE: 3, MeasurementKind.SECTION: 0}.get(self, 2)

    @property
    def powers(self) -> tuple[int, ...]:
        """Power of the unit of length of each value; 0 for an angle in radians."""
        return {MeasurementKind.ANGLE: (0,), MeasurementKind.SECTION: (1, 2, 3)}.get(self, (1,))


_TITLES = {
    MeasurementKind.DISTANCE: tr("Distance"),
    MeasurementKind.ANGLE: tr("Angle"),
    MeasurementKind.GEODESIC: tr("Geodesic"),
    MeasurementKind.SECTION: tr("Section"),
}
