"""Expressions for lengths, angles and numbers, such as ``0.15 L`` or ``60deg``.

A bare number is a length in mesh units or an angle in degrees. Factors without an operator in between are
multiplied from left to right, so that ``1/2 L`` is half of L. Only a unit binds to the number before it:
``10mm/5mm`` is 2, but ``1/2 in`` is half an inch.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

from apd_viewer.errors import InputError
from apd_viewer.language import in_quotes, tr
from apd_viewer.notation import MICROMETRES, editable_number, notation
from apd_viewer.session.quantities.units import NoUnitError, Unit

MOST_CHARACTERS = 200


def parse_length(text: str, unit: Unit, names: Mapping[str, float]) -> float:
    """Length in mesh units from a text.

    Parameters
    ----------
    unit : Unit
        Unit of the mesh.
    names : mapping of str to float
        Lengths that can be named, mesh units.

    Raises
    ------
    InputError
        If the text says no finite length.
    """
    return _parse_value(text, names, unit, (1.0, 0.0), tr("a length such as 0.5"))


def parse_angle(text: str, names: Mapping[str, float]) -> float:
    """Angle in radians from a text; a bare number is in degrees."""
    return math.radians(_parse_value(text, names, None, (0.0, 1.0), tr("an angle such as 30 or 30deg")))


def parse_number(text: str, names: Mapping[str, float]) -> float:
    """Dimensionless number from a text; otherwise as :func:`parse_length`."""
    return _parse_value(text, names, None, DIMENSIONLESS, tr("a number such as 0.5"))


def parse_volume(text: str, unit: Unit) -> float:
    """Volume from a text such as ``250ml``, cubic mesh units as a bare number.

    Raises
    ------
    InputError
        If the text says no finite volume.
    """
    return _parse_value(text, {}, unit, _VOLUME, tr("a volume such as 250ml"))


def _parse_value(
    text: str, names: Mapping[str, float], unit: Unit | None, powers: tuple[float, float], wanted: str
) -> float:
    text = text.translate(SPELLINGS).strip()
    if not text:
        raise InputError(tr("Nothing was entered; enter {wanted}.").format(wanted=wanted))
    if len(text) > MOST_CHARACTERS:
        raise InputError(
            tr("The entry is too long; enter at most {most} characters.").format(most=MOST_CHARACTERS)
        )
    litres = _LITRES if powers == _VOLUME else {}
    quantity = ExpressionParser(tokenize(text), names, unit, litres).parsed_quantity()
    if quantity.powers not in (DIMENSIONLESS, powers):
        raise InputError(tr("This is {kind}; enter {wanted}.").format(kind=quantity.kind, wanted=wanted))
    return quantity.value


# Limit of nested parentheses, far below Python's recursion limit.
_MOST_NESTED = 30
_MICROMETRES = MICROMETRES | {"um": 1.0}
_VOLUME = 3.0, 0.0
_LITRES = {"ml": 1e-3, "cl": 1e-2, "l": 1.0}
_DEGREES = {"deg": 1.0, "rad": math.degrees(1.0), "turn": 360.0}


class ExpressionParser:
    """Recursive-descent parser of tokens."""

    def __init__(
        self,
        tokens: list[str],
        names: Mapping[str, float],
        unit: Unit | None,
        litres: Mapping[str, float] = MappingProxyType({}),
    ) -> None:
        self._left = tokens[::-1]
        self._litres = litres
        self._names = names
        self._unit = unit
        self._nested = 0

    def parsed_quantity(self) -> Quantity:
        """Quantity of all tokens."""
        quantity = self._sum()
        if self._token:
            raise self._misplaced_error()
        return quantity

    @property
    def _token(self) -> str:
        """The next token; empty at the end."""
        return self._left[-1] if self._left else ""

    def _take(self) -> str:
        return self._left.pop() if self._left else ""

    def _sum(self) -> Quantity:
        total = self._product()
        while self._token in ("+", "-"):
            sign = Quantity(1.0 if self._take() == "+" else -1.0)
            total += sign * self._product()
        return total

    def _product(self) -> Quantity:
        product = self._signed_factor() * self._unit_factor()
        while self._token in ("*", "/", "(") or self._token[:1].isalpha():
            divides = self._token == "/"
            if self._token in ("*", "/"):
                self._take()
            factor, unit = self._signed_factor(), self._unit_factor()
            if not divides:
                product *= factor * unit
            elif product.powers == DIMENSIONLESS:
                product = product / factor * unit
            else:
                product /= factor * unit
        return product

    def _signed_factor(self) -> Quantity:
        self._nested += 1
        if self._nested > _MOST_NESTED:
            raise InputError(tr("Too many nested parentheses; use fewer."))
        sign = 1.0
        while self._token in ("+", "-"):
            sign *= 1.0 if self._take() == "+" else -1.0
        power = self._power(self._primary())
        self._nested -= 1
        return Quantity(sign) * power

    def _power(self, root: Quantity) -> Quantity:
        if self._token not in ("^", "**"):
            return root
        self._take()
        return root ** self._signed_factor()

    def _primary(self) -> Quantity:
        if self._token == "(":
            self._take()
            value = self._sum()
            self._close_parenthesis()
        elif starts_number(self._token):
            value = _number(self._take())
        elif self._token in FUNCTIONS and self._token not in self._names:
            value = call_function(self._take(), self._arguments())
        elif self._token[:1].isalpha():
            value = self._named_value(self._take())
        else:
            raise self._misplaced_error()
        while self._token == "%":
            self._take()
            value /= Quantity(100.0)
        return value

    def _arguments(self) -> list[Quantity]:
        if self._take() != "(":
            raise InputError(tr("A function needs parentheses, as in sqrt(2)."))
        values = [self._sum()]
        while self._token == ",":
            self._take()
            values.append(self._sum())
        self._close_parenthesis()
        return values

    def _close_parenthesis(self) -> None:
        if self._token and self._token != ")":
            raise self._misplaced_error()
        if not self._take():
            raise InputError(tr("A parenthesis is not closed; close it."))

    def _unit_factor(self) -> Quantity:
        """Unit after a number; 1 if there is none."""
        if self._token in self._names or self._token not in (*_MICROMETRES, *self._litres, *_DEGREES):
            return Quantity(1.0)
        return self._power(self._named_value(self._take()))

    def _named_value(self, word: str) -> Quantity:
        if word in self._names:
            return Quantity(self._names[word], length=1.0)
        if word == "pi":
            return Quantity(math.pi)
        if word in _DEGREES:
            return Quantity(_DEGREES[word], angle=1.0)
        if word in _MICROMETRES or word in self._litres:
            return self._unit_of_length(word)
        raise InputError(
            tr(
                "{text} is unknown; use {names}, a unit such as mm or deg, or a function such as sqrt."
            ).format(text=quoted_input(word), names=", ".join([*self._names, "pi"]))
        )

    def _unit_of_length(self, word: str) -> Quantity:
        if self._unit is None:
            raise InputError(
                tr("{text} is a unit of length, which is not allowed here; remove it.").format(
                    text=quoted_input(word)
                )
            )
        if self._unit is Unit.NONE:
            raise NoUnitError(word)
        if word in self._litres:
            return Quantity(self._litres[word] / (self._unit.to_litres(1.0) or math.nan), length=3.0)
        return Quantity(_MICROMETRES[word] / _MICROMETRES[self._unit.symbol], length=1.0)

    def _misplaced_error(self) -> InputError:
        if not self._token:
            return InputError(tr("The expression is incomplete; complete it."))
        if starts_number(self._token):
            return InputError(
                tr("An operator is missing before {text}; enter one such as * or +.").format(
                    text=quoted_input(self._token)
                )
            )
        return InputError(
            tr("{text} is not expected here; remove it or complete the expression.").format(
                text=quoted_input(self._token)
            )
        )


def _number(token: str) -> Quantity:
    check_unambiguous(token, ",")
    return Quantity(float(token.replace(",", ".")))


_OF_ANGLES: dict[str, Callable[[float], float]] = {"sin": math.sin, "cos": math.cos, "tan": math.tan}
_TO_ANGLES: dict[str, Callable[[float], float]] = {"asin": math.asin, "acos": math.acos, "atan": math.atan}
VARIADIC_FUNCTIONS: dict[str, Callable[..., float]] = {"min": min, "max": max}
FUNCTIONS = ("sqrt", *_OF_ANGLES, *_TO_ANGLES, "abs", *VARIADIC_FUNCTIONS)
# Rounding of a cosine at a right angle.
_NO_COSINE = 1e-15


def call_function(name: str, values: list[Quantity]) -> Quantity:
    """Value of a named function."""
    first = values[0]
    if name in VARIADIC_FUNCTIONS:
        for value in values:
            first = first.with_dimension_of(value)
        return replace(first, value=VARIADIC_FUNCTIONS[name](value.value for value in values))
    if len(values) != 1:
        raise InputError(
            tr("{name} takes one value, not {n}, as in {name}(1).").format(name=name, n=len(values))
        )
    if name == "abs":
        return replace(first, value=abs(first.value))
    if name == "sqrt":
        return first ** Quantity(0.5)
    return (
        _trigonometric_value(name, first) if name in _OF_ANGLES else _inverse_trigonometric_value(name, first)
    )


def _trigonometric_value(name: str, value: Quantity) -> Quantity:
    if value.powers not in (DIMENSIONLESS, (0.0, 1.0)):
        raise InputError(
            tr("{name} does not accept {kind}; enter an angle, as in {name}(30deg).").format(
                name=name, kind=value.kind
            )
        )
    turn = math.radians(value.value)
    if name == "tan" and abs(math.cos(turn)) < _NO_COSINE:
        raise InputError(tr("The tangent of a right angle is infinite; enter another angle."))
    return Quantity(_OF_ANGLES[name](turn))


def _inverse_trigonometric_value(name: str, value: Quantity) -> Quantity:
    if value.powers != DIMENSIONLESS:
        raise InputError(
            tr("{name} does not accept {kind}; enter a number, as in {name}(0.5).").format(
                name=name, kind=value.kind
            )
        )
    if name != "atan" and abs(value.value) > 1.0:
        raise InputError(
            tr("{name} accepts only numbers from -1 to 1; enter one of these.").format(name=name)
        )
    return Quantity(math.degrees(_TO_ANGLES[name](value.value)), angle=1.0)


SPELLINGS = str.maketrans(
    dict.fromkeys("−–‐‑", "-")
    | dict.fromkeys("×·⋅∙∗", "*")
    | dict.fromkeys("÷∕⁄", "/")
    | dict.fromkeys("µμ", "u")
    | {"²": "^2 ", "³": "^3 ", "°": " deg ", "π": " pi "}
)
_TOKEN = r"(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?|[^\W\d_]\w*|\*\*|[-+*/^%(),]"
_AMONG_ARGUMENTS = re.compile(rf"\s*({_TOKEN})")
_ELSEWHERE = re.compile(rf"\s*([0-9]+,[0-9]+(?:[eE][+-]?[0-9]+)?|{_TOKEN})")


def tokenize(text: str) -> list[str]:
    """Tokens of a text, left to right; raises InputError."""
    tokens: list[str] = []
    # For each open parenthesis, whether commas separate arguments; elsewhere they are decimal commas.
    lists = [False]
    at = 0
    while at < len(text):
        found = (_AMONG_ARGUMENTS if lists[-1] else _ELSEWHERE).match(text, at)
        if not found:
            raise InputError(
                tr("{text} is not allowed here; remove it.").format(text=quoted_input(text[at:].lstrip()[0]))
            )
        token, at = found[1], found.end()
        if token == "(":
            lists.append(tokens[-1:] != [] and tokens[-1] in VARIADIC_FUNCTIONS)
        elif token == ")" and len(lists) > 1:
            lists.pop()
        tokens.append(token)
    return tokens


def starts_number(token: str) -> bool:
    """True if a token is a number, recognised by its first character."""
    return token[:1].isdecimal() or token[:1] == "."


def quoted_input(text: str) -> str:
    """Typed text quoted for a sentence, shortened, invisible characters as codes."""
    short = text if len(text) <= 20 else f"{text[:19]}…"
    return (
        in_quotes(short)
        if short.isprintable()
        else tr("The character U+{code:04X}").format(code=ord(text[0]))
    )


# Numbers such as 1.234: over a thousand in some countries, a fraction in others.
_DOUBTFUL = re.compile(r"(?<![\w.,])[1-9][0-9]{0,2}([.,])[0-9]{3}(?![0-9.,eE])")


def check_unambiguous(text: str, signs: str) -> None:
    """Raise InputError on an ambiguous number with one of the ``signs``."""
    for found in _DOUBTFUL.finditer(text):
        if found[1] in signs:
            said, small = found[0], float(found[0].replace(",", "."))
            raise InputError(
                tr("“{text}” can mean {small} or {large}; write {small} or {large}.").format(
                    text=said, small=editable_number(f"{small:g}"), large=re.sub(r"[.,]", "", said)
                )
            )


def unambiguous_text(text: str) -> str:
    """Text from a field, checked for ambiguous numbers; raises InputError.

    In some languages the window separates groups of digits by points.
    """
    check_unambiguous(text, notation().group if notation().group == "." else "")
    return text


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
