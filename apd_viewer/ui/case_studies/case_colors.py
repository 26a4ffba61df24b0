"""Colours of chosen cases and of the dots of a scatter plot."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from apd_viewer.presentation.axis import Axis, magnitude_axis, rounded_axis
from apd_viewer.presentation.color_maps import SEQUENTIAL
from apd_viewer.ui.case_studies.result_columns import ResultColumn

# Okabe and Ito's, those first that stand out on light and dark.
_CHOSEN = ("#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8a63c9", "#8c8c1e")
MOST_CHOSEN = len(_CHOSEN)
# Where the largest value is so many times the least, and half of all values lie in this lower share of the
# range, a logarithmic axis parts them.
_MANY, _CROWDED = 50.0, 0.25
_FINEST = 0.01  # percent: two decimals are shown
_NOTHING = "#b8bcc4"
_SHADES = 100  # of dots: more cannot be told apart


class CaseColors:
    """Colours of chosen cases, each of which keeps its own while it is chosen."""

    def __init__(self) -> None:
        self._given: dict[int, str] = {}

    def colors_of(self, rows: Sequence[int]) -> dict[int, str]:
        """Colours of the first rows of the plan."""
        rows = rows[:MOST_CHOSEN]
        kept = {row: color for row, color in self._given.items() if row in rows}
        free = [color for color in _CHOSEN if color not in kept.values()]
        self._given = {row: kept[row] if row in kept else free.pop(0) for row in rows}
        return self._given


def axis_of(column: ResultColumn) -> tuple[Axis, np.ndarray]:
    """Axis of a column with numbers, and the places (n,) of its values on it."""
    known = column.values[np.isfinite(column.values)]
    low, high = float(known.min()), float(known.max())
    if column.suffix.strip() == "%" and high - low < _FINEST:
        # Apart by less than what is shown: an area that is kept, but for rounding.
        low, high = (round((low + high) / 2.0 + side * _FINEST, 2) for side in (-1.0, 1.0))
    crowded = float(np.median(known)) < low + _CROWDED * (high - low)
    if low > 0.0 and high > _MANY * low and crowded:
        with np.errstate(invalid="ignore"):
            return magnitude_axis(low, high, column.suffix), np.log10(column.values)
    return rounded_axis(low, high, column.suffix), column.values


def color_bar_colors() -> tuple[str, ...]:
    """Colours of the scale, from its lower end to its upper."""
    return tuple(_hex(color) for color in SEQUENTIAL.knots)


def dot_colors(axis: Axis, places: np.ndarray) -> tuple[str, ...]:
    """Colour of each of the places (n,) on an axis, grey where there is none."""
    share = np.clip((places - axis.low) / (axis.high - axis.low), 0.0, 1.0)
    shades = [*map(_hex, SEQUENTIAL.colors(np.linspace(0.0, 1.0, _SHADES)).tolist()), _NOTHING]
    chosen = np.where(np.isfinite(share), np.rint((_SHADES - 1) * np.nan_to_num(share)), _SHADES)
    return tuple(shades[k] for k in chosen.astype(int).tolist())


def uniform_colors(count: int) -> tuple[str, ...]:
    """One colour for all dots."""
    return (_hex(SEQUENTIAL.knots[3]),) * count


def _hex(color: Sequence[int]) -> str:
    red, green, blue = color
    return f"#{red:02x}{green:02x}{blue:02x}"
