"""Controller of reports, pictures and diagnostics."""

import tempfile
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from datetime import datetime
from functools import partial
from pathlib import Path

import numpy as np
from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QFont, QFontMetricsF, QGuiApplication, QImage, QPainter
from PySide6.QtWidgets import QWidget

from apd_viewer import log
from apd_viewer.errors import InputError
from apd_viewer.files import html_page
from apd_viewer.files.known_file import fingerprint
from apd_viewer.files.report import target_distance_fields
from apd_viewer.files.storage.regular_files import read_bytes
from apd_viewer.geometry.analysis.area_change import LocalChange, local_change
from apd_viewer.geometry.analysis.deviation import Deviation, write_shades
from apd_viewer.geometry.analysis.shape_check import ShapeCheck
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.language import tr
from apd_viewer.log import redacted_text
from apd_viewer.presentation.legend_svg import legend_svg
from apd_viewer.presentation.palette import label_colors
from apd_viewer.presentation.plate_readings import FindConversion
from apd_viewer.presentation.python_script import python_script
from apd_viewer.presentation.report_blocks import ReportReadings
from apd_viewer.presentation.report_page import (
    NO_HEADING,
    ReportDrawings,
    ReportHeading,
    ReportStep,
    ReportSubject,
    report_page,
    volumes_block,
)
from apd_viewer.presentation.report_view import ShapeView, ViewedMesh, report_view
from apd_viewer.presentation.scales import Measure, Scale, default_scale, span_of
from apd_viewer.presentation.shape_picture import VIEW_DIRECTION
from apd_viewer.session.measurement_readings import complete_readings
from apd_viewer.session.model.handle_paths import handle_turns
from apd_viewer.session.model.memo import triangle_areas
from apd_viewer.session.model.state import State
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.session.model.view import View
from apd_viewer.session.processes.shape_checker import ShapeQuery, check_shape_in_process
from apd_viewer.session.session import Session
from apd_viewer.session.storage.session_file import save_session
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.overlays.display_options import DisplayOptions
from apd_viewer.ui.overlays.notice import Notice
from apd_viewer.ui.plots import reading_charts
from apd_viewer.ui.plots.chart_drawing import Chart, draw_chart
from apd_viewer.ui.plots.plots import svg_element
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.scene.scene_picture import OffscreenScene, encode_png
from apd_viewer.ui.sharing.picture_dialog import PictureDialog, PictureRenderer, PictureSettings
from apd_viewer.ui.sharing.report_dialogs import ReportDialog, VolumesDialog
from apd_viewer.ui.tools.canvas import Canvas
from apd_viewer.ui.widgets.theme import DARK, LIGHT, Theme

_CHART, _LETTERS = QSize(1016, 230), 12  # px; size of a chart, and font size
_PICTURED = 4  # most pictures of steps
_FROM_ABOVE = 0.05  # sine of the angle to the vertical from which on a view along it is not taken over
_LONGEST = 24_000_000  # largest embedded session in bytes; base64 adds a third


@dataclass(frozen=True, eq=False)
class _ReportMeasurements:
    """Slow measurements of a report, and the area change with its scale."""

    subject: ReportSubject
    evidence: ReportReadings
    values: np.ndarray
    shades: np.ndarray
    scale: Scale
    view: html_page.PageView


class ReportController:
    """Commands to write reports, and to save or copy pictures and diagnostics.

    Parameters
    ----------
    window : QWidget
        Over which to ask.
    view : callable
        Returns the camera, the wall and the overlay.
    newtons : callable
        Conversion of the loads of a state into newtons, or None.
    charts : callable
        Charts of the timeline with their captions.
    pressed : callable
        Blocks on the results of presses of a mesh.
    """

    def __init__(
        self,
        window: QWidget,
        canvas: Canvas,
        display_options: DisplayOptions,
        view: Callable[[], View],
        preferences: Preferences,
        notice: Notice,
        session: Session,
        newtons: FindConversion,
        charts: Callable[[], Sequence[tuple[Chart, str]]],
        pressed: Callable[[Mesh], tuple[html_page.PageBlock, ...]],
    ) -> None:
        self._window, self._canvas, self._looks = window, canvas, display_options
        self._view, self._memory, self._notice = view, preferences, notice
        self._session, self._newtons, self._charts = session, newtons, charts
        self._pressed = pressed
        self.pictures = PictureRenderer(canvas, display_options, notice, session.jobs)
        self._wish: PictureSettings | None = None
        self._titles: dict[str, str] = {}  # of the reports on a mesh, by its name
        self.volumes: VolumesDialog | None = None

    def copy_diagnostics(self) -> None:
        """Copy diagnostics to the clipboard."""
        QGuiApplication.clipboard().setText(diagnostics(self._canvas.viewport.opengl_info))
        self._notice.show_message(tr("Diagnostics copied; paste them into your bug report."))

    def copy_python_script(self) -> None:
        """Copy a Python script that reproduces the deformation to the clipboard."""
        if (state := self._session.store.state) is None:
            return
        try:
            lines = python_script(state.document)
        except InputError as error:
            self._notice.show_failure(str(error))
            return
        QGuiApplication.clipboard().setText(lines)
        self._notice.show_message(tr("Copied the Python lines that repeat this deformation."))

    def open_volumes(self) -> None:
        """Open the dialog of volumes beside published values."""
        if self.volumes is None:
            self.volumes = VolumesDialog(self._window, self._volumes_table)
        self.volumes.refresh()
        self.volumes.show()
        self.volumes.activateWindow()

    def refresh_volumes(self) -> None:
        """Refresh the dialog of volumes, if it is open."""
        if self.volumes is not None and self.volumes.isVisible():
            self.volumes.refresh()

    def _volumes_table(self) -> html_page.PageBlock:
        store, checks = self._session.store, self._session.shape_checks
        if store.state is None or checks.shape_check is None or checks.rest_check is None:
            return html_page.PageNote(tr("Measuring…"))
        both = checks.rest_check, checks.shape_check
        return volumes_block(store.state, store.unit, self._view().wall, both, self._up_axis)

    @property
    def _up_axis(self) -> UpAxis:
        return self._canvas.viewport.camera_controller.camera.up_axis

    def ask_for_report(self) -> None:
        """Ask for title, customer and file of a report, and write it."""
        if (state := self._session.store.state) is None:
            return
        mesh = state.document.mesh
        proposed = ReportHeading(self._titles.get(mesh.name, ""), self._memory.report_customer)
        dialog = ReportDialog(self._window, proposed, mesh.name)
        if dialog.exec():
            heading = dialog.heading
            self._titles[mesh.name], self._memory.report_customer = heading
            path = file_dialogs.ask_where_to_save_report(self._window, self._memory.last_folder, mesh)
            if path is not None:
                self.write_report(path, heading)
        dialog.deleteLater()

    def ask_for_picture(self) -> None:
        """Ask for a picture's settings and file, and save it."""
        if (state := self._session.store.state) is None:
            return
        pictures = self.pictures
        dialog = PictureDialog(self._window, pictures, self._wish or PictureSettings(pictures.view_size * 2))
        if dialog.exec():
            self._wish = wish = dialog.settings
            path = file_dialogs.ask_where_to_save_picture(
                self._window, self._memory.last_folder, state.document.mesh
            )
            if path is not None:
                pictures.save(path, wish)
        dialog.deleteLater()

    def write_report(self, path: Path, heading: ReportHeading = NO_HEADING) -> None:
        """Write a report of the displayed shape, in the background."""
        session = self._session
        if (state := session.store.state) is None:
            return
        view = self._view()
        checks = session.shape_checks.shape_check, session.shape_checks.rest_check
        unit, moment, made = (
            session.store.unit,
            datetime.now().astimezone(),
            session.measurement_readings.readings(state),
        )
        chosen, up_axis = self._looks.overlay.scales.get(Measure.AREA), self._up_axis
        newtons, steps = self._newtons(state), self._steps_to(state)
        pressed = self._pressed(state.document.mesh)

        def work() -> _ReportMeasurements:
            found, at_rest = _completed_checks(state, *checks)
            all_made = complete_readings(made, state)
            subject = ReportSubject(
                state,
                unit,
                view.wall,
                found,
                at_rest,
                moment,
                all_made,
                up_axis,
                newtons,
                steps,
                heading,
                pressed,
            )
            return _measure(subject, view, chosen)

        title = tr("Measuring for {name}").format(name=path.name)
        session.jobs.run(title, work, partial(self._finish, path))

    def _steps_to(self, state: State) -> list[ReportStep]:
        """Steps of the run that a state is in, by each method that has solved them."""
        timeline = self._session.player.timeline
        if (k := timeline.index_of(state)) is None:
            return []
        run = timeline.run_of(k)
        return [
            ReportStep(i - run.start, each, self._newtons(each))
            for i in run
            for each in (timeline.steps[i].non_wall_state, timeline.steps[i].wall_state)
            if each is not None
        ]

    def _finish(self, path: Path, measured: _ReportMeasurements) -> None:
        """Render the pictures on this thread, and write the page in the background."""
        session, subject = self._session, measured.subject
        QGuiApplication.setOverrideCursor(Qt.CursorShape.WaitCursor)
        try:
            drawings = self._drawings(measured)
        except InputError as error:
            self._notice.show_failure(str(error))
            return
        finally:
            QGuiApplication.restoreOverrideCursor()

        def work() -> str:
            html_page.write_page(path, report_page(subject, measured.evidence, drawings()))
            return tr("Saved {name}.").format(name=path.name)

        title = tr("Writing {name}").format(name=path.name)
        session.jobs.run(title, work, partial(self._notice.show_message, file=path), can_be_cancelled=False)

    def _drawings(self, measured: _ReportMeasurements) -> Callable[[], ReportDrawings]:
        """Render all pictures; encoding them, by the function returned, needs no display."""
        surface, subject = self._canvas.surface, measured.subject
        state, steps = subject.state, _pictured_steps(subject.steps)
        shown = replace(state, document=self._canvas.coloring.without_pictured(state.document))
        look = surface.shows_edges, surface.shading, surface.texture
        studio = OffscreenScene(self._canvas.viewport, shown, *look)
        V, U = state.document.mesh.V, state.frame.U
        images = {
            tr("Rest shape"): studio.painted_picture(V),
            tr("Current shape"): studio.painted_picture(U),
            tr("Local area change"): studio.colored_picture(U, measured.shades, measured.scale),
        }
        of_steps = {
            tr("Step {number}").format(number=step.number): studio.painted_picture(step.state.frame.U)
            for step in steps
        }
        legend = legend_svg(measured.scale, subject.unit, span_of(measured.values))
        histogram = self._histogram(measured.evidence.change)
        charts = [(chart, caption) for chart, caption in self._charts() if chart.curves] if steps else []
        curves = tuple(self._drawing(chart, caption, 0.0) for chart, caption in charts)
        return lambda: ReportDrawings(
            measured.view, _picture_row(images, legend), histogram, _picture_row(of_steps), curves
        )

    def _histogram(self, change: LocalChange) -> html_page.PageDrawing:
        chart = replace(reading_charts.local_change(change), title="", readings=())
        # The page has the title and the readings; their rows are left out.
        return self._drawing(chart, tr("Share of the surface by local area change"), 2.5)

    def _drawing(self, chart: Chart, caption: str, rows: float) -> html_page.PageDrawing:
        """Drawing of a chart, without its upper ``rows`` of text."""
        font = QFont(self._window.font())
        font.setPixelSize(_LETTERS)
        words = rows * QFontMetricsF(font).height()
        room = QRectF(0.0, -words, _CHART.width(), _CHART.height() + words)

        def drawn(theme: Theme) -> str:
            def draw(painter: QPainter) -> None:
                draw_chart(painter, room, chart, theme, font)

            return svg_element(_CHART, draw, caption)

        return html_page.PageDrawing(drawn(LIGHT), drawn(DARK), caption)


def _pictured_steps(steps: Sequence[ReportStep]) -> list[ReportStep]:
    """Evenly spaced steps of a run, by the method that solved its last one."""
    if len(steps) < 2:
        return []
    same = _steps_by_method(steps, steps[-1].state)
    chosen = np.unique(np.linspace(0, len(same) - 1, min(_PICTURED, len(same))).round().astype(int))
    return [same[k] for k in chosen]


def _steps_by_method(steps: Sequence[ReportStep], state: State) -> list[ReportStep]:
    """Steps solved by the method of a state."""
    method = state.document.settings.method
    return [step for step in steps if step.state.document.settings.method == method]


def _completed_checks(
    state: State, found: ShapeCheck | None, at_rest: ShapeCheck | None
) -> tuple[ShapeCheck, ShapeCheck]:
    """Checks of the current and the rest shape, computed if missing."""
    V, F = state.document.mesh.V, state.document.mesh.joined_F
    at_rest = at_rest or check_shape_in_process(ShapeQuery(V, F))
    if state.frame.U is V:
        return at_rest, at_rest
    shape = ShapeQuery(state.frame.U, F, handle_turns(state.document))
    return found or check_shape_in_process(shape), at_rest


def _measure(subject: ReportSubject, view: View, chosen: Scale | None) -> _ReportMeasurements:
    """Compute the slow measurements; without a ``chosen`` scale fit one."""
    state = subject.state
    mesh, skin, U, target = (
        state.document.mesh,
        state.surface_index,
        state.frame.U,
        state.document.target_shape,
    )
    deviation = Deviation(mesh.V, skin.joined, skin.source)
    values = deviation.area_change(U)
    span, scale = span_of(values), chosen or default_scale(Measure.AREA, 1.0)
    if chosen is None and span is not None:
        scale = scale.fitted_to(span)
    shades = _shades(values, scale)
    evidence = ReportReadings(
        local_change(U, skin.F, triangle_areas(mesh.V, mesh.F)),
        None if mesh.path is None else fingerprint(mesh.path),
        _session_of(state, view),
        None if target is None else target_distance_fields(target, mesh, U),
    )
    return _ReportMeasurements(
        subject, evidence, values, shades, scale, _shape_view(subject, view, deviation, scale)
    )


def _shades(values: np.ndarray, scale: Scale) -> np.ndarray:
    """Shades (n,) uint8 of values on a scale."""
    shades = np.full(len(values), 255, dtype=np.uint8)
    write_shades(values, scale.measure.is_signed, scale.end, shades)
    return shades


def _shape_view(subject: ReportSubject, view: View, deviation: Deviation, scale: Scale) -> html_page.PageView:
    """View of the shape, and of the steps by its method if it is one of them."""
    state, document = subject.state, subject.state.document
    steps = _steps_by_method(subject.steps, state)
    current = next((k for k, step in enumerate(steps) if step.state.frame.U is state.frame.U), None)
    if current is None:
        steps, current = [ReportStep(0, state, None)], 0
    shapes = [
        ShapeView(
            tr("Step {number}").format(number=step.number),
            step.state.frame.U,
            _shades(deviation.area_change(step.state.frame.U), scale),
        )
        for step in steps
    ]
    up, direction = subject.up_axis.direction, np.array(VIEW_DIRECTION) @ subject.up_axis.frame
    if (camera := view.camera) is not None:
        seen = np.subtract(camera.position, camera.focal)
        if np.linalg.norm(np.cross(seen, up)) > _FROM_ABOVE * np.linalg.norm(seen):
            direction = seen
    paint = label_colors(document.labels, document.member)[:, :3]
    shown = ViewedMesh(document.mesh.V, document.mesh.joined_F, paint)
    return report_view(shown, shapes, current, scale, direction.tolist(), up.tolist())


def _session_of(state: State, view: View) -> bytes:
    """Session file without the paths of meshes; empty if too large."""
    document, target = state.document, state.document.target_shape
    if target is not None:
        target = TargetShape(target.mesh.without_path())
    document = replace(
        document, mesh=document.mesh.without_path(), target_shape=target, missing_target_shape=None
    )
    state = replace(state, document=document)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "report.apd"
        save_session(path, state, view, embed=True)
        return path.read_bytes() if path.stat().st_size <= _LONGEST else b""


def _picture_row(images: dict[str, QImage], legend: str = "") -> html_page.PagePictureRow:
    """Row of pictures by their captions."""
    pictures = [html_page.PagePicture(encode_png(image), caption) for caption, image in images.items()]
    return html_page.PagePictureRow(tuple(pictures), legend)


_LINES = 100  # last lines of the log to include


def diagnostics(opengl: str) -> str:
    """Diagnostics as text, with names of folders removed.

    Parameters
    ----------
    opengl : str
        Vendor, renderer and version of the OpenGL in use.
    """
    parts = {
        "Versions": [*log.version_lines(), f"OpenGL {opengl}"],
        "Log": _last_lines(),
        "Last crash": _last_crash(),
    }
    return "\n\n".join("\n".join([f"{title}:", *(lines or ["none"])]) for title, lines in parts.items())


def _last_lines() -> list[str]:
    """Last lines of this process's log; empty without a log."""
    file = log.current_file()
    return [] if file is None else _lines(file)[-_LINES:]


def _last_crash() -> list[str]:
    """File name and contents of the latest crash report; empty if there is none."""
    for path in sorted(log.log_folder().glob("*.crash"), reverse=True):  # latest first; named by their time
        if lines := _lines(path):
            return [path.name, *lines]
    return []


def _lines(path: Path) -> list[str]:
    with suppress(OSError):
        return redacted_text(read_bytes(path).decode(errors="replace")).splitlines()
    return []
