"""Cutting plane: the surface behind it is not drawn."""

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QButtonGroup, QFrame, QGridLayout, QLabel, QToolButton

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr
from apd_viewer.presentation.number_format import format_position
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.widgets.box_layouts import STRETCH, row_layout
from apd_viewer.ui.widgets.fields import small_button
from apd_viewer.ui.widgets.slider_field import Slider, SliderScale
from apd_viewer.ui.widgets.theme import LIGHT, Theme, icon
from apd_viewer.ui.widgets.wheel import block_mouse_events

_STEPS = 400
_SCALE = SliderScale(_STEPS, lambda step: step / _STEPS, lambda share: share * _STEPS, _STEPS // 2)


class CuttingPlane(QFrame):
    """Card with the plane's axis, position and side.

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
        self.slider = Slider(_SCALE)
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

    def follow(self, mesh: Mesh) -> None:
        """Set the mesh to cut; the box around its rest shape bounds the plane."""
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
        axis, share = self._group.checkedId(), self.slider.value() / _STEPS
        point = (self._low + self._high) / 2
        point[axis] = self._low[axis] + share * (self._high[axis] - self._low[axis])
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
