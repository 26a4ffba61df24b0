"""Figures of the verification: the program's results against exact curves."""

from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from apd_viewer.figures.style import BLUE, GREEN, INK, METHOD_STYLES, ORANGE, draw_figure
from apd_viewer.language import tr
from apd_viewer.verification.verification_run import CaseRun

_SIZE = (5.6, 3.9)


def draw_verification(run: CaseRun, folder: Path) -> None:
    """Draw a finished case at all resolutions, in a file named by its letter."""

    def fill(figure: Figure) -> None:
        axes = figure.subplots()
        draw_case(axes, run)
        look = {"handlelength": 1.4, "columnspacing": 1.4, "handletextpad": 0.5}
        figure.legend(loc="outside lower center", ncols=len(axes.lines), **look)

    draw_figure(fill, _SIZE, folder, run.case.letter)


def draw_case(axes: Axes, run: CaseRun) -> None:
    """Draw the exact curve of a case, and the computed results."""
    case = run.case
    axes.set(title=f"{case.letter}  {case.title}", xlabel=case.axes[0], ylabel=case.axes[1])
    axes.plot(*case.curve().T, color=INK, linewidth=1.2, label=tr("exact"))
    looks = (BLUE, 2.5), (GREEN, 4.0), (ORANGE, 5.5)
    finest_first = zip(case.resolutions[::-1], run.measured[::-1], looks, strict=False)
    for n, measured, (color, size) in reversed([*finest_first]):
        axes.plot(*measured.points.T, "o", color=color, markersize=size, label=tr("{n} edges").format(n=n))
    if run.plain is not None:
        look = METHOD_STYLES["arap"] | {"linestyle": "none", "markerfacecolor": "none"}
        axes.plot(*run.plain.points.T, label=tr("plain ARAP"), **look)
    axes.margins(0.04, 0.12)
    axes.xaxis.set_major_locator(MaxNLocator(steps=[1, 2, 5, 10]))
