"""Live plots of the gesture and the deviation from rest, and their files."""

import threading
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from PySide6.QtCore import QBuffer, QByteArray, QIODevice, QRect, QRectF, QSize, Qt, QTimer
from PySide6.QtGui import QColor, QHideEvent, QImage, QPaintDevice, QPainter, QPaintEvent, QResizeEvent
from PySide6.QtSvg import QSvgGenerator
from PySide6.QtWidgets import QBoxLayout, QGridLayout, QLabel, QMenu, QScrollArea, QToolButton, QWidget

from apd_viewer.errors import InputError
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.files.tables import write_table
from apd_viewer.geometry.analysis.area_change import LocalChange, local_change
from apd_viewer.geometry.warmup import warm_up
from apd_viewer.language import tr
from apd_viewer.session.model.memo import triangle_areas
from apd_viewer.session.model.state import State
from apd_viewer.session.model.trace import TRACE_COLUMNS
from apd_viewer.session.session import Session
from apd_viewer.ui.filing import file_dialogs
from apd_viewer.ui.overlays.notice import Notice
from apd_viewer.ui.plots import reading_charts
from apd_viewer.ui.plots.chart_drawing import Chart, ChartArea, draw_chart
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.widgets.box_layouts import column_layout, row_layout
from apd_viewer.ui.widgets.fields import attach_menu
from apd_viewer.ui.widgets.theme import ICON_SIZE, LIGHT, Theme, icon

_SIZE, _SMALLEST = QSize(348, 224), QSize(348, 160)
_LOWEST = 140  # px: minimum height of a stacked chart
_WIDE = 560  # px: width needed for the check boxes in one row
_AGAIN = 100  # ms between checks of the compiling thread
_HISTOGRAM = "ratio_from", "ratio_to", "share_of_rest_area"
_FINE = 2.0 ** np.linspace(-2.0, 2.0, 161)  # area ratios that bound the bins of an exported histogram


class ChartTexts(NamedTuple):
    """Title and tooltip of a chart in the menu."""

    title: str
    tip: str


_CHARTS = {
    "error": ChartTexts(tr("Area error"), tr("Deviation of the area from its target, by iteration")),
    "energy": ChartTexts(tr("Energy"), tr("Energy of the deformation along the gesture")),
    "area": ChartTexts(tr("Area and volume"), tr("Their changes from rest along the gesture")),
    "local": ChartTexts(
        tr("Local change"),
        tr("Share of the surface by local area change, with the mean, the 99th percentile and the maximum"),
    ),
}
_AT_FIRST = ("error", "area", "local")


class Plots(QWidget):
    """Charts side by side or stacked, and the menu to choose them.

    They read the session when drawn, so hidden plots cost nothing.

    Parameters
    ----------
    notice : Notice
        Notice for written files.
    """

    def __init__(self, preferences: Preferences, notice: Notice, session: Session) -> None:
        super().__init__(objectName="plots")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self._memory, self._notice, self._store = preferences, notice, session.store
        self._theme = LIGHT
        self._measured: tuple[np.ndarray, LocalChange] | None = None
        self._loading = threading.Thread(target=warm_up, args=("plots",), name="plots", daemon=True)
        self.views = {name: ChartView(words, partial(self._chart, name)) for name, words in _CHARTS.items()}
        self.choices = {name: self._choice(name) for name in _CHARTS}
        self._head = QGridLayout(spacing=4)
        self._head.setContentsMargins(8, 0, 8, 0)
        self._head.setColumnStretch(len(_CHARTS), 1)
        self._make_save()
        charts = QWidget(objectName="charts")
        self._none = QLabel(tr("Choose above what to plot."), objectName="quiet")
        self._none.setAlignment(Qt.AlignmentFlag.AlignCenter)
        parts = (*self.views.values(), self._none)
        self._charts = row_layout(*((part, 1) for part in parts), spacing=4, parent=charts)
        room = QScrollArea(widgetResizable=True, focusPolicy=Qt.FocusPolicy.NoFocus)
        room.setWidget(charts)
        column = column_layout(self._head, (room, 1), spacing=0, margins=(0, 0, 0, 4), parent=self)
        column.setSizeConstraint(QBoxLayout.SizeConstraint.SetNoConstraint)
        self._arrange_in_row(wide=True)
        self._choose(preferences.plots if preferences.plots is not None else _AT_FIRST)

    def _choice(self, name: str) -> QToolButton:
        words = _CHARTS[name]
        button = QToolButton(text=words.title, toolTip=words.tip, checkable=True, objectName="choice")
        button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        button.toggled.connect(self._apply_choice)
        return button

    def _make_save(self) -> None:
        self.save = QToolButton(text=tr("Save"), toolTip=tr("Save the plots as a picture or as data"))
        self.save.setObjectName("choice")
        self.save.setIconSize(ICON_SIZE * 0.8)
        self.save.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        attach_menu(self.save, self._make_menu())

    def _make_menu(self) -> QMenu:
        menu = QMenu(self.save)
        self._pictures = [
            menu.addAction(tr("PNG picture…"), partial(self._ask, "plots", ".png", self.write_picture)),
            menu.addAction(tr("SVG picture…"), partial(self._ask, "plots", ".svg", self.write_picture)),
        ]
        menu.addSeparator()
        self._numbers = menu.addAction(
            tr("Gesture data as CSV…"), partial(self._ask, "gesture", ".csv", self.write_trace)
        )
        self._histogram = menu.addAction(
            tr("Local change as CSV…"), partial(self._ask, "local-change", ".csv", self.write_histogram)
        )
        menu.aboutToShow.connect(self._enable_save_actions)
        return menu

    def _enable_save_actions(self) -> None:
        """Enable the save actions with available data."""
        for action in self._pictures:
            action.setEnabled(any(not view.isHidden() for view in self.views.values()))
        self._numbers.setEnabled(len(self._store.trace) > 1)
        self._histogram.setEnabled(self._store.state is not None)

    def join_thread(self) -> None:
        """Wait for the compiling thread; at interpreter exit it would crash."""
        if self._loading.ident is not None:
            self._loading.join()

    def refresh(self) -> None:
        """Redraw with the next frame, if visible."""
        if self.isVisible():
            for view in self.views.values():
                view.update()

    def set_theme(self, theme: Theme) -> None:
        """Redraw in the colours of a theme."""
        self._theme = theme
        self.save.setIcon(icon("save", theme))
        for view in self.views.values():
            view.theme = theme
            view.update()

    # Chart selection

    def _choose(self, names: tuple[str, ...] | list[str]) -> None:
        for name, button in self.choices.items():
            button.blockSignals(True)
            button.setChecked(name in names)
            button.blockSignals(False)
        self._arrange()

    def _apply_choice(self) -> None:
        self._memory.plots = [name for name, button in self.choices.items() if button.isChecked()]
        self._arrange()

    def _arrange(self) -> None:
        for name, view in self.views.items():
            view.setVisible(self.choices[name].isChecked())
        self._none.setVisible(not any(button.isChecked() for button in self.choices.values()))

    def sizeHint(self) -> QSize:
        """Height for readable charts below a larger canvas."""
        return _SIZE

    def minimumSizeHint(self) -> QSize:
        """Minimum size, as wide as one chart, since charts can be stacked."""
        return _SMALLEST

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Arrange the charts by the aspect ratio of the dock."""
        super().resizeEvent(event)
        self._arrange_in_row(self.width() > max(_WIDE, self.height()))

    def _arrange_in_row(self, wide: bool) -> None:
        directions = QBoxLayout.Direction
        self._charts.setDirection(directions.LeftToRight if wide else directions.TopToBottom)
        for view in self.views.values():
            view.setMinimumHeight(0 if wide else _LOWEST)
        columns = len(self.choices) if wide else len(self.choices) // 2
        for k, button in enumerate(self.choices.values()):
            self._head.addWidget(button, k // columns, k % columns)
        self._head.addWidget(self.save, 0, len(self.choices) + 1)

    def hideEvent(self, event: QHideEvent) -> None:
        """Release the cached shape and its local area changes."""
        self._measured = None
        super().hideEvent(event)

    # Chart contents

    def _chart(self, name: str) -> Chart:
        """Current content of a chart."""
        state, trace = self._store.state, self._store.trace
        if name == "error":
            return reading_charts.area_error(state, trace)
        if name == "energy":
            return reading_charts.energy(trace, self._store.unit)
        if name == "area":
            return reading_charts.area_and_volume(state, trace)
        if state is None:
            return reading_charts.local_change(
                None, tr("Open a mesh to see the area change of its triangles here.")
            )
        if not self._is_histogram_ready():
            return reading_charts.local_change(None, tr("Preparing…"))
        return reading_charts.local_change(self._local_change(state))

    def _is_histogram_ready(self) -> bool:
        """True if the histogram is compiled; the first call starts compiling."""
        if self._loading.ident is None:
            self._loading.start()
        if self._loading.is_alive():
            view = self.views["local"]
            QTimer.singleShot(_AGAIN, view, view.update)
            return False
        return True

    def _local_change(self, state: State) -> LocalChange:
        """Local area change of a state, cached per shape."""
        U, mesh = state.frame.U, state.document.mesh
        if self._measured is None or self._measured[0] is not U:
            self._measured = U, local_change(U, state.surface_index.F, triangle_areas(mesh.V, mesh.F))
        return self._measured[1]

    # Export

    def _ask(self, name: str, suffix: str, write: Callable[[Path], object]) -> None:
        state = self._store.state
        stem = state.document.mesh.stem if state else "mesh"
        path = ask_where_to_save_plots(self, self._memory.last_folder, f"{stem}-{name}", suffix)
        if path is None:
            return
        try:
            write(path)
        except InputError as error:
            self._notice.show_failure(str(error))
        else:
            self._notice.show_message(tr("Saved {name}.").format(name=path.name), file=path)

    def write_picture(self, path: Path) -> None:
        """Write the visible charts on white as PNG or SVG; raises InputError."""
        views = [view for view in self.views.values() if not view.isHidden()]
        around = QRect()
        for view in views:
            around = around.united(view.geometry())

        def draw(painter: QPainter) -> None:
            for view in views:
                room = QRectF(view.geometry().translated(-around.topLeft()))
                draw_chart(painter, room, view.chart(), LIGHT, self.font())

        write_drawing(path, around.size(), draw)

    def write_trace(self, path: Path) -> None:
        """Write the readings of the gesture as CSV; raises InputError."""
        write_table(path, TRACE_COLUMNS, self._store.trace.rows)

    def write_histogram(self, path: Path) -> None:
        """Write the histogram as CSV, finer than drawn; raises InputError."""
        state = self._store.state
        assert state is not None
        octaves = np.concatenate([[-np.inf], np.log2(_FINE), [np.inf]])
        fractions = self._local_change(state).surface_fractions(octaves)
        edges = np.concatenate([[0.0], _FINE, [np.nan]])
        write_table(path, _HISTOGRAM, np.column_stack([edges[:-1], edges[1:], fractions]))


class ChartView(QWidget):
    """Widget displaying a chart.

    Parameters
    ----------
    chart : callable
        Function giving the chart at every drawing.

    Attributes
    ----------
    chart_area : ChartArea or None
        Of the last drawing.
    """

    def __init__(self, words: ChartTexts, chart: Callable[[], Chart]) -> None:
        super().__init__(accessibleName=words.title, toolTip=words.tip)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)  # otherwise Qt repaints widgets below
        self.chart = chart
        self.theme = LIGHT
        self.chart_area: ChartArea | None = None

    def paintEvent(self, _: QPaintEvent) -> None:
        """Draw the chart."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(self.theme.panel))
        self.chart_area = draw_chart(painter, QRectF(self.rect()), self.chart(), self.theme, self.font())
        painter.end()


_SCALE = 3  # picture pixels for each pixel on the screen
_PAPER = "#ffffff"


def ask_where_to_save_plots(parent: QWidget, folder: Path, name: str, suffix: str) -> Path | None:
    """Ask for a path to save plots; None if cancelled."""
    return file_dialogs.ask_where_to_save(parent, tr("Save plots"), folder / f"{name}{suffix}")


def write_drawing(path: Path, size: QSize, draw: Callable[[QPainter], None]) -> None:
    """Write a drawing as SVG or as PNG on white, depending on the suffix.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    with replacing_file(path) as scratch:
        if path.suffix.lower() == ".svg":
            sheet = _svg_sheet(size, tr("Plots of APD Viewer"))
            sheet.setFileName(str(scratch))
            _paint(sheet, size, draw)
        else:
            image = QImage(size * _SCALE, QImage.Format.Format_RGB32)
            image.setDevicePixelRatio(_SCALE)
            _paint(image, size, draw)
            if not image.save(str(scratch), "PNG"):
                raise OSError(tr("the picture could not be encoded"))


def svg_element(size: QSize, draw: Callable[[QPainter], None], title: str) -> str:
    """SVG element of a drawing with a title, without a background."""
    content = QByteArray()
    buffer = QBuffer(content)
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    sheet = _svg_sheet(size, title)
    sheet.setOutputDevice(buffer)
    _paint(sheet, size, draw, paper=None)
    text = bytes(content.data()).decode("utf-8")
    return text[text.index("<svg") :].strip()


def _svg_sheet(size: QSize, title: str) -> QSvgGenerator:
    """Sheet with a title; without one, Qt would write its own, and a description."""
    sheet = QSvgGenerator()
    sheet.setSize(size)
    sheet.setViewBox(QRect(0, 0, size.width(), size.height()))
    sheet.setTitle(title)
    sheet.setDescription(title)
    return sheet


def _paint(
    device: QPaintDevice, size: QSize, draw: Callable[[QPainter], None], paper: str | None = _PAPER
) -> None:
    painter = QPainter(device)
    if paper is not None:
        painter.fillRect(QRectF(0, 0, size.width(), size.height()), QColor(paper))
    draw(painter)
    painter.end()
