"""Quantities: numbers with powers of length and angle."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from apd_viewer.errors import InputError
from apd_viewer.language import tr

DIMENSIONLESS = (0.0, 0.0)
_KINDS = {
    DIMENSIONLESS: tr("a number"),
    (1.0, 0.0): tr("a length"),
    (2.0, 0.0): tr("an area"),
    (3.0, 0.0): tr("a volume"),
    (0.0, 1.0): tr("an angle"),
}


@dataclass(frozen=True)
class Quantity:
    """Finite number with powers of length (mesh units) and angle (degrees)."""

    value: float
    length: float = 0.0
    angle: float = 0.0

    def __post_init__(self) -> None:
        if not math.isfinite(self.value):
            raise InputError(tr("The result is too large; enter smaller numbers."))

    @property
    def powers(self) -> tuple[float, float]:
        """Exponents of length and angle, rounded so that thirds add up to one."""
        return round(self.length, 9), round(self.angle, 9)

    @property
    def kind(self) -> str:
        """Name of the kind of quantity, for use in a sentence."""
        return _KINDS.get(self.powers, tr("a product of lengths and angles"))

    def with_dimension_of(self, other: Quantity) -> Quantity:
        """Quantity with the dimension of ``other``, if it is a bare number."""
        if self.powers == DIMENSIONLESS:
            return replace(other, value=self.value)
        if other.powers in (DIMENSIONLESS, self.powers):
            return self
        raise InputError(
            tr("This adds or compares {kind} and {other}; use one kind for both.").format(
                kind=self.kind, other=other.kind
            )
        )

    def __add__(self, other: Quantity) -> Quantity:
        return replace(self.with_dimension_of(other), value=self.value + other.value)

    def __mul__(self, other: Quantity) -> Quantity:
        return Quantity(self.value * other.value, self.length + other.length, self.angle + other.angle)

    def __truediv__(self, other: Quantity) -> Quantity:
        if other.value == 0.0:
            raise InputError(tr("This divides by zero; enter another divisor."))
        return Quantity(self.value / other.value, self.length - other.length, self.angle - other.angle)

    def __pow__(self, other: Quantity) -> Quantity:
        if other.powers != DIMENSIONLESS:
            raise InputError(tr("An exponent cannot be {kind}; enter a number.").format(kind=other.kind))
        try:
            value = self.value**other.value
        except ZeroDivisionError:
            raise InputError(
                tr("This divides by zero: 0 has no negative power; enter another exponent.")
            ) from None
        except OverflowError:
            value = math.inf
        if isinstance(value, complex):
            raise InputError(tr("A negative number has no such root; enter a positive one."))
        return Quantity(value, self.length * other.value, self.angle * other.value)
