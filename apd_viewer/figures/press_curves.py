"""The curves of a press: load and volume against the deflection."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from apd_viewer.figures.style import draw_figure
from apd_viewer.geometry.pressing.press_step import PressStep
from apd_viewer.geometry.pressing.pressed_mesh import Pressed
from apd_viewer.language import tr
from apd_viewer.presentation import obstacle_readings

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_SIZE = (9.0, 3.9)


def draw_press_curves(pressed: Pressed, path: Path, newtons: tuple[float, float] | None = None) -> None:
    """Draw load and volume of a press; without volume where nothing is enclosed.

    Parameters
    ----------
    pressed : Pressed
    path : Path
        Of the picture; its ending is replaced.
    newtons : two floats, optional
        Of a load of 1, if it is known, and the factor by which they may be too low.
    """
    scale = 1.0 if newtons is None else newtons[0]
    ways = [way for way in (pressed.steps, pressed.steps[-1:] + pressed.released) if len(way) > 1]
    said = [(_load_title(pressed, newtons), lambda step: scale * _load(step))]
    first = pressed.steps[0]
    if _volume(first):
        title = tr("Change of the volume within caps, %") if first.volume is None else tr("Volume change, %")
        said.append((title, lambda step: 100 * (_volume(step) / _volume(first) - 1)))

    def fill(figure: Figure) -> None:
        panels = figure.subplots(1, len(said), squeeze=False)[0]
        for axes, (title, reading) in zip(panels, said, strict=True):
            axes.set_title(title)
            axes.set_xlabel(tr("deflection, in the unit of the mesh"))
            for way, style, name in zip(ways, ("-", "--"), (tr("closing"), tr("opening")), strict=False):
                x, y = [step.deflection for step in way], [reading(step) for step in way]
                axes.plot(x, y, style, marker="o", markersize=4, label=name)
            axes.margins(x=0.02, y=0.1)
        if len(ways) > 1:
            panels[0].legend()
        if pressed.curve.yield_load is not None:
            place = pressed.curve.yield_deflection, scale * pressed.curve.yield_load
            panels[0].annotate(
                tr("yield"), place, xytext=(0, 8), textcoords="offset points", ha="center", va="bottom"
            )

    draw_figure(fill, _SIZE, path.parent, path.stem)


def _load_title(found: Pressed, newtons: tuple[float, float] | None) -> str:
    """Two lines: the load, and by how much it is expected to be off."""
    known = obstacle_readings.excess_phrase(found.load_excess)
    if newtons is None:
        return tr("Load, at stiffness 1") + f"\n{known}"
    off = obstacle_readings.error_factor_phrase(newtons[1])
    title = tr("Load, N, {off}").format(off=off) if off else tr("Load, N, if walls bend and hardly stretch")
    return f"{title}\n{known}"


def _load(step: PressStep) -> float:
    return 0.5 * (step.load_low + step.load_high)


def _volume(step: PressStep) -> float:
    """Enclosed volume, openings capped; 0 where nothing is enclosed."""
    return step.volume or step.volume_capped or 0.0
