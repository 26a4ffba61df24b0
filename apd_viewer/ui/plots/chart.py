"""Contents of a chart: axes, curves, bars and marks."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from apd_viewer.presentation.axis import Axis


@dataclass(frozen=True, eq=False)
class Curve:
    """A line through points on the axes, in a colour of the theme or #rrggbb.

    It is broken where ``y`` is not finite.
    """

    x: np.ndarray
    y: np.ndarray
    color: str = "accent"


@dataclass(frozen=True, eq=False)
class Bars:
    """Histogram of ``heights`` (b,) between ``edges`` (b + 1,), coloured by sign."""

    edges: np.ndarray
    heights: np.ndarray
    negative_color: str = "less"
    positive_color: str = "more"


@dataclass(frozen=True, eq=False)
class Dots:
    """Points on the axes, each in a colour of its own.

    Attributes
    ----------
    x, y : (n,) float array
        Not drawn where one is not finite.
    colors : tuple of str
        #rrggbb.
    crosses : (m, 2) float array
        Places of crosses, for what has no result.
    """

    x: np.ndarray
    y: np.ndarray
    colors: tuple[str, ...]
    crosses: np.ndarray = field(default_factory=lambda: np.empty((0, 2)))


@dataclass(frozen=True)
class ColorBar:
    """Scale of the colours of dots, beside the chart."""

    axis: Axis
    colors: tuple[str, ...]


@dataclass(frozen=True)
class ReferenceLine:
    """A dashed line across the chart at a place of an axis; text above upright ones."""

    place: float
    text: str = ""
    color: str = "faint"


@dataclass(frozen=True, eq=False)
class Chart:
    """Contents of a chart.

    Attributes
    ----------
    title : str
        Empty where it stands elsewhere: the chart then has its room.
    readings : tuple of (str, str)
        What is written under the title, and in which colour of the theme or #rrggbb.
    x, y : Axis or None
        None where there is nothing to be seen yet.
    curves, bars, dots, color_bar, horizontal_lines, vertical_lines
        ``horizontal_lines`` are marks at places of y, ``vertical_lines`` at places of x.
    empty_text : str
        What is said where there is nothing to be seen.
    """

    title: str
    readings: tuple[tuple[str, str], ...] = ()
    x: Axis | None = None
    y: Axis | None = None
    curves: tuple[Curve, ...] = ()
    bars: Bars | None = None
    dots: Dots | None = None
    color_bar: ColorBar | None = None
    horizontal_lines: tuple[ReferenceLine, ...] = ()
    vertical_lines: tuple[ReferenceLine, ...] = ()
    empty_text: str = field(default="", repr=False)
