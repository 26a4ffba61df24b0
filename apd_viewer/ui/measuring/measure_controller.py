"""The tool Measure, its list and its drawing, in step with the session."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QGuiApplication

from apd_viewer.geometry.measuring.measurement import Plane
from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.geometry.measuring.surface_point import SurfacePoint
from apd_viewer.language import tr
from apd_viewer.presentation import measurement_text as words
from apd_viewer.session.session import Session
from apd_viewer.ui.measuring.kind_words import KIND_WORDS
from apd_viewer.ui.measuring.measure_tool import MeasureTool
from apd_viewer.ui.measuring.measure_view import MeasureView
from apd_viewer.ui.panel.measure_section import MeasureSection
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.tools.toolbox import Tool


class MeasureController(QObject):
    """Adds, lists, draws and copies measurements.

    Parameters
    ----------
    canvas : Canvas
    section : MeasureSection
        Of the panel.
    session : Session
    choose_tool : callable
        Puts a tool into the hand.
    show_message : callable
        Says a sentence to the user.

    Attributes
    ----------
    tool : MeasureTool
    view : MeasureView
    kind_chosen : Signal(object)
        Another Kind is to be measured.
    """

    kind_chosen = Signal(object)

    def __init__(
        self,
        canvas: Canvas,
        section: MeasureSection,
        session: Session,
        choose_tool: Callable[[Tool], object],
        show_message: Callable[[str], object],
    ) -> None:
        super().__init__(canvas)
        self._section, self._session, self._take, self._tell = section, session, choose_tool, show_message
        self._chosen = 0
        self._F: np.ndarray | None = None
        self.tool = MeasureTool(canvas.viewport, canvas.surface)
        self.view = MeasureView(canvas.viewport, canvas.surface, self.tool)
        canvas.viewport.tools += [self.tool, self.view]
        self.tool.picked.connect(lambda points, plane: self._add(points, plane, self.tool.kind))
        section.list.chosen.connect(self._choose)
        section.list.renamed.connect(session.measurements.rename)
        section.list.removed.connect(self._remove)
        section.copy.clicked.connect(self.copy)
        section.clear.clicked.connect(self.clear)
        section.shown.toggled.connect(self._show_in_view)

    @property
    def hint(self) -> str:
        """Hint for the status line."""
        return KIND_WORDS[self.tool.kind].hint

    def choose_kind(self, kind: MeasurementKind) -> None:
        """Measure another kind, with the tool Measure."""
        self.tool.kind = kind
        self.kind_chosen.emit(kind)
        self._take(Tool.MEASURE)

    def refresh(self) -> None:
        """Show the measurements of the session's state."""
        state = self._session.store.state
        if state is None:
            return
        if state.document.mesh.F is not self._F:
            self._F = state.document.mesh.F
            self.tool.cancel()  # points clicked on another mesh
        if not state.document.measurements and not self._section.list.rows:
            return
        unit, readings = self._session.store.unit, self._session.measurement_readings.readings(state)
        self._chosen = max(0, min(self._chosen, len(readings) - 1))
        self._section.show_readings(readings, unit, self._chosen)
        self.view.show_readings(readings, unit, self._chosen)

    def copy(self) -> None:
        """Copy all values to the clipboard, as text with tabs."""
        state = self._session.store.state
        if state is None or not state.document.measurements:
            self._tell(tr("There are no measurements to copy; choose the tool Measure and click the mesh."))
            return
        readings = self._session.measurement_readings.readings(state)
        QGuiApplication.clipboard().setText(words.value_table(readings, self._session.store.unit))
        self._tell(tr("Measurements copied; paste them into a text or a spreadsheet."))

    def clear(self) -> None:
        """Remove all measurements."""
        if self._session.store.state is not None:
            self._session.measurements.clear()

    def add_section(self, point: np.ndarray, normal: np.ndarray) -> None:
        """Measure the section in the plane through a point (3,) with a unit normal (3,)."""
        x, y, z = normal.tolist()
        self._add((), Plane((x, y, z), float(point @ normal)), MeasurementKind.SECTION)

    def _add(self, points: tuple[SurfacePoint, ...], plane: Plane | None, kind: MeasurementKind) -> None:
        state = self._session.store.state
        if state is not None:
            self._chosen = len(state.document.measurements)
            self._session.measurements.add(kind, points, plane)
            self._section.reveal()

    def _choose(self, k: int) -> None:
        self._chosen = k
        self.refresh()

    def _remove(self, k: int) -> None:
        if k < self._chosen:
            self._chosen -= 1
        self._session.measurements.remove(k)

    def _show_in_view(self, on: bool) -> None:
        self.view.visible = on
