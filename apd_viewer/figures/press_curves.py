"""The curves of a press: load and volume against the deflection."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from apd_viewer.figures.style import draw
from apd_viewer.language import tr

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from apd_viewer.geometry.pressing.press import Pressed

_SIZE = (9.0, 3.9)


def draw_press(found: Pressed, path: Path) -> None:
    """Draw load and volume of a press; without volume where the surface is open.

    Parameters
    ----------
    found : Pressed
    path : Path
        Of the picture; its ending is replaced.
    """
    steps = found.steps
    x = [step.deflection for step in steps]
    said = [(tr("Load, at stiffness 1"), [0.5 * (step.load_low + step.load_high) for step in steps])]
    volumes = [step.volume if step.volume is not None else step.volume_capped for step in steps]
    if volumes[0]:
        change = [100 * ((volume or 0.0) / volumes[0] - 1.0) for volume in volumes]
        said.append((tr("Volume change, %"), change))

    def fill(figure: Figure) -> None:
        panels = figure.subplots(1, len(said), squeeze=False)[0]
        for axes, (title, values) in zip(panels, said, strict=True):
            axes.set_title(title)
            axes.set_xlabel(tr("deflection, in the unit of the mesh"))
            axes.plot(x, values, marker="o", markersize=4)
            axes.margins(x=0.02)
        if found.curve.yield_load is not None:
            place = found.curve.yield_deflection, found.curve.yield_load
            panels[0].annotate(
                tr("yield"), place, xytext=(0, 8), textcoords="offset points", ha="center", va="bottom"
            )

    draw(fill, _SIZE, path.parent, path.stem)
