"""Display options: overlays and aids besides the camera."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from apd_viewer.presentation.scales import Measure, Scale
from apd_viewer.ui.appearance.shading import AMBER
from apd_viewer.ui.overlays.before_after import BeforeAfter
from apd_viewer.ui.overlays.card_stack import Cards
from apd_viewer.ui.overlays.cutting_plane import CuttingPlane
from apd_viewer.ui.overlays.deviation_overlay import HeatMap
from apd_viewer.ui.overlays.document_measures import DocumentMeasures
from apd_viewer.ui.overlays.legend import Legend
from apd_viewer.ui.scene.ghost import Ghost
from apd_viewer.ui.scene.ground import Ground
from apd_viewer.ui.tools.turntable import Turntable

if TYPE_CHECKING:
    from PySide6.QtWidgets import QWidget

    from apd_viewer.geometry.mesh.texture import Texture
    from apd_viewer.session.model.state import State
    from apd_viewer.session.quantities.units import Unit
    from apd_viewer.ui.preferences.preferences import Preferences
    from apd_viewer.ui.tools.canvas import Canvas
    from apd_viewer.ui.widgets.theme import Theme


class Looks:
    """Display options of the window, kept from one start to the next.

    Parameters
    ----------
    canvas : Canvas
    memory : Preferences
    below : sequence of QWidget
        At the bottom of the canvas, which must not be covered.

    Attributes
    ----------
    cards : Cards
    legend : Legend
    heat : HeatMap
    before_after : BeforeAfter
    cut : CuttingPlane
    ghost, target_ghost : Ghost
        The rest shape and the target shape.
    ground : Ground
    turntable : Turntable
    file_colors : bool
        Whether the vertex colours of the file are shown.
    textures : bool
        Whether its textures are.
    """

    def __init__(self, canvas: Canvas, memory: Preferences, below: Sequence[QWidget]) -> None:
        self._canvas, self._memory = canvas, memory
        self._texture: Texture | None = None
        self.cards = Cards(canvas.viewport, below)
        self.before_after, self.cut, self.legend = BeforeAfter(canvas), CuttingPlane(canvas), Legend()
        self.cards.add(self.before_after)
        self.cards.add(self.cut)
        self.cards.add(self.legend, self.legend.fit_into)
        self.ghost, self.ground = Ghost(canvas.viewport), Ground(canvas.viewport)
        self.target_ghost = Ghost(canvas.viewport, AMBER)
        self.heat = HeatMap(canvas, self.legend, self.cards.geometry, _recalled(memory.looks))
        self.turntable = Turntable(canvas.viewport)
        self._recall()
        self.heat.changed.connect(self._keep)
        self._keep()

    def show_ghost(self, on: bool) -> None:
        """Show the rest shape around the mesh, or hide it."""
        self.ghost.on = on
        self._keep()

    def show_target(self, on: bool) -> None:
        """Show the target shape around the mesh, or hide it."""
        self.target_ghost.on = on
        self._keep()

    def show_ground(self, on: bool) -> None:
        """Show axes and grid, or hide them."""
        self.ground.on = on
        self._keep()

    def show_file_colors(self, on: bool) -> None:
        """Show the vertex colours of the file under the paint, or hide them."""
        self.file_colors = on
        self._canvas.coloring.show_file(on)
        self._keep()

    def show_textures(self, on: bool) -> None:
        """Show the texture of the file under the paint, or hide it."""
        self.textures = on
        self._canvas.surface.texture = self._texture if on else None
        self._keep()

    def turn(self, on: bool) -> None:
        """Start or stop the turntable."""
        self.turntable.on = on

    def follow(self, state: State) -> None:
        """Look at another mesh, or compare with another target shape."""
        mesh, target = state.document.mesh, state.document.target
        for part in (self.ghost, self.ground, self.before_after, self.cut):
            part.follow(mesh)
        self.heat.follow(mesh, target)
        self._follow_document(state)
        self._texture = mesh.texture[0]
        self.show_textures(self.textures)
        self.target_ghost.follow(None if target is None else target.mesh)

    def _follow_document(self, state: State) -> None:
        document = state.document
        measures = DocumentMeasures.of(document, state.keeps_apart)
        self.heat.follow_document(document.labels, measures)

    def measure_in(self, unit: Unit) -> None:
        """Write lengths in another unit."""
        for part in (self.heat, self.ground, self.cut):
            part.measure_in(unit)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the parts beyond the style sheet's reach."""
        for part in (self.legend, self.before_after, self.cut):
            part.set_theme(theme)

    def close(self) -> None:
        """Cancel pending work."""
        self.turntable.on = False
        self.heat.close()

    def _recall(self) -> None:
        looks = self._memory.looks
        if looks.get("overlay") in {measure.value for measure in Measure}:
            self.heat.choose(Measure(looks["overlay"]))
        self.ghost.on = looks.get("ghost") == "on"
        self.target_ghost.on = looks.get("target_ghost", "on") == "on"
        self.ground.on = looks.get("ground") == "on"
        self.file_colors = looks.get("file_colors") == "on"
        self.textures = looks.get("textures") == "on"
        self._canvas.coloring.show_file(self.file_colors)

    def _keep(self) -> None:
        """Store the options, except the plane's place on this mesh."""
        measure = self.heat.measure
        self._canvas.coloring.cover(measure is not None or self._canvas.surface.texture is not None)
        looks = {
            "overlay": "" if measure is None else measure.value,
            "ghost": "on" if self.ghost.on else "",
            "target_ghost": "on" if self.target_ghost.on else "",
            "ground": "on" if self.ground.on else "",
            "file_colors": "on" if self.file_colors else "",
            "textures": "on" if self.textures else "",
        }
        for scale in self.heat.scales.values():
            if scale.travels:
                looks[scale.measure.value] = f"{scale.reach:g} {scale.neutral:g}"
        self._memory.looks = looks


def _recalled(looks: dict[str, str]) -> dict[Measure, Scale]:
    """Stored scales, as far as valid: the file may be edited by hand."""
    scales = {}
    for measure in Measure:
        try:
            reach, neutral = map(float, looks.get(measure.value, "").split())
        except ValueError:
            continue
        if 0.0 < reach < 1e9 and 0.0 <= neutral < 1e9:
            scales[measure] = Scale(measure, reach, neutral)
    return scales
