"""Expressions for lengths, angles and numbers, such as ``0.15 L`` or ``60deg``.

A bare number is in mesh units where a length is meant and in degrees where an angle is. Factors without a
sign between them are multiplied from left to right, so that ``1/2 L`` is half of L. Only a unit belongs to
the number before it, and ``10mm/5mm`` is 2; but ``1/2 in`` is half an inch.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.session.quantities.expression_parser import SPELLINGS, ExpressionParser, tokenize
from apd_viewer.session.quantities.quantity import DIMENSIONLESS
from apd_viewer.session.quantities.units import Unit

MOST_CHARACTERS = 200


def parse_length(text: str, unit: Unit, names: Mapping[str, float]) -> float:
    """Length in mesh units from a text.

    Parameters
    ----------
    text : str
    unit : Unit
        That of the mesh.
    names : mapping of str to float
        Lengths that can be named, mesh units.

    Raises
    ------
    InputError
        If the text says no finite length.
    """
    return _parse_value(text, names, unit, (1.0, 0.0), tr("a length such as 0.5"))


def parse_angle(text: str, names: Mapping[str, float]) -> float:
    """Angle in radians, as :func:`parse_length`; a bare number is in degrees."""
    return math.radians(_parse_value(text, names, None, (0.0, 1.0), tr("an angle such as 30 or 30deg")))


def parse_number(text: str, names: Mapping[str, float]) -> float:
    """Dimensionless number. Otherwise as :func:`parse_length`."""
    return _parse_value(text, names, None, DIMENSIONLESS, tr("a number such as 0.5"))


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
    said = ExpressionParser(tokenize(text), names, unit).parsed_quantity()
    if said.powers not in (DIMENSIONLESS, powers):
        raise InputError(tr("This is {kind}; enter {wanted}.").format(kind=said.kind, wanted=wanted))
    return said.value
