"""Units of length, with matching units of capacity and mass."""

from __future__ import annotations

from enum import Enum

from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.notation import METRES, MICROMETRES

# No-break space between a number and its unit.
_GAP = "\u00a0"
_GUESS = "?"
# Litres and grams per unit, smallest first; US units for meshes in inches or feet.
_LITRES = {"ml": 1e-3, "l": 1.0}
_LITRES_OF_INCHES = {"fl oz": 0.0295735295625, "gal": 3.785411784}
_GRAMS = {"mg": 1e-3, "g": 1.0, "kg": 1e3}
_GRAMS_OF_INCHES = {"oz": 28.349523125, "lb": 453.59237}
_LEGIBLE = 1e6  # larger values are shown in a larger unit
_POWERS = {-1: "⁻¹", 1: "", 2: "²", 3: "³"}


class Unit(Enum):
    """Unit of length, confirmed or guessed; the value is its symbol.

    A guess is a unit neither chosen nor stated in a file. Texts in it end with a question mark.
    """

    NONE = ""
    MILLIMETRE = "mm"
    CENTIMETRE = "cm"
    METRE = "m"
    INCH = "in"
    FOOT = "ft"
    GUESSED_MILLIMETRE = "mm?"
    GUESSED_CENTIMETRE = "cm?"
    GUESSED_METRE = "m?"
    GUESSED_INCH = "in?"
    GUESSED_FOOT = "ft?"

    @property
    def symbol(self) -> str:
        """Symbol without the mark of a guess."""
        return self.value.removesuffix(_GUESS)

    @property
    def is_guess(self) -> bool:
        """True if the unit was neither chosen nor stated in a file."""
        return self.value.endswith(_GUESS)

    @property
    def as_guess(self) -> Unit:
        """The unit marked as a guess."""
        return Unit(self.symbol + _GUESS) if self.symbol else self

    @property
    def as_confirmed(self) -> Unit:
        """The unit, no longer flagged as guessed."""
        return Unit(self.symbol)

    @property
    def title(self) -> str:
        """Text of the unit on a button."""
        return self.value or tr("no unit")

    def format_length(self, number: str) -> str:
        """Text of a length: the given number with its unit."""
        return self._with_symbol(number, 1)

    def format_area(self, number: str) -> str:
        """Text of an area: the given number with its unit."""
        return self._with_symbol(number, 2)

    def format_volume(self, number: str) -> str:
        """Text of a volume: the given number with its unit."""
        return self._with_symbol(number, 3)

    def format_curvature(self, number: str) -> str:
        """Text of a curvature: the given number over the unit of length."""
        return self._with_symbol(number, -1)

    def legible_unit(self, value: float, power: int) -> tuple[Unit, float]:
        """Unit suited to the size of an area or volume, and the factor to it."""
        unit, factor = self.as_confirmed, 1.0
        while abs(factor * value) >= _LEGIBLE and unit in _LARGER:
            larger = _LARGER[unit]
            factor *= (MICROMETRES[unit.value] / MICROMETRES[larger.value]) ** power
            unit = larger
        return unit.as_guess if self.is_guess else unit, factor

    @property
    def metres(self) -> float | None:
        """Metres per unit; None without a unit."""
        return METRES.get(self.symbol)

    def to_litres(self, volume: float) -> float | None:
        """Volume in litres from cubic mesh units; None without a unit."""
        size = MICROMETRES.get(self.symbol)
        return None if size is None else volume * (size / 1e5) ** 3

    def capacity_unit(self, litres: float) -> tuple[str, float]:
        """Capacity unit suited to a volume in litres, and the factor from litres to it."""
        if self._is_imperial:
            symbol, factor = _fitting_unit(_LITRES_OF_INCHES, abs(litres))
        else:
            # Litres are customary for a tenth of a litre and more.
            symbol, factor = _fitting_unit(_LITRES, 10.0 * abs(litres))
        return symbol + self._mark, factor

    def mass_unit(self, grams: float) -> tuple[str, float]:
        """Mass unit suited to an amount in grams, and the factor from grams to it."""
        symbol, factor = _fitting_unit(_GRAMS_OF_INCHES if self._is_imperial else _GRAMS, grams)
        return symbol + self._mark, factor

    @property
    def _is_imperial(self) -> bool:
        return self.as_confirmed in (Unit.INCH, Unit.FOOT)

    @property
    def _mark(self) -> str:
        return _GUESS if self.is_guess else ""

    def _with_symbol(self, number: str, power: int) -> str:
        return f"{number}{_GAP}{self.symbol}{_POWERS[power]}{self._mark}" if self.value else number


# Names of the units offered to the user.
UNIT_NAMES = {
    Unit.NONE: tr("No unit"),
    Unit.MILLIMETRE: tr("Millimetres (mm)"),
    Unit.CENTIMETRE: tr("Centimetres (cm)"),
    Unit.METRE: tr("Metres (m)"),
    Unit.INCH: tr("Inches (in)"),
    Unit.FOOT: tr("Feet (ft)"),
}
SYMBOLS = tuple(MICROMETRES)
_LARGER = {Unit.MILLIMETRE: Unit.CENTIMETRE, Unit.CENTIMETRE: Unit.METRE, Unit.INCH: Unit.FOOT}


def _fitting_unit(sizes: dict[str, float], amount: float) -> tuple[str, float]:
    """Largest unit not above an amount, else the smallest, and its reciprocal size."""
    fitting = [symbol for symbol, size in sizes.items() if amount >= size]
    symbol = fitting[-1] if fitting else next(iter(sizes))
    return symbol, 1.0 / sizes[symbol]


class NoUnitError(InputError):
    """Error for a length in a unit on a mesh without one.

    Parameters
    ----------
    word : str
        Unit of the length.
    """

    def __init__(self, word: str) -> None:
        super().__init__(word)
        self.word = word

    def __str__(self) -> str:
        return tr("The unit of the mesh is not set; choose it before entering {word}.").format(word=self.word)
