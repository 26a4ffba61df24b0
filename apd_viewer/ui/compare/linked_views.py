"""Linked views of the compared shapes: one camera, scale and cursor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QGridLayout, QLabel, QPushButton, QWidget

from apd_viewer.geometry.analysis.deviation import Deviation
from apd_viewer.language import tr
from apd_viewer.presentation.scales import Scale
from apd_viewer.session.model.state import State
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.compare.method_view import HEAD_HEIGHT, MethodView, ProbedPoint
from apd_viewer.ui.overlays.legend import ScaleBar
from apd_viewer.ui.scene.camera import Camera
from apd_viewer.ui.scene.camera_controller import link_cameras
from apd_viewer.ui.widgets.fields import NumberField
from apd_viewer.ui.widgets.theme import Theme

_READ = 250  # ms between two readings while shapes move


class LinkedViews(QWidget):
    """Views laid out for the largest shapes.

    Parameters
    ----------
    titles : dict of str to str
        Of the views, by their names.

    Attributes
    ----------
    span_measured : Signal(object)
        The least and the largest change of all shapes that are shown, or None.
    views : dict of str to MethodView
    column_count : int
        How many stand beside each other.
    """

    span_measured = Signal(object)

    def __init__(self, titles: dict[str, str]) -> None:
        super().__init__(objectName="room")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self.views = {name: MethodView(title) for name, title in titles.items()}
        self.column_count = len(titles)
        self._shown: Sequence[str] = list(titles)
        self._aspect = 1.0
        self._unit = Unit.NONE
        self._place: ProbedPoint | None = None
        self._grid = QGridLayout(self, spacing=1)
        self._grid.setContentsMargins(0, 1, 0, 1)
        self._reading = QTimer(self, singleShot=True, interval=_READ)
        self._reading.timeout.connect(self._read)
        link_cameras([view.viewport.camera_controller for view in self.views.values()])
        for view in self.views.values():
            view.probe.hovered.connect(self.mark_point)
            view.values_changed.connect(self._measured)

    def show_rest_shape(self, state: State, unit: Unit) -> None:
        """Show the rest shape of a document in all views."""
        self._unit = unit
        for view in self.views.values():
            view.show_rest_shape(state)

    def set_camera(self, state: State, camera: Camera) -> None:
        """Set the camera, moved to show the rest and the current shape."""
        look = self._first.viewport.camera_controller
        own = look.camera
        look.camera = replace(
            camera,
            position=camera.position - camera.focal,
            focal=np.zeros(3),
            width=own.width,
            height=own.height,
        )
        right, up, _ = look.camera.axes
        both = np.vstack([state.document.mesh.V, state.frame.U])
        self._aspect = float(np.ptp(both @ right) / max(np.ptp(both @ up), 1e-300))
        self._frame(both)

    def look_along(self, axis: str) -> None:
        """Show all of every shape from an axis: see :meth:`CameraController.along`."""
        self._first.viewport.camera_controller.look_along(axis)
        self.frame_shapes()

    def frame_shapes(self) -> None:
        """Frame all shapes."""
        self._frame(np.vstack([self.views[name].surface.U for name in self._shown]))

    @property
    def _first(self) -> MethodView:
        """View with the leading camera."""
        return next(iter(self.views.values()))

    def _frame(self, points: np.ndarray) -> None:
        for view in self.views.values():
            view.viewport.camera_controller.frame(points)

    # Colours

    def set_deviation(self, deviation: Deviation, scale: Scale) -> None:
        """Show how the shapes differ from rest, from now on."""
        for view in self.views.values():
            view.show_scale(scale)
            view.set_deviation(deviation)

    def show_scale(self, scale: Scale) -> None:
        """Show the changes on another scale."""
        for view in self.views.values():
            view.show_scale(scale)
        self.mark_point(self._place)

    def mark_point(self, point: ProbedPoint | None) -> None:
        """Mark a place on all shapes, and read all of them there."""
        self._place = point
        for view in self.views.values():
            view.mark_point(point, self._unit)

    def _measured(self) -> None:
        if not self._reading.isActive():
            self._reading.start()

    def _read(self) -> None:
        spans = [span for name in self._shown if (span := self.views[name].span) is not None]
        low, high = zip(*spans, strict=True) if spans else ((), ())
        self.span_measured.emit((min(low), max(high)) if spans else None)
        self.mark_point(self._place)

    # Places

    def show_views(self, names: Sequence[str]) -> None:
        """Show these views, and no others."""
        self._shown = names
        self._arrange()
        self._measured()

    def _arrange(self) -> None:
        names = self._shown
        self.column_count = _across(len(names), self.width(), self.height(), self._aspect)
        places = {name: divmod(k, self.column_count) for k, name in enumerate(names)}
        for k in range(len(self.views)):
            self._grid.setRowStretch(k, int(k * self.column_count < len(names)))
            self._grid.setColumnStretch(k, int(k < self.column_count))
        for name, view in self.views.items():
            if name in places:
                self._grid.addWidget(view, *places[name])
            view.setVisible(name in places)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Lay the views out anew."""
        super().resizeEvent(event)
        self._arrange()

    def set_theme(self, theme: Theme) -> None:
        """Recolour the backgrounds."""
        for view in self.views.values():
            view.viewport.set_theme(theme.canvas_top, theme.canvas_bottom)

    def close_all(self) -> None:
        """Free the scenes; the views cannot be used afterwards."""
        self._reading.stop()
        for view in self.views.values():
            view.viewport.close()


def _across(count: int, width: int, height: int, aspect: float) -> int:
    """Columns for ``count`` views with the largest shapes of an aspect."""

    def size(across: int) -> float:
        return min(width / across / aspect, height * across / count - HEAD_HEIGHT)

    return max((across for across in range(1, count + 1) if count % across == 0), key=size)


_WIDTH = 248


class SharedScale(QWidget):
    """A legend with its range.

    Parameters
    ----------
    scale : Scale
        Of ratios.

    Attributes
    ----------
    scale : Scale
    changed : Signal()
        The range is another one.
    span : tuple of float or None
        Least and largest value in sight.
    """

    changed = Signal()

    def __init__(self, scale: Scale) -> None:
        super().__init__()
        self.scale = scale
        self.span: tuple[float, float] | None = None
        self.setFixedWidth(_WIDTH)
        self._bar = ScaleBar()
        tip = tr("Change at the ends of the scale, where the colours are strongest")
        self.reach = NumberField(
            brief=True, accessibleName=tr("Range"), toolTip=tip, decimals=9, suffix="\u00a0%"
        )
        self.reach.setRange(1e-7, 1e9)
        self.reach.valueChanged.connect(lambda percent: self._rescale(percent / 100.0))
        tip = tr("Fit the scale to the largest change of all shapes")
        self.fit = QPushButton(tr("Fit"), toolTip=tip)
        self.fit.clicked.connect(self._fit)
        grid = QGridLayout(self, horizontalSpacing=8, verticalSpacing=6)
        grid.setContentsMargins(0, 0, 0, 0)
        title = QLabel(scale.measure.traits.title, objectName="title", toolTip=scale.measure.traits.tip)
        grid.addWidget(title, 0, 0, 1, 3)
        grid.addWidget(self._bar, 1, 0, 1, 3)
        grid.addWidget(QLabel(tr("Range"), objectName="quiet"), 2, 0)
        grid.addWidget(self.reach, 2, 1, Qt.AlignmentFlag.AlignRight)
        grid.addWidget(self.fit, 2, 2)
        grid.setColumnStretch(0, 1)
        grid.setRowStretch(3, 1)
        self._show()

    def show_span(self, span: tuple[float, float] | None) -> None:
        """Show the least and the largest value of all shapes; None shows none."""
        self.span = span
        self._bar.show_values(span, None)
        self.fit.setEnabled(span is not None)

    def _fit(self) -> None:
        if self.span is not None:
            self._rescale(self.scale.fitted_to(self.span).reach)

    def _rescale(self, reach: float) -> None:
        if reach != self.scale.reach:
            self.scale = replace(self.scale, reach=reach)
            self._show()
            self.changed.emit()

    def _show(self) -> None:
        self.reach.show_value(100.0 * self.scale.reach)
        self._bar.show_scale(self.scale, Unit.NONE)
