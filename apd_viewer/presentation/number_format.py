"""Number formats of the window: true minus signs, no negative zero."""

import math

from apd_viewer.notation import editable_number, localized_number

_NOTHING = 1e-7
_BAR = 1e5  # Pa
_POWERS = 999_999.5  # larger numbers are written with a power of ten
_GROUPED = 999.5  # larger numbers have no decimals
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def format_significant(value: float, digits: int = 6) -> str:
    """Number with ``digits`` significant digits, or all of its integer part."""
    if 10.0**digits - 0.5 <= abs(value) < _POWERS:
        return _localized_text(f"{value:,.0f}")
    return _localized_text(_with_power(f"{value:#,.{digits}g}".rstrip("."))) if value else "0"


def format_length(value: float, size: float) -> str:
    """Length on a mesh of extent ``size``, with rounding errors as 0."""
    return format_significant(value, 4) if value > _NOTHING * size else "0"


def format_grouped(value: float, decimals: int) -> str:
    """Number with grouped thousands."""
    text = f"{value:,.{decimals}f}"
    return _localized_text(text.lstrip("-") if float(text.replace(",", "")) == 0 else text)


def format_signed(value: float, decimals: int, brief: bool = False) -> str:
    """Number with a sign unless zero; without trailing zeros if ``brief``."""
    text = f"{value:+.{decimals}f}"
    text = f"{0:.{decimals}f}" if float(text) == 0 else text
    return _localized_text(text.rstrip("0").rstrip(".") if brief else text)


def format_short(value: float) -> str:
    """Number without trailing zeros: 0.1, 20, 0.00025, 1,190 or 2·10⁻⁶."""
    return localized_number(_with_power(f"{value:.3g}") if abs(value) < _GROUPED else f"{value:,.0f}")


def format_short_signed(value: float) -> str:
    """Number as by :func:`format_short`, with a sign unless zero."""
    return ("+" if value > 0.0 else "−" if value < 0.0 else "") + format_short(abs(value))


def format_exact(value: float, digits: int = 6) -> str:
    """Number without trailing zeros or digit grouping."""
    return localized_number(f"{value:.{digits}g}")


def format_editable(value: float, digits: int = 6) -> str:
    """Number for a text field, in a form accepted as input."""
    return editable_number(f"{value:.{digits}g}")


def format_pressure(pascals: float) -> str:
    """Pressure in mbar, or bar from 1 bar on, in a form accepted as input."""
    value, unit = (pascals / _BAR, "bar") if abs(pascals) >= _BAR else (1e3 * pascals / _BAR, "mbar")
    return f"{format_editable(value)} {unit}"


def format_position(value: float, step: float) -> str:
    """Position on an axis, with enough digits to resolve a ``step``."""
    if abs(value) < 1e-6 * step:
        return "0"
    decimals = max(0, -math.floor(math.log10(step)))
    near = abs(float(f"{value:.3g}") - value) <= 0.1 * step
    return format_short(value).replace("-", "−") if near else _localized_text(f"{value:,.{decimals}f}")


def round_step(least: float) -> float:
    """Smallest 1-2-5 step not below a value; 1 for zero and infinity."""
    if not 0.0 < least < math.inf:
        return 1.0
    power = 10.0 ** math.floor(math.log10(least))
    factor = next(f for f in (1.0, 2.0, 5.0, 10.0) if f * power >= least * (1.0 - 1e-9))
    return float(f"{factor * power:.3g}")


def superscript(exponent: int) -> str:
    """Exponent in superscript digits."""
    return str(exponent).translate(_RAISED)


def _localized_text(text: str) -> str:
    """Localized number text with a true minus sign."""
    return localized_number(text).replace("-", "−")


def _with_power(text: str) -> str:
    """Replace e-notation by a power of ten."""
    digits, _, exponent = text.partition("e")
    return f"{digits.rstrip('.')}·10{superscript(int(exponent))}" if exponent else text
