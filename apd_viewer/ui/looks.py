"""How the shape is looked at, beside the camera: overlays and all that helps to see."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING

from apd_viewer.ui.heat_map import HeatMap
from apd_viewer.ui.legend import Legend
from apd_viewer.ui.scales import Measure, Scale

if TYPE_CHECKING:
    from PySide6.QtWidgets import QWidget

    from apd_viewer.session.document import State
    from apd_viewer.session.units import Unit
    from apd_viewer.ui.canvas import Canvas
    from apd_viewer.ui.look_actions import LookActions
    from apd_viewer.ui.memory import Memory
    from apd_viewer.ui.theme import Theme


class Looks:
    """What belongs to the window, and not to the document: it is remembered from one start to the next.

    Parameters
    ----------
    canvas : Canvas
    memory : Memory
    others : sequence of QWidget
        On the canvas, which must not be covered.

    Attributes
    ----------
    heat : HeatMap
    legend : Legend
    """

    def __init__(self, canvas: Canvas, memory: Memory, others: Sequence[QWidget]) -> None:
        self._canvas, self._memory = canvas, memory
        self.legend = Legend(canvas.viewport, others)
        self.heat = HeatMap(canvas, self.legend, _recalled(memory.looks))

    @property
    def verbs(self) -> dict[str, Callable[..., object]]:
        """What can be done, by name."""
        return {
            "measure": self.heat.choose,
            "no_measure": partial(self.heat.choose, None),
            "worst": self.heat.next_worst,
        }

    def start(self, actions: LookActions) -> None:
        """Look as before, and keep the actions in step."""
        self._actions = actions
        name = self._memory.looks.get("overlay")
        if name in {measure.value for measure in Measure}:
            self.heat.choose(Measure(name))
        self.heat.changed.connect(self._keep)
        self._keep()

    def follow(self, state: State) -> None:
        """Look at another mesh."""
        self.heat.follow(state.document.mesh)

    def measure_in(self, unit: Unit) -> None:
        """Write lengths in another unit."""
        self.heat.measure_in(unit)

    def set_theme(self, theme: Theme) -> None:
        """Redraw what the style sheet does not reach."""
        self.legend.set_theme(theme)

    def close(self) -> None:
        """End what is under way."""
        self.heat.close()

    def _keep(self) -> None:
        measure = self.heat.measure
        self._actions.show_measure(measure)
        looks = {"overlay": "" if measure is None else measure.value}
        for scale in self.heat.scales.values():
            if scale.travels:
                looks[scale.measure.value] = f"{scale.reach:g} {scale.neutral:g}"
        self._memory.looks = looks


def _recalled(looks: dict[str, str]) -> dict[Measure, Scale]:
    """The scales that were set, as far as they can be read: anybody may have edited them."""
    scales = {}
    for measure in Measure:
        try:
            reach, neutral = map(float, looks.get(measure.value, "").split())
        except ValueError:
            continue
        if 0.0 < reach < 1e9 and 0.0 <= neutral < 1e9:
            scales[measure] = Scale(measure, reach, neutral)
    return scales
