"""Numbers as the panel writes them: true minus signs, and nothing where there is nothing."""

from __future__ import annotations

_NOTHING = 1e-7


def significant(value: float, digits: int = 6) -> str:
    """The number with so many digits that count."""
    return f"{value:#.{digits}g}".rstrip(".") if value else "0"


def length(value: float, size: float) -> str:
    """A length on a mesh of this size; what is nothing but rounding is zero."""
    return significant(value, 4) if value > _NOTHING * size else "0"


def signed(value: float, decimals: int) -> str:
    """The number with its sign, and without one where it rounds to zero."""
    text = f"{value:+.{decimals}f}"
    return f"{0:.{decimals}f}" if float(text) == 0 else text.replace("-", "−")


def short(value: float) -> str:
    """The number without the zeros behind it: 0.1, 20, 0.00025, 1,190."""
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:,.0f}"
