"""Curves of presses, sweeps, the paper's experiments and verification cases."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, MultipleLocator

from apd_viewer.cases.case import CaseStep
from apd_viewer.figures.style import BLUE, GREEN, INK, METHOD_STYLES, ORANGE, draw_figure, zero_line
from apd_viewer.geometry.solver.methods import METHODS
from apd_viewer.geometry.solver.plate_press import PressStep
from apd_viewer.geometry.solver.press_band import PressBand
from apd_viewer.geometry.solver.pressed_mesh import Pressed
from apd_viewer.language import tr
from apd_viewer.presentation import obstacle_readings
from apd_viewer.verification.verification_run import CaseRun

_PRESS_SIZE = (9.0, 3.9)
_BAND_POINTS = 400


def draw_press_curves(
    pressed: Pressed,
    path: Path,
    newtons: tuple[float, str] | None = None,
    band: PressBand | None = None,
) -> None:
    """Draw load and volume of a press; no volume if none is enclosed.

    Parameters
    ----------
    path : Path
        Path of the picture; its suffix is replaced.
    newtons : float and str, optional
        Newtons per load of 1, if known, and a phrase stating their conditions.
    band : PressBand, optional
        Runs with other dents, of which ``pressed`` is the first: the range of their loads is shaded.
    """
    scale = 1.0 if newtons is None else newtons[0]
    ways = [way for way in (pressed.steps, pressed.steps[-1:] + pressed.released) if len(way) > 1]
    charts = [(_load_title(pressed, newtons), lambda step: scale * step.load)]
    first = pressed.steps[0]
    if _volume(first):
        title = tr("Change of the volume within caps, %") if first.volume is None else tr("Volume change, %")
        charts.append((title, lambda step: 100 * (_volume(step) / _volume(first) - 1)))

    def fill(figure: Figure) -> None:
        panels = figure.subplots(1, len(charts), squeeze=False)[0]
        for axes, (title, reading) in zip(panels, charts, strict=True):
            axes.set_title(title)
            axes.set_xlabel(tr("deflection, in the unit of the mesh"))
            for way, style, name in zip(ways, ("-", "--"), (tr("closing"), tr("opening")), strict=False):
                x, y = [step.deflection for step in way], [reading(step) for step in way]
                axes.plot(x, y, style, marker="o", markersize=4, label=name)
            axes.margins(x=0.02, y=0.1)
        if band is not None:
            last = min(each.steps[-1].deflection for each in band.presses)
            places = np.linspace(0.0, last, _BAND_POINTS)
            loads = scale * band.loads(places)
            name = tr("{n} runs").format(n=len(loads))
            panels[0].fill_between(
                places, loads.min(axis=0), loads.max(axis=0), alpha=0.25, lw=0.0, label=name
            )
            panels[0].plot(places, loads.mean(axis=0), ":", label=tr("their mean"))
        if len(ways) > 1 or band is not None:
            panels[0].legend()
        if pressed.curve.yield_load is not None:
            place = pressed.curve.yield_deflection, scale * pressed.curve.yield_load
            panels[0].annotate(
                tr("yield"), place, xytext=(0, 8), textcoords="offset points", ha="center", va="bottom"
            )

    draw_figure(fill, _PRESS_SIZE, path.parent, path.stem)


def _load_title(found: Pressed, newtons: tuple[float, str] | None) -> str:
    """Two title lines: the load, and its expected error."""
    known = obstacle_readings.excess_phrase(found.load_excess)
    if newtons is None:
        return tr("Load, at stiffness 1") + f"\n{known}"
    return tr("Load, N, {conditions}").format(conditions=newtons[1]) + f"\n{known}"


def _volume(step: PressStep) -> float:
    """Enclosed volume, openings capped; 0 if none is enclosed."""
    return step.volume or step.volume_capped or 0.0


_LEVEL_SIZE = (6.4, 4.2)


def draw_fill_levels(
    curves: Mapping[str, np.ndarray],
    units: tuple[str, str],
    path: Path,
    filled: tuple[str, float, float] | None = None,
) -> None:
    """Draw the level of a liquid over its volume, up to the brim.

    Parameters
    ----------
    curves : mapping of str to (k, 2) float array
        Volumes and levels above the lowest point, of each shape by its name.
    units : (str, str)
        Of volumes and of levels; empty if unknown.
    path : Path
        Path of the picture; its suffix is replaced.
    filled : str, float and float, optional
        Words about a filled volume, it, and its level.
    """

    def fill(figure: Figure) -> None:
        axes = figure.subplots()
        names = [f", {unit}" if unit else tr(", in the unit of the mesh") for unit in units]
        axes.set_xlabel(tr("volume{unit}").format(unit=names[0]))
        axes.set_title(tr("Level above the lowest point{unit}").format(unit=names[1]))
        for (name, (volumes, levels)), style in zip(
            ((name, rows.T) for name, rows in curves.items()), ("-", "--"), strict=False
        ):
            (line,) = axes.plot(volumes, levels, style, label=name)
            axes.plot(volumes[-1:], levels[-1:], "o", color=line.get_color())
        if filled is not None:
            axes.annotate(
                filled[0], filled[1:], xytext=(8, -8), textcoords="offset points", ha="left", va="top"
            )
            axes.plot(*np.array(filled[1:])[:, None], "s", color="black")
        axes.set_xlim(left=0.0)
        axes.set_ylim(bottom=0.0)
        if len(curves) > 1:
            axes.legend()

    draw_figure(fill, _LEVEL_SIZE, path.parent, path.stem)


_SWEEP_SIZE = (11.0, 3.9)
_DENSE = 40  # largest number of steps drawn with markers; more would hide the curve
_TICKS = (1, 5, 10, 15, 30, 45, 60, 90, 180, 360)  # possible tick spacings in degrees
_FLAT = 1e-3  # percent; curves within this are drawn flat, to hide rounding


def draw_sweep_curves(
    steps: Sequence[CaseStep], abscissa: str, folder: Path, obstacles: Sequence[str] = ()
) -> None:
    """Draw the curves of a sweep; no volume if none is enclosed.

    Parameters
    ----------
    abscissa : str
        Quantity on the horizontal axis: see :attr:`apd_viewer.cases.case.Case.abscissa`.
    obstacles : sequence of str
        Names of the obstacles; each has a curve of its load.
    """
    charts = [
        (tr("Area change, %"), [100 * step.frame.area_error for step in steps]),
        (tr("Volume change, %"), [100 * (step.volume_error or 0.0) for step in steps]),
        (tr("ARAP energy"), [step.energy for step in steps]),
    ]
    if steps[0].volume_error is None:
        del charts[1]
    width = len(charts)
    charts += [
        (
            tr("Load on {name}, at stiffness 1").format(name=title),
            [step.loads[k] if step.loads else np.nan for step in steps],
        )
        for k, title in enumerate(obstacles)
    ]
    rows = -(-len(charts) // width)

    def fill(figure: Figure) -> None:
        panels = figure.subplots(rows, width, squeeze=False).ravel()
        for axes, (title, values) in zip(panels, charts, strict=False):
            axes.set_title(title)
            _curves(axes, steps, abscissa, np.array(values))
        for axes in panels[len(charts) :]:
            axes.set_axis_off()
        for axes in panels[: width - 1]:
            zero_line(axes)
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper left", ncols=len(labels), handlelength=3.2)

    draw_figure(fill, (_SWEEP_SIZE[0], rows * _SWEEP_SIZE[1]), folder, "sweep")


def _curves(axes: Axes, steps: Sequence[CaseStep], abscissa: str, values: np.ndarray) -> None:
    methods = np.array([step.method for step in steps])
    x = np.array([step.readings[abscissa] for step in steps]) * (100 if abscissa == "part" else 1)
    axes.set_xlabel(_axis(abscissa))
    axes.margins(x=0.02)
    for method in dict.fromkeys(methods.tolist()):
        own = methods == method
        look = dict(METHOD_STYLES[method])
        if own.sum() > _DENSE:
            look["marker"] = ""
        axes.plot(x[own], values[own], label=METHODS[method].short_title, **look)
    if np.nanmax(np.abs(values), initial=0.0) < _FLAT:
        axes.set_ylim(-0.1, 0.1)
    if abscissa == "degrees":
        span = float(np.ptp(x))
        axes.xaxis.set_major_locator(MultipleLocator(next((d for d in _TICKS if span <= 7 * d), span / 4)))


def _axis(abscissa: str) -> str:
    return {
        "degrees": tr("rotation of the handle, degrees"),
        "way": tr("displacement of the handle, in the unit of the mesh"),
        "part": tr("part of the motion, %"),
    }[abscissa]


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
