"""Before-and-after slider: the shape between rest and now."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QFocusEvent
from PySide6.QtWidgets import QFrame, QGridLayout, QLabel

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.widgets.event_barrier import shield
from apd_viewer.ui.widgets.fields import small_button
from apd_viewer.ui.widgets.icons import icon
from apd_viewer.ui.widgets.slider import Slider, SliderScale
from apd_viewer.ui.widgets.theme import LIGHT, Theme

_WHOLE = 200
_SCALE = SliderScale(_WHOLE, lambda step: step / _WHOLE, lambda share: share * _WHOLE, _WHOLE)


class _Held(Slider):
    """Slider returning to its end on release."""

    def __init__(self) -> None:
        super().__init__(_SCALE)
        self.setPageStep(_WHOLE // 4)
        self.go_back()
        for end in (self.sliderReleased, self.drag_cancelled, self.neutral_requested):
            end.connect(self.go_back)

    def go_back(self) -> None:
        """Show the shape as it is."""
        self.setValue(_WHOLE)

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Return to the end after use by keys."""
        super().focusOutEvent(event)
        self.go_back()


class BeforeAfter(QFrame):
    """A card with the slider.

    Parameters
    ----------
    canvas : Canvas

    Attributes
    ----------
    dismissed : Signal()
    slider : Slider
    """

    dismissed = Signal()

    def __init__(self, canvas: Canvas) -> None:
        super().__init__(objectName="card", accessibleName=tr("Before and after"))
        shield(self)
        self._canvas = canvas
        self._mesh: Mesh | None = None
        self.slider = _Held()
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

    def follow(self, mesh: Mesh) -> None:
        """Compare with the rest shape of another mesh."""
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
