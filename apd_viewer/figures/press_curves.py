"""The curves of a press: load and volume against the deflection."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from apd_viewer.figures.style import draw
from apd_viewer.language import tr

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from apd_viewer.geometry.pressing.press import Pressed
    from apd_viewer.geometry.pressing.press_step import PressStep

_SIZE = (9.0, 3.9)


def draw_press(found: Pressed, path: Path, newtons: float | None = None) -> None:
    """Draw load and volume of a press; without volume where nothing is enclosed.

    Parameters
    ----------
    found : Pressed
    path : Path
        Of the picture; its ending is replaced.
    newtons : float, optional
        Of a load of 1, if it is known.
    """
    scale = 1.0 if newtons is None else newtons
    ways = [way for way in (found.steps, found.steps[-1:] + found.released) if len(way) > 1]
    title = tr("Load, at stiffness 1") if newtons is None else tr("Load, N, if walls bend and hardly stretch")
    said = [(title, lambda step: scale * _load(step))]
    first = found.steps[0]
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
            axes.margins(x=0.02)
        if len(ways) > 1:
            panels[0].legend()
        if found.curve.yield_load is not None:
            place = found.curve.yield_deflection, scale * found.curve.yield_load
            panels[0].annotate(
                tr("yield"), place, xytext=(0, 8), textcoords="offset points", ha="center", va="bottom"
            )

    draw(fill, _SIZE, path.parent, path.stem)


def _load(step: PressStep) -> float:
    return 0.5 * (step.load_low + step.load_high)


def _volume(step: PressStep) -> float:
    """Enclosed volume, openings capped; 0 where nothing is enclosed."""
    return step.volume or step.volume_capped or 0.0
