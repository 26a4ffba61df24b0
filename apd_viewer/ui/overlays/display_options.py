"""How the shape is looked at, beside the camera: overlays and all that helps to see."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING

from apd_viewer.presentation.scales import Measure, Scale
from apd_viewer.ui.overlays.before_after import BeforeAfter
from apd_viewer.ui.overlays.card_stack import Cards
from apd_viewer.ui.overlays.cutting_plane import CuttingPlane
from apd_viewer.ui.overlays.deviation_overlay import HeatMap
from apd_viewer.ui.overlays.legend import Legend
from apd_viewer.ui.preferences.shortcut_hints import name_keys
from apd_viewer.ui.scene.ghost import Ghost
from apd_viewer.ui.scene.ground import Ground
from apd_viewer.ui.scene.turntable import Turntable

if TYPE_CHECKING:
    from PySide6.QtWidgets import QWidget

    from apd_viewer.session.model.document import State
    from apd_viewer.session.quantities.units import Unit
    from apd_viewer.ui.actions.display_actions import LookActions
    from apd_viewer.ui.preferences.preferences import Memory
    from apd_viewer.ui.scene.rest_actor import RestActor
    from apd_viewer.ui.tools.canvas import Canvas
    from apd_viewer.ui.widgets.theme import Theme

# What is as it was at the next start; where a plane cuts, only the mesh at hand can tell.
_REMEMBERED = "ghost", "ground"


class Looks:
    """What belongs to the window, and not to the document: it is remembered from one start to the next.

    Parameters
    ----------
    canvas : Canvas
    memory : Memory
    below : sequence of QWidget
        At the bottom of the canvas, which must not be covered.

    Attributes
    ----------
    cards : Cards
    legend : Legend
    heat : HeatMap
    before_after : BeforeAfter
    cut : CuttingPlane
    ghost : Ghost
    ground : Ground
    turntable : Turntable
    """

    def __init__(self, canvas: Canvas, memory: Memory, below: Sequence[QWidget]) -> None:
        self._canvas, self._memory = canvas, memory
        self.cards = Cards(canvas.viewport, below)
        self.before_after, self.cut, self.legend = BeforeAfter(canvas), CuttingPlane(canvas), Legend()
        self.cards.add(self.before_after)
        self.cards.add(self.cut)
        self.cards.add(self.legend, self.legend.fit_into)
        self.ghost, self.ground = Ghost(canvas.viewport), Ground(canvas.viewport)
        self.heat = HeatMap(canvas, self.legend, self.cards.geometry, _recalled(memory.looks))
        self.turntable = Turntable(canvas.viewport)
        self._actions: LookActions | None = None

    @property
    def verbs(self) -> dict[str, Callable[..., object]]:
        """What can be done, by name."""
        return {
            "measure": self.heat.choose,
            "no_measure": partial(self.heat.choose, None),
            "worst": self.heat.next_worst,
            "ghost": partial(self._switch, self.ghost),
            "ground": partial(self._switch, self.ground),
            "compare": self.before_after.show_card,
            "cut": self.cut.show_card,
            "turntable": partial(setattr, self.turntable, "on"),
        }

    def start(self, actions: LookActions) -> None:
        """Look as before, and keep the actions in step."""
        looks = self._memory.looks
        if looks.get("overlay") in {measure.value for measure in Measure}:
            self.heat.choose(Measure(looks["overlay"]))
        for name in _REMEMBERED:
            actions.switches[name].setChecked(looks.get(name) == "on")
        self._actions = actions
        name_keys(self.legend.close_button, actions.off)
        name_keys(self.legend.worst, actions.worst[0])
        name_keys(self.cut.close_button, actions.switches["cut"])
        self.heat.changed.connect(self._keep)
        self.before_after.dismissed.connect(partial(actions.switches["compare"].setChecked, False))
        self.cut.dismissed.connect(partial(actions.switches["cut"].setChecked, False))
        self.turntable.stopped.connect(partial(actions.switches["turntable"].setChecked, False))
        self._keep()

    def follow(self, state: State) -> None:
        """Look at another mesh."""
        for part in (self.heat, self.ghost, self.ground, self.before_after, self.cut):
            part.follow(state.document.mesh)

    def measure_in(self, unit: Unit) -> None:
        """Write lengths in another unit."""
        for part in (self.heat, self.ground, self.cut):
            part.measure_in(unit)

    def set_theme(self, theme: Theme) -> None:
        """Redraw what the style sheet does not reach."""
        for part in (self.legend, self.before_after, self.cut):
            part.set_theme(theme)

    def close(self) -> None:
        """End what is under way."""
        self.turntable.on = False
        self.heat.close()

    def _switch(self, part: RestActor, on: bool) -> None:
        part.on = on
        self._keep()

    def _keep(self) -> None:
        if self._actions is None:
            return  # it is still looking as before
        measure = self.heat.measure
        self._actions.show_measure(measure)
        looks = {"overlay": "" if measure is None else measure.value}
        looks |= {name: "on" if self._actions.switches[name].isChecked() else "" for name in _REMEMBERED}
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
