"""Curves of the paper's tables: area loss and handle drift."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from apd_viewer.cases.paper_curves import HandleCurvePoint, LossCurvePoint
from apd_viewer.figures.style import BLUE, INK, ORANGE, QUIET, VERMILION, draw_figure, zero_line
from apd_viewer.language import tr

_LOSS_SIZE, _HANDLE_SIZE = (9.0, 4.4), (9.0, 3.9)
# From few iterations to many: one hue, increasingly dark.
_SHADES = ("#f7b9a0", "#ee8f6a", VERMILION, "#9c3f00", "#5c2400")


def draw_loss_curves(
    points: Sequence[LossCurvePoint], published: Sequence[tuple[float, float]], folder: Path
) -> None:
    """Draw ARAP's area change against the angle, beside the paper's values.

    Parameters
    ----------
    points : sequence of LossCurvePoint
    published : sequence of (float, float)
        Degrees, and change of the area as a share.
    folder : Path
    """

    def fill(figure: Figure) -> None:
        axes = figure.subplots()
        axes.set_title(tr("Area change by ARAP, %"))
        axes.set_xlabel(tr("twist of the bottle, degrees"))
        axes.xaxis.set_major_locator(MultipleLocator(30))
        axes.set_xlim(0, 180)
        zero_line(axes)
        stops = sorted({loss.iterations for loss in points if loss.iterations})
        for stop, shade in zip(stops, _SHADES, strict=False):
            words = tr("stopped after 1 iteration") if stop == 1 else tr("after {n}").format(n=stop)
            _loss(axes, points, stop, words, shade, 1.4)
        _loss(axes, points, 0, tr("converged, step by step"), BLUE, 2.2)
        axes.plot(
            [degrees for degrees, _ in published],
            [100 * error for _, error in published],
            linestyle="none",
            marker="D",
            markersize=6.5,
            color=INK,
            label=tr("the paper's Table 1"),
            zorder=5,
        )
        axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5))

    draw_figure(fill, _LOSS_SIZE, folder, "loss-against-angle")


def _loss(
    axes: Axes, losses: Sequence[LossCurvePoint], stop: int, words: str, color: str, width: float
) -> None:
    own = [loss for loss in losses if loss.iterations == stop]
    axes.plot(
        [loss.degrees for loss in own],
        [100 * loss.area_error for loss in own],
        color=color,
        linewidth=width,
        marker="o" if not stop else "",
        label=words,
    )


def draw_handle_curves(points: Sequence[HandleCurvePoint], folder: Path) -> None:
    """Draw the paper method's handle positions against the targets."""

    def fill(figure: Figure) -> None:
        left, right = figure.subplots(1, 2)
        twists = [held for held in points if held.motion == "twist"]
        left.set_title(tr("Twist: drift of the handle"))
        left.set_xlabel(tr("twist, degrees"))
        left.set_ylabel(tr("drift, % of the height"))
        left.xaxis.set_major_locator(MultipleLocator(30))
        left.plot(*_curve(twists, 1.0), color=ORANGE, marker="^")
        left.set_ylim(bottom=0.0)
        pulls = [held for held in points if held.motion == "pull"]
        right.set_title(tr("Pull and push: displacement reached"))
        right.set_xlabel(tr("requested, % of the height"))
        right.set_ylabel(tr("reached, % of the height"))
        asked, _ = _curve(pulls, 100.0)
        right.plot(asked, asked, color=QUIET, linewidth=1.0, linestyle=(0, (4, 3)))
        right.annotate(
            tr("requested"),
            (asked[-1], asked[-1]),
            (-6, 0),
            textcoords="offset points",
            ha="right",
            va="center",
            color=QUIET,
        )
        right.plot(*_curve(pulls, 100.0), color=ORANGE, marker="^")
        right.annotate(
            tr("reached with Eq. 8"),
            (asked[-1], _curve(pulls, 100.0)[1][-1]),
            (-6, 8),
            textcoords="offset points",
            ha="right",
            va="bottom",
            color=INK,
        )

    draw_figure(fill, _HANDLE_SIZE, folder, "handle")


def _curve(points: Sequence[HandleCurvePoint], unit: float) -> tuple[list[float], list[float]]:
    return [unit * held.asked for held in points], [100 * held.got for held in points]
