"""Reports and pictures for others."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QFont, QFontMetricsF, QGuiApplication, QImage, QPainter
from PySide6.QtWidgets import QWidget

from apd_viewer.errors import InputError
from apd_viewer.files import html_page
from apd_viewer.files.fingerprint import fingerprint
from apd_viewer.files.report import apart_of
from apd_viewer.geometry.analysis.area_change import LocalChange, local_change
from apd_viewer.geometry.analysis.deviation import Deviation
from apd_viewer.geometry.analysis.extremes import write_shades
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.geometry.mesh.arrays import diagonal
from apd_viewer.language import tr
from apd_viewer.presentation.legend_svg import legend_svg
from apd_viewer.presentation.python_script import python_script
from apd_viewer.presentation.report_origin import Evidence
from apd_viewer.presentation.report_page import Subject, page_of
from apd_viewer.presentation.scales import Measure, Scale, usual
from apd_viewer.session.measurement_readings import completed
from apd_viewer.session.model.memo import triangle_areas
from apd_viewer.session.processes.shape_checker import Shape, checked
from apd_viewer.session.storage.session_file import save_session
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.filing.plot_export import svg_of
from apd_viewer.ui.plots import reading_charts
from apd_viewer.ui.plots.chart_drawing import draw_chart
from apd_viewer.ui.scene.offscreen_scene import Studio
from apd_viewer.ui.scene.scene_picture import png_of
from apd_viewer.ui.sharing.diagnostics import diagnostics
from apd_viewer.ui.sharing.picture_dialog import PictureDialog
from apd_viewer.ui.sharing.pictures import Pictures, Wish
from apd_viewer.ui.widgets.theme import DARK, LIGHT, Theme

if TYPE_CHECKING:
    from apd_viewer.geometry.analysis.shape_check import ShapeCheck
    from apd_viewer.session.model.state import State
    from apd_viewer.session.model.view import View
    from apd_viewer.session.session import Session
    from apd_viewer.ui.overlays.display_options import Looks
    from apd_viewer.ui.overlays.notice import Notice
    from apd_viewer.ui.panel.measurements_controller import Measuring
    from apd_viewer.ui.preferences.preferences import Preferences
    from apd_viewer.ui.tools.canvas import Canvas

_CHART, _LETTERS = QSize(1016, 230), 12  # px
_LONGEST = 24_000_000  # bytes of a session; base64 adds a third


@dataclass(frozen=True, eq=False)
class _Measured:
    """Slow measurements for a report, and the area change at the vertices."""

    subject: Subject
    evidence: Evidence
    values: np.ndarray
    shades: np.ndarray


class Reporting:
    """Writes reports, and hands pictures out.

    Parameters
    ----------
    window : QWidget
        Over which to ask.
    canvas : Canvas
    looks : Looks
    measuring : Measuring
    memory : Preferences
    notice : Notice
    session : Session

    Attributes
    ----------
    pictures : Pictures
    """

    def __init__(
        self,
        window: QWidget,
        canvas: Canvas,
        looks: Looks,
        measuring: Measuring,
        memory: Preferences,
        notice: Notice,
        session: Session,
    ) -> None:
        self._window, self._canvas, self._looks = window, canvas, looks
        self._measuring, self._memory, self._notice = measuring, memory, notice
        self._session = session
        self.pictures = Pictures(canvas, looks, notice, session.jobs)
        self._wish: Wish | None = None

    def copy_diagnostics(self) -> None:
        """Copy diagnostics to the clipboard."""
        QGuiApplication.clipboard().setText(diagnostics(self._canvas.viewport.opengl))
        self._notice.tell(tr("Diagnostics copied; paste them into your bug report."))

    def copy_python(self) -> None:
        """Copy the Python lines that repeat the deformation."""
        if (state := self._session.store.state) is None:
            return
        try:
            lines = python_script(state.document)
        except InputError as error:
            self._notice.fail(str(error))
            return
        QGuiApplication.clipboard().setText(lines)
        self._notice.tell(tr("Copied the Python lines that repeat this deformation."))

    def ask(self) -> None:
        """Choose a target and write a report."""
        if (state := self._session.store.state) is None:
            return
        path = file_dialogs.ask_where_to_report(self._window, self._memory.folder, state.document.mesh)
        if path is not None:
            self.write(path)

    def ask_for_picture(self) -> None:
        """Choose a picture's settings and target, and write it."""
        if (state := self._session.store.state) is None:
            return
        pictures = self.pictures
        dialog = PictureDialog(self._window, pictures, self._wish or Wish(pictures.view_size * 2))
        if dialog.exec():
            self._wish = wish = dialog.wish
            path = file_dialogs.ask_where_to_put_picture(
                self._window, self._memory.folder, state.document.mesh
            )
            if path is not None:
                pictures.save(path, wish)
        dialog.deleteLater()

    def write(self, path: Path) -> None:
        """Write a report of the shape on screen, in the background."""
        session = self._session
        if (state := session.store.state) is None:
            return
        view = self._measuring.in_view(self._canvas.view.saved(session.store.unit.value))
        checks = session.shape_checks.found, session.shape_checks.at_rest
        unit, moment, made = (
            session.store.unit,
            datetime.now().astimezone(),
            session.measuring.readings(state),
        )
        scale = self._scale(state)

        def work() -> _Measured:
            found, at_rest = _checked(state, *checks)
            all_made = completed(made, state)
            subject = Subject(state, unit, view.wall, found, at_rest, moment, all_made)
            return _measured(subject, view, scale)

        title = tr("Measuring for {name}").format(name=path.name)
        session.jobs.run(title, work, lambda measured: self._finish(path, measured, scale))

    def _scale(self, state: State) -> Scale:
        """Colour scale of the local area change in use."""
        V, F = state.document.mesh.V, state.document.mesh.F
        size = diagonal(V[F.ravel()]) or 1.0
        return self._looks.heat.scales.get(Measure.AREA) or usual(Measure.AREA, size)

    def _finish(self, path: Path, measured: _Measured, scale: Scale) -> None:
        """Take the pictures on this thread, and write the page in the background."""
        session, subject = self._session, measured.subject
        QGuiApplication.setOverrideCursor(Qt.CursorShape.WaitCursor)
        try:
            images = self._images(subject.state, measured, scale)
            histogram = self._histogram(measured.evidence.change)
        except InputError as error:
            self._notice.fail(str(error))
            return
        finally:
            QGuiApplication.restoreOverrideCursor()
        legend = self._legend(subject, measured, scale)

        def work() -> str:
            html_page.write_page(
                path, page_of(subject, measured.evidence, _encoded(images, legend), histogram)
            )
            return tr("Saved {name}.").format(name=path.name)

        title = tr("Writing {name}").format(name=path.name)
        session.jobs.run(title, work, self._notice.tell, can_be_cancelled=False)

    def _images(self, state: State, measured: _Measured, scale: Scale) -> list[QImage]:
        surface = self._canvas.surface
        studio = Studio(self._canvas.viewport, state, surface.edges, surface.shading)
        V, U = state.document.mesh.V, state.frame.U
        return [studio.painted(V), studio.painted(U), studio.measured(U, measured.shades, scale)]

    def _legend(self, subject: Subject, measured: _Measured, scale: Scale) -> str:
        values = measured.values[np.isfinite(measured.values)]
        span = (float(values.min()), float(values.max())) if len(values) else None
        return legend_svg(scale, subject.unit, span)

    def _histogram(self, change: LocalChange) -> html_page.Drawing:
        chart = replace(reading_charts.local_change(change), title="", readings=())
        font = QFont(self._window.font())
        font.setPixelSize(_LETTERS)
        words = 2.5 * QFontMetricsF(font).height()  # title and readings, given by the page instead
        room = QRectF(0.0, -words, _CHART.width(), _CHART.height() + words)

        def drawn(theme: Theme) -> str:
            def draw(painter: QPainter) -> None:
                draw_chart(painter, room, chart, theme, font)

            return svg_of(_CHART, draw)

        caption = tr("Share of the surface by local area change")
        return html_page.Drawing(drawn(LIGHT), drawn(DARK), caption)


def _checked(
    state: State, found: ShapeCheck | None, at_rest: ShapeCheck | None
) -> tuple[ShapeCheck, ShapeCheck]:
    """Checks of the shape and of the mesh at rest, missing ones made."""
    V, F = state.document.mesh.V, state.document.mesh.joined_F
    at_rest = at_rest or checked(Shape(V, F))
    if state.frame.U is V:
        return at_rest, at_rest
    return found or checked(Shape(state.frame.U, F)), at_rest


def _measured(subject: Subject, view: View, scale: Scale) -> _Measured:
    """Compute the slow measurements."""
    state = subject.state
    mesh, skin, U, target = state.document.mesh, state.skin, state.frame.U, state.document.target
    values = Deviation(mesh.V, skin.joined, skin.source).area(U)
    shades = np.full(len(U), 255, dtype=np.uint8)
    write_shades(values, scale.measure.is_signed, scale.end, shades)
    evidence = Evidence(
        local_change(U, skin.F, triangle_areas(mesh.V, mesh.F)),
        None if mesh.path is None else fingerprint(mesh.path),
        _session_of(state, view),
        None if target is None else apart_of(target, mesh, U),
    )
    return _Measured(subject, evidence, values, shades)


def _session_of(state: State, view: View) -> bytes:
    """Session file without the mesh's place; empty if too long."""
    document, target = state.document, state.document.target
    if target is not None:
        target = TargetShape(target.mesh.homeless())
    document = replace(document, mesh=document.mesh.homeless(), target=target, missing_target=None)
    state = replace(state, document=document)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "report.apd"
        save_session(path, state, view, embed=True)
        return path.read_bytes() if path.stat().st_size <= _LONGEST else b""


def _encoded(images: list[QImage], legend: str) -> html_page.PictureRow:
    captions = tr("Rest shape"), tr("Current shape"), tr("Local area change")
    pictures = [
        html_page.PagePicture(png_of(image), caption) for image, caption in zip(images, captions, strict=True)
    ]
    return html_page.PictureRow(tuple(pictures), legend)
