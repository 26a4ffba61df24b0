"""Curves beyond the paper's tables: ARAP's area change, handle drift of Eq. 8."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from apd_viewer.cases.case import case_of, case_steps
from apd_viewer.figures.style import BLUE, INK, ORANGE, QUIET, VERMILION, draw_figure, zero_line
from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.geometry.pose.transforms import translation
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.posing.motion import TWIST, Motion
from apd_viewer.session.posing.motion_path import MotionStep

# Numbers of iterations from the rest shape after which ARAP's area is recorded.
LOSS_ITERATIONS = (1, 2, 3, 5, 20)
_WIDEST = 180.0  # largest twist in degrees
_TWIST = MotionStep(0, Motion(TWIST), (np.radians(_WIDEST),))
_PUSH, _PULL = 0.2, 0.4  # displacements as fractions of the mesh height
_STEPS_OF_A_PULL = 4

ProgressCallback = Callable[[float], object]
_LOSS_SIZE, _HANDLE_SIZE = (9.0, 4.4), (9.0, 3.9)
# One hue, darker with the number of iterations.
_SHADES = ("#f7b9a0", "#ee8f6a", VERMILION, "#9c3f00", "#5c2400")


class LossCurvePoint(NamedTuple):
    """Area change at one twist angle after a number of iterations.

    Attributes
    ----------
    iterations : int
        Plain ones from rest; 0 is a shape that was left to settle, twisted from the one before.
    """

    degrees: float
    iterations: int
    area_error: float


class HandleCurvePoint(NamedTuple):
    """Requested and actual position of a handle under the paper's method.

    Attributes
    ----------
    motion : str
        "twist" or "pull".
    asked : float
        Degrees of a twist; for a pull, the displacement along the axis over the height of the mesh.
    got : float
        Actual displacement of a pull; drift relative to the height for a twist.
    """

    motion: str
    asked: float
    got: float


def loss_curve(
    document: Document, steps: int = 18, tick: ProgressCallback = lambda _: None
) -> list[LossCurvePoint]:
    """ARAP's area change for twists from 0 to 180 degrees, in ``steps`` steps."""
    found = []
    document = document.with_settings(method="arap", contact=False)  # the paper's methods have no contact
    held = document.constraints()
    mesh = document.mesh
    solver = Deformation(mesh.V, mesh.F, held.fixed, method="arap", handle=held.handles, plain=True)
    case = case_of(document, steps, motion=[_TWIST])
    for number, part in enumerate(case.fractions):
        tick(0.1 * number / steps)
        solver.aim(case.document_at(part).constraints().targets, mesh.V)
        for iteration in range(1, max(LOSS_ITERATIONS) + 1):
            solver.iterate()
            if iteration in LOSS_ITERATIONS:
                found.append(LossCurvePoint(_WIDEST * part, iteration, solver.frame().area_error))
    for step in case_steps(case, lambda done: tick(0.1 + 0.9 * done)):
        found.append(LossCurvePoint(step.degrees, 0, step.frame.area_error))
    return found


def handle_curve(
    document: Document, steps: int = 12, tick: ProgressCallback = lambda _: None
) -> list[HandleCurvePoint]:
    """Handle drift of the paper's method in twists to 180 degrees, pulls and pushes."""
    found = []
    height = float(np.linalg.norm(_base_to_handle(document)))
    document = document.with_settings(method="paper")
    for step in case_steps(case_of(document, steps, motion=[_TWIST]), lambda done: tick(0.6 * done)):
        found.append(HandleCurvePoint("twist", step.degrees, step.frame.handle_drift / height))
    ways = [
        *_pull_points(document, -_PUSH, lambda done: tick(0.6 + 0.2 * done)),
        *_pull_points(document, _PULL, lambda done: tick(0.8 + 0.2 * done)),
    ]
    return found + sorted(set(ways), key=lambda held: held.asked)


def _pull_points(document: Document, fraction: float, tick: ProgressCallback) -> Iterator[HandleCurvePoint]:
    line = _base_to_handle(document)
    case = case_of(document.with_pose(0, translation(fraction * line)), _STEPS_OF_A_PULL)
    handle = document.labels == HANDLE
    for step in case_steps(case, tick):
        away = (step.frame.U[handle] - document.initial_positions[handle]).mean(axis=0)
        got = float(away @ line / (line @ line))
        yield HandleCurvePoint("pull", fraction * step.fraction + 0.0, round(got, 12) + 0.0)


def _base_to_handle(document: Document) -> np.ndarray:
    """Vector from base to handle centre, scaled to the extent of the mesh along it."""
    base, handle = (
        document.initial_positions[document.labels == label].mean(axis=0) for label in (BASE, HANDLE)
    )
    axis = (handle - base) / np.linalg.norm(handle - base)
    whole: np.ndarray = axis * np.ptp(document.mesh.V @ axis)
    return whole


def draw_loss_curves(
    points: Sequence[LossCurvePoint], published: Sequence[tuple[float, float]], folder: Path
) -> None:
    """Draw ARAP's area change against the angle, with the paper's values.

    Parameters
    ----------
    published : sequence of (float, float)
        Degrees, and change of the area as a share.
    """

    def fill(figure: Figure) -> None:
        axes = figure.subplots()
        axes.set(title=tr("Area change by ARAP, %"), xlabel=tr("twist of the bottle, degrees"), xlim=(0, 180))
        axes.xaxis.set_major_locator(MultipleLocator(30))
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
    """Draw handle positions of the paper's method against their targets."""

    def fill(figure: Figure) -> None:
        left, right = figure.subplots(1, 2)
        left.set(title=tr("Twist: drift of the handle"), xlabel=tr("twist, degrees"))
        left.set_ylabel(tr("drift, % of the height"))
        left.xaxis.set_major_locator(MultipleLocator(30))
        left.plot(*_curve(points, "twist", 1.0), color=ORANGE, marker="^")
        left.set_ylim(bottom=0.0)
        asked, got = _curve(points, "pull", 100.0)
        right.set(title=tr("Pull and push: displacement reached"), xlabel=tr("requested, % of the height"))
        right.set_ylabel(tr("reached, % of the height"))
        right.plot(asked, asked, color=QUIET, linewidth=1.0, linestyle=(0, (4, 3)))
        beside: dict[str, Any] = {"textcoords": "offset points", "ha": "right"}
        right.annotate(tr("requested"), (asked[-1], asked[-1]), (-6, 0), va="center", color=QUIET, **beside)
        right.plot(asked, got, color=ORANGE, marker="^")
        end = asked[-1], got[-1]
        right.annotate(tr("reached with Eq. 8"), end, (-6, 8), va="bottom", color=INK, **beside)

    draw_figure(fill, _HANDLE_SIZE, folder, "handle")


def _curve(points: Sequence[HandleCurvePoint], motion: str, unit: float) -> tuple[list[float], list[float]]:
    own = [held for held in points if held.motion == motion]
    return [unit * held.asked for held in own], [100 * held.got for held in own]
