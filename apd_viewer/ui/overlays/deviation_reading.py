"""Deviation under the cursor and its span, shown in the legend."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QObject, QPointF, QTimer
from PySide6.QtGui import QMouseEvent

from apd_viewer.presentation.scales import span_of
from apd_viewer.ui.overlays.legend import Legend
from apd_viewer.ui.scene.mouse_tool import MouseTool
from apd_viewer.ui.tools.canvas import Canvas

_READ = 250  # ms between two readings of the legend while the shape moves


class DeviationReading(MouseTool, QObject):
    """Reads the values on the shape into the legend.

    Parameters
    ----------
    canvas : Canvas
    legend : Legend

    Attributes
    ----------
    enabled : bool
        Whether a measure is shown.
    values : (n,) float array or None
        Of the shape on screen, once measured.
    timer : QTimer
        Running between two readings of a moving shape.
    """

    def __init__(self, canvas: Canvas, legend: Legend) -> None:
        super().__init__(canvas)
        self._surface, self._legend = canvas.surface, legend
        self.enabled = False
        self.values: np.ndarray | None = None
        self._cursor: QPointF | None = None
        self.timer = QTimer(self, singleShot=True, interval=_READ)
        self.timer.timeout.connect(self.update_legend)
        canvas.viewport.tools.insert(0, self)

    @property
    def span(self) -> tuple[float, float] | None:
        """Least and largest value on the shape, or None."""
        return span_of(self.values)

    def value_at(self, position: QPointF) -> float | None:
        """Value under a position in the viewport."""
        hit = None if self.values is None else self._surface.hit(position)
        if hit is None or self.values is None or self._surface.surface_index is None:
            return None
        return float(
            self._surface.barycentric_weights(hit) @ self.values[self._surface.surface_index.F[hit.face]]
        )

    def update_legend(self) -> None:
        """Update the legend's extreme and the value under the cursor."""
        if self.enabled:
            value = None if self._cursor is None else self.value_at(self._cursor)
            self._legend.show_values(self.span, value)

    def schedule_update(self) -> None:
        """Read after a moment; several calls make one reading."""
        if not self.timer.isActive():
            self.timer.start()

    def move(self, event: QMouseEvent) -> bool:
        """Read the value under the cursor without consuming the event."""
        if self.enabled:
            self._cursor = event.position()
            if not self.timer.isActive():
                self.update_legend()
        return False

    def leave(self) -> None:
        """Forget the cursor."""
        if self._cursor is not None:
            self._cursor = None
            self.update_legend()
