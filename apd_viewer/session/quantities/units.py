"""Units of length, and measurements written in them."""

from __future__ import annotations

from enum import Enum

from apd_viewer.language import tr

# No-break space: a number is not separated from its unit.
_GAP = "\u00a0"
_DECIMETRES = {"mm": 0.01, "cm": 0.1, "m": 10.0}
_LEGIBLE = 1e6  # from here on another unit is easier to read
_POWERS = {-1: "⁻¹", 1: "", 2: "²", 3: "³"}


class Unit(Enum):
    """A unit of length; its value is its symbol."""

    NONE = ""
    MILLIMETRE = "mm"
    CENTIMETRE = "cm"
    METRE = "m"

    @property
    def title(self) -> str:
        """The name on a button."""
        return self.value or tr("no unit")

    def length(self, number: str) -> str:
        """A length: the number, as it is written, with its unit."""
        return self._written(number, 1)

    def area(self, number: str) -> str:
        """An area: the number, as it is written, with its unit."""
        return self._written(number, 2)

    def volume(self, number: str) -> str:
        """A volume: the number, as it is written, with its unit."""
        return self._written(number, 3)

    def curvature(self, number: str) -> str:
        """A curvature: the number, as it is written, over the unit of length."""
        return self._written(number, -1)

    def legible(self, value: float, power: int) -> tuple[Unit, float]:
        """The unit in which an area or a volume is legible, and the factor into it."""
        unit, factor = self, 1.0
        while abs(factor * value) >= _LEGIBLE and unit in (Unit.MILLIMETRE, Unit.CENTIMETRE):
            larger = Unit.CENTIMETRE if unit is Unit.MILLIMETRE else Unit.METRE
            factor *= (_DECIMETRES[unit.value] / _DECIMETRES[larger.value]) ** power
            unit = larger
        return unit, factor

    def litres(self, volume: float) -> float | None:
        """A volume in cubic mesh units as litres; None without a unit."""
        side = _DECIMETRES.get(self.value)
        return None if side is None else volume * side**3

    def _written(self, number: str, power: int) -> str:
        return f"{number}{_GAP}{self.value}{_POWERS[power]}" if self.value else number
