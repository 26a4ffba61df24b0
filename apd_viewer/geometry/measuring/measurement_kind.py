"""Kinds of measurements."""

from enum import Enum

from apd_viewer.language import tr


class MeasurementKind(Enum):
    """Kind of measurement; the value is its name in files."""

    DISTANCE = "distance"
    ANGLE = "angle"
    GEODESIC = "geodesic"
    SECTION = "section"
    FILL_LEVEL = "level"

    @property
    def title(self) -> str:
        """Displayed title of the kind of measurement."""
        return _TITLES[self]

    @property
    def points(self) -> int:
        """Number of surface points needed for the measurement."""
        return {MeasurementKind.DISTANCE: 2, MeasurementKind.GEODESIC: 2, MeasurementKind.ANGLE: 3}.get(
            self, 0
        )

    @property
    def fields(self) -> dict[str, int]:
        """Names of the values in files with their :attr:`powers`."""
        return _FIELDS.get(self, {"length": 1})

    @property
    def powers(self) -> tuple[int, ...]:
        """Power of the unit of length of each value; 0 for an angle in radians."""
        return tuple(self.fields.values())


_TITLES = {
    MeasurementKind.DISTANCE: tr("Distance"),
    MeasurementKind.ANGLE: tr("Angle"),
    MeasurementKind.GEODESIC: tr("Geodesic"),
    MeasurementKind.SECTION: tr("Section"),
    MeasurementKind.FILL_LEVEL: tr("Fill level"),
}
_FIELDS = {
    MeasurementKind.ANGLE: {"angle": 0},
    MeasurementKind.SECTION: {"length": 1, "area": 2, "volume_below": 3},
    MeasurementKind.FILL_LEVEL: {"level": 1, "freeboard": 1, "spilled": 3},
}
