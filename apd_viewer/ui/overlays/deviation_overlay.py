"""Colour overlay of a deviation, measured on demand at each draw."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from PySide6.QtCore import QObject, QPointF, QRect, QTimer, Signal
from PySide6.QtGui import QMouseEvent

from apd_viewer.geometry.analysis.deviation import Deviation, write_shades
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.geometry.contact.mesh_contact import ContactPressure
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.warmup import warm_up
from apd_viewer.language import tr
from apd_viewer.presentation.scales import Measure, Scale, default_scale, measures_of, span_of
from apd_viewer.session.model.document import Document
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.overlays.extreme_marker import ExtremeMarker
from apd_viewer.ui.overlays.legend import Legend
from apd_viewer.ui.scene.navigation import MouseTool
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.widgets.background_task import BackgroundTask

_REST = 200  # ms without a shape change before a slow measure is computed


class _OverlayInputs(NamedTuple):
    """Mesh, target shape and deviation object prepared in the background."""

    mesh: Mesh
    target: TargetShape | None
    change: Deviation


class _ValueInputs(NamedTuple):
    """Measure, shape revision and document revision of computed values."""

    measure: Measure
    shape: int
    document: int
    change: Deviation


class _SlowValues(NamedTuple):
    """Values of a slow measure, None if cancelled, with their inputs."""

    seen: _ValueInputs
    values: np.ndarray | None


class DeviationOverlay(QObject):
    """Colours the shape by a deviation and feeds the legend.

    Parameters
    ----------
    covered_rect : callable
        Function giving the rectangle covered at the lower left of the canvas.
    scales : dict of Measure to Scale
        Scales to begin with, where there are any.

    Attributes
    ----------
    changed : Signal()
        Another measure is shown, or another scale, or others are offered.
    measure : Measure or None
        Displayed measure.
    offered_measures : tuple of Measure
        Measures available.
    mesh : Mesh or None
        Mesh with the rest shape for comparison.
    rest_timer : QTimer
        Until the shape rests, for what takes longer.
    """

    changed = Signal()

    def __init__(
        self, canvas: Canvas, legend: Legend, covered_rect: Callable[[], QRect], scales: dict[Measure, Scale]
    ) -> None:
        super().__init__(canvas)
        self._canvas, self._legend = canvas, legend
        self.scales = dict(scales)
        self.measure: Measure | None = None
        self.unit = Unit.NONE
        self.offered_measures = tuple(Measure)
        self.mesh: Mesh | None = None
        self._target: TargetShape | None = None
        self._change: Deviation | None = None
        self._labels: np.ndarray | None = None
        self._thickness: np.ndarray | None = None
        self._document_measures: DocumentMeasures | None = None
        self._document_revision = 0
        self._size = 1.0
        self._seen: _ValueInputs | None = None
        # True until the scale is fitted to the first values, if the user has set none.
        self._fresh = False
        self._fitted: Scale | None = None
        self.extremes = ExtremeMarker(canvas, covered_rect)
        self.reading = DeviationReading(canvas, legend)
        self._task = BackgroundTask(self)
        self._task.done.connect(self._receive_result)
        self.rest_timer = QTimer(self, singleShot=True, interval=_REST, timeout=self._measure_slowly)
        legend.measure_chosen.connect(self.choose_measure)
        legend.scale_changed.connect(self._rescale)
        legend.fit_requested.connect(self._fit_scale)
        legend.extreme_requested.connect(self.show_next_extreme)
        canvas.viewport.pre_draw.append(self._refresh)

    # Display

    def set_mesh(self, mesh: Mesh, target: TargetShape | None = None) -> None:
        """Set the mesh and the optional target shape to compare with."""
        if mesh is self.mesh and target is self._target:
            return
        if mesh is not self.mesh:
            used = mesh.V[mesh.F.ravel()]
            self._size = diagonal(used) or 1.0
            for measure in [m for m, scale in self.scales.items() if not scale.fits_any_size]:
                del self.scales[measure]
        self.mesh, self._target, self._change = mesh, target, None
        self._offer_measures(mesh)
        self.choose_measure(self.measure)

    def _offer_measures(self, mesh: Mesh) -> None:
        self.offered_measures = measures_of(mesh, self._target, self._thickness)
        self._legend.set_measures(self.offered_measures)

    def set_thickness(self, thickness: np.ndarray | None) -> None:
        """Set the wall thickness (n,) at the vertices; None if it is one everywhere."""
        if thickness is None and self._thickness is None:
            return
        self._thickness = thickness
        self._document_revision += 1
        if self.mesh is not None:
            self._offer_measures(self.mesh)
            is_shown = self.measure is Measure.THICKNESS
            self.choose_measure(self.measure) if is_shown else self.changed.emit()

    def follow_document(self, labels: np.ndarray, measures: DocumentMeasures) -> None:
        """Update the measures to the labels and settings of a document."""
        known = self._document_measures
        if labels is self._labels and known is not None and known.settings == measures.settings:
            return
        self._labels, self._document_measures = labels, measures
        self._document_revision += 1
        self._canvas.viewport.update()

    def choose_measure(self, measure: Measure | None) -> None:
        """Display a measure if it is offered; None displays the paint."""
        self.measure = measure = measure if measure in self.offered_measures else None
        self._fresh, self._fitted = True, None
        self.reading.enabled = measure is not None
        self._forget()
        self._task.cancel()
        self._canvas.surface.set_color_map(None)
        self._canvas.viewport.update()
        if measure is None or self.mesh is None:
            self._legend.hide()
        else:
            self._legend.show_scale(self.scale, self.unit)
            self._legend.show_values(None, None)
            self._prepare()
        self.changed.emit()

    @property
    def scale(self) -> Scale:
        """Current colour scale."""
        assert self.measure is not None
        return self.scales.get(self.measure) or self._fitted or default_scale(self.measure, self._size)

    def set_unit(self, unit: Unit) -> None:
        """Set the length unit of the displayed values."""
        self.unit = unit
        if self.measure is not None and self.mesh is not None:
            self._legend.show_scale(self.scale, unit)
            self.reading.update_legend()

    def close(self) -> None:
        """Cancel pending measurements."""
        self.reading.timer.stop()
        self.rest_timer.stop()
        self._task.close()

    def _rescale(self, reach: float, neutral: float) -> None:
        if self.measure is not None:
            self.scales[self.measure] = Scale(self.measure, reach, neutral)
            self._legend.show_scale(self.scale, self.unit)
            self._color_surface()
            self._canvas.viewport.update()
            self.reading.update_legend()
            self.changed.emit()

    def _fit_scale(self) -> None:
        """Fit the end of the scale to the largest value."""
        span = self.reading.span
        if span is not None and self.measure is not None:
            fitted = self.scale.fitted_to(span, self._size)
            self._rescale(fitted.reach, fitted.neutral)

    def _fit_first_scale(self) -> None:
        span, self._fresh = self.reading.span, False
        if span is not None and self.measure is not None and self.measure not in self.scales:
            self._fitted = self.scale.fitted_to(span, self._size)
            self._legend.show_scale(self._fitted, self.unit)

    # Measurement

    def _forget(self) -> None:
        self.reading.values, self._seen = None, None
        self.extremes.remove_mark()
        self.rest_timer.stop()

    def _prepare(self) -> None:
        """Import and compile the measures in the background."""
        skin, mesh, target = self._canvas.surface.picking_index, self.mesh, self._target
        if self._change is not None or mesh is None or skin is None:
            self._legend.show_note("")
            self._canvas.viewport.update()
            return
        self._legend.show_note(tr("Preparing to measure…"))

        def work(_: Callable[[], bool]) -> object:
            warm_up("overlays")
            return _OverlayInputs(mesh, target, Deviation(mesh.V, skin.joined, skin.source, target))

        self._task.begin(work)

    def _refresh(self) -> None:
        """Measure the shape about to be drawn, if changed."""
        surface, measure = self._canvas.surface, self.measure
        if measure is None or self._change is None:
            return
        if self._thickness is not None:
            self._change.thickness = self._thickness
        shape = surface.shape_revision if measure.follows_shape else 0
        document = self._document_revision if measure.follows_document else 0
        now = _ValueInputs(measure, shape, document, self._change)
        if now == self._seen or len(surface.U) != len(surface.shades):
            return
        if measure.is_delayed:
            self._seen = now
            self._measure_soon()
            return
        self._forget()
        self._seen = now
        if measure.waits_for_convergence:
            self._task.cancel()
            self._legend.show_note(tr("Measured when the shape has converged."))
            if surface.color_map is not None:
                surface.set_color_map(None)
            self.rest_timer.start()
        else:
            self.reading.values = measure.traits.values(self._change, surface.shape, lambda: False)
            self._color_surface()
        self.reading.schedule_update()

    def _measure_soon(self) -> None:
        """Schedule a measurement of the displayed shape, unless one is in progress."""
        if not self._task.is_busy and not self.rest_timer.isActive():
            self.rest_timer.start()

    def _measure_slowly(self) -> None:
        change, U, seen = self._change, self._canvas.surface.shape, self._seen
        if change is None or seen is None or self.measure is None:
            return
        if self._document_measures is not None:
            _, change.calmness, change.contact_pressure = self._document_measures
        values = self.measure.traits.values
        self._task.begin(lambda enough: _SlowValues(seen, values(change, U, enough)))

    def _receive_result(self, result: object) -> None:
        """Receive a result from the background thread."""
        if result is None:
            self._legend.show_note(tr("Not enough memory to measure this mesh."))
        elif isinstance(result, _OverlayInputs):
            if (result.mesh, result.target) != (self.mesh, self._target):
                return
            self._change = result.change
            self._legend.show_note("")
            self._canvas.viewport.update()
        elif isinstance(result, _SlowValues) and self._is_current(result):
            self.reading.values = result.values
            self._legend.show_note(result.seen.measure.traits.note_for(result.values))
            self._color_surface()
            self._canvas.viewport.update()
            self.reading.update_legend()
            if result.seen != self._seen:
                self._measure_soon()

    def _is_current(self, result: _SlowValues) -> bool:
        """True if the values match the displayed shape, or may lag behind it."""
        lags = self.measure is not None and self.measure.is_delayed
        now, seen = self._seen, result.seen
        if now is None:
            return False
        return seen == now or (lags and (seen.measure, seen.change) == (now.measure, now.change))

    def _color_surface(self) -> None:
        """Colour the surface by the values on their scale."""
        values = self.reading.values
        if values is None:
            return
        if self._fresh:
            self._fit_first_scale()
        surface, scale = self._canvas.surface, self.scale
        write_shades(values, scale.measure.is_signed, scale.end, surface.shades)
        surface.update_shades()
        neutral = scale.neutral_fraction if scale.measure.is_signed else -1.0
        surface.set_color_map(scale.measure.colors, neutral)

    def show_next_extreme(self, step: int = 1) -> None:
        """Frame the next or previous extreme, if there are values."""
        values = self.reading.values
        if values is not None:
            self.extremes.show_extreme(values, self._size, step, self.scale, self.unit)


_READ = 250  # ms between two updates of the legend while the shape changes


class DeviationReading(MouseTool, QObject):
    """Tool to update the legend's range and value under the cursor.

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
        self.timer = QTimer(self, singleShot=True, interval=_READ, timeout=self.update_legend)
        canvas.viewport.tools.insert(0, self)

    @property
    def span(self) -> tuple[float, float] | None:
        """Smallest and largest value on the shape; None if there are no values."""
        return span_of(self.values)

    def value_at(self, position: QPointF) -> float | None:
        """Value on the surface under a position in the viewport; None off the mesh."""
        hit = None if self.values is None else self._surface.hit(position)
        if hit is None or self.values is None or self._surface.surface_index is None:
            return None
        return float(
            self._surface.barycentric_weights(hit) @ self.values[self._surface.surface_index.F[hit.face]]
        )

    def update_legend(self) -> None:
        """Update the range and the value under the cursor in the legend."""
        if self.enabled:
            value = None if self._cursor is None else self.value_at(self._cursor)
            self._legend.show_values(self.span, value)

    def schedule_update(self) -> None:
        """Schedule an update of the legend; repeated calls cause one update."""
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
        """Remove the value under the cursor from the legend."""
        if self._cursor is not None:
            self._cursor = None
            self.update_legend()


class DocumentMeasures(NamedTuple):
    """Measures derived from a document, and the settings they depend on.

    Attributes
    ----------
    calmness, pressure : callable
        See :class:`apd_viewer.geometry.analysis.deviation.Deviation`.
    """

    settings: tuple[object, ...]
    calmness: Callable[[], np.ndarray]
    pressure: Callable[[np.ndarray], np.ndarray]

    @classmethod
    def from_document(cls, document: Document, keeps_apart: bool) -> DocumentMeasures:
        """Distance from handles' influence, and contact pressure (NaN without contact)."""
        falloffs = (handle.falloff for handle in document.handles)
        given = *falloffs, keeps_apart, document.settings.thickness
        return cls(given, lambda: _calmness(document), _pressure(document, keeps_apart))


def _calmness(document: Document) -> np.ndarray:
    # Imported here so that the window is shown before the solver is loaded.
    from apd_viewer.geometry.goals.calm_parts import calmness

    return calmness(document.mesh, document.labels, document.soft_constraints)


def _pressure(document: Document, keeps_apart: bool) -> Callable[[np.ndarray], np.ndarray]:
    """Function from a shape (n, 3) to its contact pressure (n,); NaN without contact."""
    made: list[ContactPressure] = []

    def pressure(U: np.ndarray) -> np.ndarray:
        # Imported here so that the window is shown before the solver is loaded.
        from apd_viewer.geometry.contact.mesh_contact import ContactPressure

        if not keeps_apart or document.paint_problem:
            return np.full(len(U), np.nan)
        if not made:
            made.append(ContactPressure(document.mesh, document.labels, document.settings.thickness))
        return made[0].relative_pressure(U)

    return pressure
