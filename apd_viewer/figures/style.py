"""Plot style for print and colour-blind readers, and SVG and PNG output."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import ScalarFormatter

from apd_viewer.figures.fonts import font_families
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.notation import localized_number

INK, QUIET, LINE = "#1d2129", "#5a6270", "#dcdfe4"
# Okabe and Ito's palette, ordered so that neighbouring curves differ in lightness too.
BLUE, VERMILION, GREEN, ORANGE, PURPLE = "#0072b2", "#d55e00", "#009e73", "#e69f00", "#cc79a7"
# Colour, dashes and marker of each method; any one of them identifies it.
METHOD_STYLES: dict[str, dict[str, Any]] = {
    "arap": {"color": VERMILION, "linestyle": (0, (5, 1.5)), "marker": "s"},
    "paper": {"color": ORANGE, "linestyle": (0, (1, 1)), "marker": "^"},
    "exact": {"color": BLUE, "linestyle": "-", "marker": "o"},
    "local": {"color": GREEN, "linestyle": (0, (6, 1.5, 1, 1.5)), "marker": "D"},
    "sr-arap": {"color": PURPLE, "linestyle": (0, (3, 1)), "marker": "v"},
    "wall": {"color": INK, "linestyle": (0, (8, 1.5)), "marker": "P"},
}
_DPI = 160
_LOOK: dict[Any, Any] = {
    "font.size": 9.5,
    "text.color": INK,
    "axes.titlesize": 10.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.titlepad": 8.0,
    "axes.labelcolor": QUIET,
    "axes.edgecolor": LINE,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": LINE,
    "grid.linewidth": 0.6,
    "xtick.color": QUIET,
    "ytick.color": QUIET,
    "xtick.major.size": 0,
    "ytick.major.size": 0,
    "lines.linewidth": 1.8,
    "lines.markersize": 4.0,
    "legend.frameon": False,
    "axes.unicode_minus": True,
    "text.parse_math": False,  # names of obstacles may contain a $
    "svg.fonttype": "path",
    "svg.hashsalt": "apd-viewer",  # equal figures give identical files
}


def draw_figure(fill: Callable[[Figure], None], size: tuple[float, float], folder: Path, name: str) -> None:
    """Draw a figure of ``size`` inches with ``fill``; save it as SVG and PNG.

    Raises
    ------
    InputError
        If a file cannot be written.
    """
    with mpl.rc_context(_LOOK | {"font.family": font_families()}):
        figure = Figure(figsize=size, layout="constrained", facecolor="white")
        FigureCanvasAgg(figure)
        fill(figure)
        _write_numbers(figure)
        for kind, about in (("svg", {"Date": None}), ("png", {"Software": None})):
            with replacing_file(folder / f"{name}.{kind}") as scratch:
                figure.savefig(scratch, dpi=_DPI, metadata=about)


def _write_numbers(figure: Figure) -> None:
    """Format the numbers of linear axes in the current notation."""
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            if type(axis.get_major_formatter()) is ScalarFormatter:
                axis.set_major_formatter(_LocalizedFormatter())


class _LocalizedFormatter(ScalarFormatter):
    def __call__(self, x: float, pos: int | None = None) -> str:
        return localized_number(super().__call__(x, pos))


def zero_line(axes: Axes) -> None:
    """Emphasise the zero line."""
    axes.axhline(0.0, color=QUIET, linewidth=0.9, zorder=1)
