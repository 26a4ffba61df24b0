"""Places in the window mentioned by the tour."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from PySide6.QtCore import QPoint, QRect
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMainWindow, QWidget

from apd_viewer.ui.actions.actions import Actions
from apd_viewer.ui.panel.panel import Panel
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.tools.gizmo_layout import GizmoFrame
from apd_viewer.ui.tools.toolbox import Tool

_MOST_POINTS = 500  # sample of a mesh's vertices


class TourTargets:
    """Rectangles in a window, each None if out of sight.

    Parameters
    ----------
    window : QMainWindow
    canvas : Canvas
    actions : Actions
    panel : Panel
    """

    def __init__(self, window: QMainWindow, canvas: Canvas, actions: Actions, panel: Panel) -> None:
        self._window = window
        self._canvas = canvas
        self._actions = actions
        self._panel = panel

    def mesh(self) -> QRect | None:
        """Rectangle of the mesh in the window."""
        U = self._canvas.surface.U
        return self._around(
            self._canvas.viewport.camera_controller.camera.project(U[:: 1 + len(U) // _MOST_POINTS])
        )

    def rings(self) -> QRect | None:
        """The rings of the gizmo."""
        return self._gizmo(lambda frame, axis: frame.ring(axis)[0])

    def gizmo(self) -> QRect | None:
        """The whole gizmo, with rings, arrows and letters."""
        return self._gizmo(lambda frame, axis: np.vstack([frame.ring(axis)[0], frame.arrow(axis)]))

    def area(self) -> QRect | None:
        """Rectangle of the area reading in the window."""
        area = self._panel.area
        return self._of([area.percent, area.verdict, area.area])

    def brushes(self) -> QRect | None:
        """Buttons of the painting tools."""
        return self._buttons([self._actions.tools[tool] for tool in Tool if tool.words.is_brush])

    def export(self) -> QRect | None:
        """Export button."""
        return self._buttons([self._actions.file.export])

    def _gizmo(self, points: Callable[[GizmoFrame, int], np.ndarray]) -> QRect | None:
        gizmo = self._canvas.gizmo
        if not gizmo.visible or not gizmo.frame.is_visible:
            return None
        return self._around(np.vstack([points(gizmo.frame, axis) for axis in range(3)]))

    def _around(self, points: np.ndarray) -> QRect | None:
        """Visible part of the box around viewport points."""
        view = self._canvas.viewport
        if not len(points) or not np.isfinite(points).all():
            return None
        # Coordinates far outside the view would overflow in Qt.
        low, high = np.clip([points.min(axis=0), points.max(axis=0)], -1e6, 1e6).round().astype(int)
        seen = QRect(QPoint(*low.tolist()), QPoint(*high.tolist())) & view.rect()
        return self._shifted(view, seen) if seen.isValid() else None

    def _buttons(self, actions: list[QAction]) -> QRect | None:
        return self._of([self._actions.bar.widgetForAction(action) for action in actions])

    def _of(self, widgets: list[QWidget]) -> QRect | None:
        """Visible part of widgets."""
        found = QRect()
        for widget in widgets:
            if widget.isVisible() and not (seen := widget.visibleRegion().boundingRect()).isEmpty():
                found |= self._shifted(widget, seen)
        return found if found.isValid() else None

    def _shifted(self, widget: QWidget, rect: QRect) -> QRect:
        return rect.translated(widget.mapTo(self._window, QPoint()))
