"""Display options of the window, and the cards for them over the canvas."""

import time
from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QObject, Qt, QTimer, Signal
from PySide6.QtGui import QFocusEvent, QMouseEvent
from PySide6.QtWidgets import QButtonGroup, QFrame, QGridLayout, QLabel, QToolButton, QWidget

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.texture import Texture
from apd_viewer.language import tr
from apd_viewer.presentation.number_format import format_position
from apd_viewer.presentation.scales import Measure, Scale
from apd_viewer.session.model.state import State
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.overlays.card_stack import CardStack
from apd_viewer.ui.overlays.deviation_overlay import DeviationOverlay, DocumentMeasures
from apd_viewer.ui.overlays.legend import Legend
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.scene.camera import DEGREES_PER_PIXEL
from apd_viewer.ui.scene.ghost import Ghost
from apd_viewer.ui.scene.ground import Ground, GroundShadow
from apd_viewer.ui.scene.navigation import MouseTool
from apd_viewer.ui.scene.surface_shading import AMBER_GLASS_SHADER, Finish
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.widgets.box_layouts import STRETCH, row_layout
from apd_viewer.ui.widgets.fields import small_button
from apd_viewer.ui.widgets.slider_field import Slider, SliderScale
from apd_viewer.ui.widgets.theme import LIGHT, Theme, icon
from apd_viewer.ui.widgets.wheel import block_mouse_events

SPEED = 24.0  # degrees a second
_TICK = 16  # ms between frames
_LONGEST = 0.1  # s: longest time step, so that the camera does not jump after a pause


class Turntable(MouseTool, QObject):
    """Animation that orbits the camera until a tool is used."""

    stopped = Signal()

    def __init__(self, viewport: Viewport) -> None:
        super().__init__(viewport)
        self._viewport = viewport
        self._last = 0.0
        self._timer = QTimer(self, interval=_TICK, timeout=self._turn)
        viewport.tools.insert(0, self)

    @property
    def is_running(self) -> bool:
        """True while the camera orbits."""
        return self._timer.isActive()

    @is_running.setter
    def is_running(self, on: bool) -> None:
        self._last = time.perf_counter()
        if on:
            self._timer.start()
        else:
            self._timer.stop()

    def press(self, _: QMouseEvent) -> bool:
        """Stop the animation, without consuming the press."""
        self._stop()
        return False

    def cancel(self) -> bool:
        """Stop the animation, without consuming the command."""
        self._stop()
        return False

    def _stop(self) -> None:
        if self.is_running:
            self.is_running = False
            self.stopped.emit()

    def _turn(self) -> None:
        now = time.perf_counter()
        angle = SPEED * float(np.clip(now - self._last, 0.0, _LONGEST))
        self._last = now
        self._viewport.camera_controller.camera = self._viewport.camera_controller.camera.orbited(
            angle / DEGREES_PER_PIXEL, 0.0
        )


class DisplayOptions:
    """Display options of the window, stored between sessions.

    Parameters
    ----------
    below : sequence of QWidget
        Widgets at the bottom of the canvas, not to be covered.

    Attributes
    ----------
    ghost, target_ghost : Ghost
        The rest shape and the target shape.
    orientation : OrientationAxes
        In the corner of the view.
    shows_file_colors : bool
        Whether the vertex colours of the file are shown.
    shows_textures : bool
        Whether its textures are shown.
    picture : Texture or None
        Of a region; :meth:`show_textures` shows it instead of the textures.
    """

    def __init__(self, canvas: Canvas, preferences: Preferences, below: Sequence[QWidget]) -> None:
        self._canvas, self._memory = canvas, preferences
        self._texture: Texture | None = None
        self.picture: Texture | None = None
        self.cards = CardStack(canvas.viewport, below)
        self.before_after, self.cutting_plane, self.legend = (
            BlendCard(canvas),
            CuttingPlaneCard(canvas),
            Legend(),
        )
        self.cards.add(self.before_after)
        self.cards.add(self.cutting_plane)
        self.cards.add(self.legend, self.legend.fit_into)
        self.ghost, self.ground = Ghost(canvas.viewport), Ground(canvas.viewport)
        self.shadow = GroundShadow(canvas.viewport, canvas.surface)
        self.target_ghost = Ghost(canvas.viewport, AMBER_GLASS_SHADER)
        self.orientation = canvas.orientation
        self.overlay = DeviationOverlay(
            canvas, self.legend, self.cards.geometry, _stored_scales(preferences.display_options)
        )
        self.turntable = Turntable(canvas.viewport)
        self._recall()
        self.overlay.changed.connect(self._store_options)
        self._store_options()

    def show_ghost(self, on: bool) -> None:
        """Show the rest shape around the mesh, or hide it."""
        self.ghost.visible = on
        self._store_options()

    def show_target(self, on: bool) -> None:
        """Show the target shape around the mesh, or hide it."""
        self.target_ghost.visible = on
        self._store_options()

    def show_ground(self, on: bool) -> None:
        """Show axes and grid, or hide them."""
        self.ground.visible = on
        self._store_options()

    def show_shadow(self, on: bool) -> None:
        """Show the shadow on the ground, or hide it."""
        self.shadow.visible = on
        self._store_options()

    def show_orientation(self, on: bool) -> None:
        """Show the axes in the corner, or hide them."""
        self.orientation.visible = on
        self._store_options()

    def show_file_colors(self, on: bool) -> None:
        """Show the vertex colours of the file under the paint, or hide them."""
        self.shows_file_colors = on
        self._canvas.coloring.show_file_colors(on)
        self._store_options()

    def show_textures(self, on: bool) -> None:
        """Show the texture of the file under the paint, or hide it."""
        self.shows_textures = on
        of_file = self._texture if on else None
        self._canvas.surface.texture = of_file if self.picture is None else self.picture
        self._store_options()

    @property
    def finish(self) -> Finish:
        """Finish of the mesh."""
        return self._canvas.surface.finish

    def choose_finish(self, finish: Finish) -> None:
        """Show the mesh in a finish."""
        self._canvas.surface.set_finish(finish)
        self._store_options()

    def set_turntable_running(self, on: bool) -> None:
        """Start or stop the turntable."""
        self.turntable.is_running = on

    def follow_state(self, state: State) -> None:
        """Apply the options to the mesh and the target shape of a state."""
        mesh, target = state.document.mesh, state.document.target_shape
        for part in (self.ghost, self.ground, self.before_after, self.cutting_plane):
            part.set_mesh(mesh)
        self.overlay.set_mesh(mesh, target)
        self._follow_document(state)
        self._texture = mesh.texture[0]
        self.show_textures(self.shows_textures)
        self.target_ghost.set_mesh(None if target is None else target.mesh)

    def _follow_document(self, state: State) -> None:
        document = state.document
        measures = DocumentMeasures.from_document(document, state.is_contact_active)
        self.overlay.follow_document(document.labels, measures)

    def set_unit(self, unit: Unit) -> None:
        """Set the length unit of the ground grid, the overlay and the cutting plane."""
        for part in (self.overlay, self.ground, self.cutting_plane):
            part.set_unit(unit)

    def set_theme(self, theme: Theme) -> None:
        """Redraw icons and colours not covered by the style sheet."""
        for part in (self.legend, self.before_after, self.cutting_plane):
            part.set_theme(theme)

    def close(self) -> None:
        """Cancel pending work."""
        self.turntable.is_running = False
        self.overlay.close()

    def _recall(self) -> None:
        looks = self._memory.display_options
        if looks.get("overlay") in {measure.value for measure in Measure}:
            self.overlay.choose_measure(Measure(looks["overlay"]))
        self.ghost.visible = looks.get("ghost") == "on"
        self.target_ghost.visible = looks.get("target_ghost", "on") == "on"
        self.ground.visible = looks.get("ground") == "on"
        self.shadow.visible = looks.get("shadow", "on") == "on"
        self.orientation.visible = looks.get("orientation", "on") == "on"
        self.shows_file_colors = looks.get("file_colors") == "on"
        self.shows_textures = looks.get("textures") == "on"
        if looks.get("finish") in {finish.value for finish in Finish}:
            self._canvas.surface.set_finish(Finish(looks["finish"]))
        self._canvas.coloring.show_file_colors(self.shows_file_colors)

    def _store_options(self) -> None:
        """Store the options in the preferences, except the cutting plane."""
        measure = self.overlay.measure
        self._canvas.coloring.suppress_file_colors(
            measure is not None or self._canvas.surface.texture is not None
        )
        looks = {
            "overlay": "" if measure is None else measure.value,
            "ghost": "on" if self.ghost.visible else "",
            "target_ghost": "on" if self.target_ghost.visible else "",
            "ground": "on" if self.ground.visible else "",
            "shadow": "on" if self.shadow.visible else "",
            "orientation": "on" if self.orientation.visible else "",
            "file_colors": "on" if self.shows_file_colors else "",
            "textures": "on" if self.shows_textures else "",
            "finish": self.finish.value,
        }
        for scale in self.overlay.scales.values():
            if scale.fits_any_size:
                looks[scale.measure.value] = f"{scale.reach:g} {scale.neutral:g}"
        self._memory.display_options = looks


def _stored_scales(looks: dict[str, str]) -> dict[Measure, Scale]:
    """Scales read from stored options; invalid ones are skipped."""
    scales = {}
    for measure in Measure:
        try:
            reach, neutral = map(float, looks.get(measure.value, "").split())
        except ValueError:
            continue
        if 0.0 < reach < 1e9 and 0.0 <= neutral < 1e9:
            scales[measure] = Scale(measure, reach, neutral)
    return scales


_WHOLE = 200
_BLENDS = SliderScale(_WHOLE, lambda step: step / _WHOLE, lambda fraction: fraction * _WHOLE, _WHOLE)


class _ReturningSlider(Slider):
    """Slider returning to its end on release."""

    def __init__(self) -> None:
        super().__init__(_BLENDS)
        self.setPageStep(_WHOLE // 4)
        self.go_back()
        for end in (self.sliderReleased, self.drag_cancelled, self.neutral_requested):
            end.connect(self.go_back)

    def go_back(self) -> None:
        """Return the slider to its end, showing the deformed shape."""
        self.setValue(_WHOLE)

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Return the slider to its end after keyboard use."""
        super().focusOutEvent(event)
        self.go_back()


class BlendCard(QFrame):
    """Card with a slider to blend the rest shape and the deformed shape."""

    dismissed = Signal()

    def __init__(self, canvas: Canvas) -> None:
        super().__init__(objectName="card", accessibleName=tr("Before and after"))
        block_mouse_events(self)
        self._canvas = canvas
        self._mesh: Mesh | None = None
        self.slider = _ReturningSlider()
        self.slider.setAccessibleName(tr("Path from rest"))
        self.slider.setToolTip(tr("Drag to see the path from rest; release to see the current shape"))
        self.slider.valueChanged.connect(self._blend)
        self.close_button = small_button(tr("Close before and after"), tr("Close"))
        self.close_button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.close_button.clicked.connect(self.dismissed)
        grid = QGridLayout(self, horizontalSpacing=8, verticalSpacing=4)
        grid.setContentsMargins(12, 10, 12, 10)
        grid.addWidget(QLabel(tr("Before and after"), objectName="heading"), 0, 0, 1, 2)
        grid.addWidget(self.close_button, 0, 2, Qt.AlignmentFlag.AlignRight)
        grid.addWidget(QLabel(tr("Rest"), objectName="quiet"), 1, 0)
        grid.addWidget(self.slider, 1, 1)
        grid.addWidget(QLabel(tr("Now"), objectName="quiet"), 1, 2)
        grid.setColumnStretch(1, 1)
        self.set_theme(LIGHT)
        self.hide()

    def show_card(self, on: bool) -> None:
        """Show or hide the card."""
        self.slider.go_back()
        self.setVisible(on)

    def set_mesh(self, mesh: Mesh) -> None:
        """Reset the slider for another mesh."""
        if mesh is not self._mesh:
            self._mesh = mesh
            self.slider.go_back()

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icon."""
        self.close_button.setIcon(icon("cancel", theme))

    def _blend(self, value: int) -> None:
        if self._mesh is not None:
            rest = None if value == _WHOLE else self._mesh.V
            self._canvas.surface.blend(rest, value / _WHOLE)


_STEPS = 400
_POSITIONS = SliderScale(_STEPS, lambda step: step / _STEPS, lambda fraction: fraction * _STEPS, _STEPS // 2)


class CuttingPlaneCard(QFrame):
    """Card for a plane that cuts the mesh open: its axis, position and visible side.

    Attributes
    ----------
    measure_requested : Signal(object, object)
        Point and normal (3,) of the plane, whose section is to be measured.
    place : QLabel
        Of the plane along its axis.
    """

    dismissed = Signal()
    measure_requested = Signal(object, object)

    def __init__(self, canvas: Canvas) -> None:
        super().__init__(objectName="card", accessibleName=tr("Section"))
        block_mouse_events(self)
        self._canvas = canvas
        self._unit = Unit.NONE
        self._low, self._high = np.zeros(3), np.ones(3)
        self._mesh: Mesh | None = None
        self._group = QButtonGroup(self)
        self.axes = tuple(self._axis_button(k, name) for k, name in enumerate("XYZ"))
        self.axes[2].setChecked(True)
        self._group.idClicked.connect(lambda _: self._cut())
        self.flip = small_button(tr("Flip"), tr("Show the other side of the plane"))
        self.flip.setCheckable(True)
        self.flip.toggled.connect(self._cut)
        self.measure = small_button(tr("Measure section"), tr("Measure length and area of this section"))
        self.measure.clicked.connect(lambda: self.measure_requested.emit(*self.plane))
        self.slider = Slider(_POSITIONS)
        self.slider.setValue(_STEPS // 2)
        self.slider.neutral_requested.connect(lambda: self.slider.setValue(_STEPS // 2))
        self.slider.setAccessibleName(tr("Section position"))
        self.slider.valueChanged.connect(self._cut)
        self.place = QLabel()
        self.close_button = small_button(tr("Close section"), tr("Show the whole shape"))
        self.close_button.clicked.connect(self.dismissed)
        for button in (self.close_button, self.flip, self.measure, *self.axes):
            button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self._lay_out()
        self.set_theme(LIGHT)
        self.hide()

    def _axis_button(self, number: int, name: str) -> QToolButton:
        button = QToolButton(text=name, objectName="axis", checkable=True)
        button.setToolTip(tr("Cut perpendicular to {axis}").format(axis=name))
        button.setAccessibleName(button.toolTip())
        self._group.addButton(button, number)
        return button

    def _lay_out(self) -> None:
        row = row_layout(*self.axes, self.flip, self.measure, STRETCH, self.place, spacing=4)
        grid = QGridLayout(self, verticalSpacing=6)
        grid.setContentsMargins(12, 10, 12, 10)
        grid.addWidget(QLabel(tr("Section"), objectName="heading"), 0, 0)
        grid.addWidget(self.close_button, 0, 1, Qt.AlignmentFlag.AlignRight)
        grid.addLayout(row, 1, 0, 1, 2)
        grid.addWidget(self.slider, 2, 0, 1, 2)

    def show_card(self, on: bool) -> None:
        """Cut the shape and show the card, or restore the shape and hide it."""
        self.setVisible(on)
        self._cut()

    def set_mesh(self, mesh: Mesh) -> None:
        """Set the mesh to cut; the bounding box of its rest shape limits the plane."""
        if mesh is not self._mesh:
            self._mesh = mesh
            used = mesh.V[mesh.F.ravel()]
            low, high = used.min(axis=0), used.max(axis=0)
            # A deformed shape may extend beyond the box of the rest shape.
            room = 0.5 * float(np.linalg.norm(high - low)) - 0.5 * (high - low)
            self._low, self._high = low - room, high + room
            self._cut()

    def set_unit(self, unit: Unit) -> None:
        """Set the length unit of the displayed plane position."""
        self._unit = unit
        self._cut()

    @property
    def plane(self) -> tuple[np.ndarray, np.ndarray]:
        """Point (3,) of the plane and normal (3,) towards the visible side."""
        axis, fraction = self._group.checkedId(), self.slider.value() / _STEPS
        point = (self._low + self._high) / 2
        point[axis] = self._low[axis] + fraction * (self._high[axis] - self._low[axis])
        normal = np.zeros(3)
        normal[axis] = 1.0 if self.flip.isChecked() else -1.0
        return point, normal

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        self.close_button.setIcon(icon("cancel", theme))
        self.flip.setIcon(icon("mirror", theme))
        self.measure.setIcon(icon("measure", theme))

    def _cut(self) -> None:
        point, normal = self.plane
        axis = self._group.checkedId()
        step = float(self._high[axis] - self._low[axis]) / _STEPS
        self.place.setText(self._unit.format_length(format_position(float(point[axis]), step)))
        if self._mesh is None or self.isHidden():
            self._canvas.surface.cut(None)
        else:
            self._canvas.surface.cut(point, normal)
