"""Results of a study: progress, table, scatter plot and curves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QSize, Qt, QUrl, Signal
from PySide6.QtGui import QDesktopServices, QResizeEvent
from PySide6.QtWidgets import (
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from apd_viewer.language import tr
from apd_viewer.presentation.axis import Axis, magnitude_axis, rounded_axis
from apd_viewer.presentation.color_maps import SEQUENTIAL
from apd_viewer.studies.case_file import FAILED
from apd_viewer.ui.case_studies.case_curves import CaseCurves
from apd_viewer.ui.case_studies.column_choice import ColumnChoice
from apd_viewer.ui.case_studies.folder_watch import ReadResults
from apd_viewer.ui.case_studies.result_columns import ResultColumn
from apd_viewer.ui.case_studies.result_model import ResultModel
from apd_viewer.ui.case_studies.result_table import ResultsView
from apd_viewer.ui.case_studies.study_status import StudyStatus
from apd_viewer.ui.panel.status_bar import ElidedLabel
from apd_viewer.ui.plots.chart import Chart, ColorBar, Dots
from apd_viewer.ui.plots.scatter_view import ScatterView
from apd_viewer.ui.widgets.side_by_side import Pane, SideBySide
from apd_viewer.ui.widgets.theme import Theme
from apd_viewer.ui.widgets.thin_bar import ThinBar

_SMALLEST, _NARROWEST = QSize(320, 160), 72  # px, of it and of the name of a study
# Of the window, at first: the mesh is more important.
_WIDTH, _SHARE, _LOWEST, _HIGHEST = 960, 0.3, 210, 420


class ResultsPanel(QWidget):
    """Contents of the dock of a study.

    Attributes
    ----------
    case_requested : Signal(int)
        A row of the plan whose shape is to be opened.
    continue_requested, retry_requested, stop_requested, open_requested : Signal()
    model : ResultModel
    table : ResultsView
    scatter : ScatterPlot
    curves : CaseCurves
    folder : Path or None
    """

    case_requested = Signal(int)
    continue_requested = Signal()
    retry_requested = Signal()
    stop_requested = Signal()
    open_requested = Signal()

    def __init__(self) -> None:
        super().__init__(objectName="casestudy")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self.folder: Path | None = None
        self.status = StudyStatus()
        self._colors = CaseColors()
        self.model = ResultModel()
        self.model.setParent(self)
        self.table = ResultsView(self.model)
        self.scatter = ScatterPlot(self.model)
        self.curves = CaseCurves(self.model)
        self.panes = SideBySide(
            (
                Pane(tr("Table"), self.table, 34),
                Pane(tr("Plot"), self.scatter, 42),
                Pane(tr("Curves"), self.curves, 24),
            )
        )
        self.table.choice_changed.connect(self._choose)
        self.table.case_opened.connect(self.case_requested)
        self.scatter.view.dot_picked.connect(self._pick)
        self._lay_out()
        self._follow_status()

    def _lay_out(self) -> None:
        self.bar = ThinBar()
        self.name = ElidedLabel(objectName="heading", margin=8, minimumWidth=_NARROWEST)
        self.words = ElidedLabel(objectName="quiet")
        self.words.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.go_on = QPushButton(tr("Continue"), toolTip=tr("Compute the cases that are missing"))
        self.retry = QPushButton(tr("Run failed again"), toolTip=tr("Run failed cases once more"))
        self.stop = QPushButton(tr("Stop"))
        self.show_folder = QPushButton(tr("Show folder"), toolTip=tr("Plan, tables and cases as files"))
        self.open = QPushButton(tr("Open study…"))
        self.go_on.clicked.connect(self.continue_requested)
        self.retry.clicked.connect(self.retry_requested)
        self.stop.clicked.connect(self.stop_requested)
        self.open.clicked.connect(self.open_requested)
        self.show_folder.clicked.connect(self._show_folder)
        head = QHBoxLayout(spacing=8)
        head.setContentsMargins(4, 4, 8, 4)
        head.addWidget(self.name)
        head.addWidget(self.panes.tabs)
        head.addWidget(self.words, 1)
        for button in (self.go_on, self.retry, self.stop, self.show_folder, self.open):
            head.addWidget(button)
        column = QVBoxLayout(self, spacing=0)
        column.setContentsMargins(0, 0, 0, 0)
        column.addLayout(head)
        column.addWidget(self.bar)
        column.addWidget(self.panes, 1)

    # What is shown

    def show_study(self, folder: Path) -> None:
        """Show another study, of which nothing is read yet."""
        self.folder = folder
        self.status.reset_for(folder)
        self.name.setText(folder.name)
        self.name.setToolTip(str(folder))
        self.curves.show_study(folder)
        self._follow_status()

    def show_results(self, results: ReadResults) -> None:
        """Show the results of the study as they were read."""
        self.model.show_results(results.table, results.columns)
        self.status.set_results(results.table)
        self.scatter.refresh()
        self._choose()
        self._follow_status()

    def show_progress(self, progress: dict[str, Any]) -> None:
        """Show the progress told by the command that runs it."""
        self.status.set_progress(progress)
        self._follow_status()

    def show_running(self, is_running: bool, stopping: bool = False, sentence: str = "") -> None:
        """Show whether it runs here, and how it has ended."""
        self.status.set_running(is_running, stopping, sentence)
        self._follow_status()

    def _follow_status(self) -> None:
        status = self.status
        self.words.setText(status.text)
        self.bar.show_share(status.share)
        self.bar.setVisible(status.is_unfinished)
        self.go_on.setVisible(status.may_continue)
        self.retry.setVisible(status.may_retry)
        self.stop.setVisible(status.is_running)
        self.stop.setText(tr("Stop now") if status.is_stopping else tr("Stop"))
        self.stop.setToolTip(
            tr("End the running cases too; they are computed again")
            if status.is_stopping
            else tr("Finish the running cases, and start no more; Continue goes on")
        )
        self.show_folder.setVisible(self.folder is not None)
        self.open.setVisible(self.folder is None)

    # Choosing cases

    def _choose(self) -> None:
        colors = self._colors.colors_of(self.table.chosen_rows)
        self.scatter.mark_rows(colors)
        self.curves.show_cases(colors)

    def _pick(self, row: int, more: bool) -> None:
        """Choose the row of a dot, or add it; open it alone."""
        if more:
            self.table.toggle(row)
        else:
            self.table.choose([row])
            self.case_requested.emit(row)

    def _show_folder(self) -> None:
        if self.folder is not None:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(self.folder)))

    # Theme and colours

    def set_theme(self, theme: Theme) -> None:
        """Redraw in the colours of a theme."""
        self.model.theme = theme
        for view in (self.scatter.view, self.curves.view):
            view.theme = theme
            view.update()
        self.table.viewport().update()

    def sizeHint(self) -> QSize:
        """Height for a readable table below a larger canvas."""
        return QSize(_WIDTH, round(min(_HIGHEST, max(_LOWEST, _SHARE * self.window().height()))))

    def minimumSizeHint(self) -> QSize:
        """As narrow as a column beside the canvas."""
        return _SMALLEST

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Arrange the parts by the aspect of the dock."""
        super().resizeEvent(event)
        self.panes.arrange(self.size())


class ScatterPlot(QWidget):
    """The plot, and the choices of its columns.

    Parameters
    ----------
    model : ResultModel

    Attributes
    ----------
    across, upright, color : ColumnChoice
    view : ScatterView
    """

    def __init__(self, model: ResultModel) -> None:
        super().__init__()
        self._model = model
        self._drawn: Chart | None = None
        self.upright = ColumnChoice(tr("Upright axis"))
        self.across = ColumnChoice(tr("Axis across"))
        self.color = ColumnChoice(tr("Colour"), may_be_none=True)
        self.view = ScatterView(self._chart, self._about)
        for choice in (self.across, self.upright, self.color):
            choice.chosen.connect(self.redraw)
        self._lay_out()

    def _lay_out(self) -> None:
        head = QGridLayout(horizontalSpacing=6, verticalSpacing=0)
        head.setContentsMargins(8, 4, 8, 0)
        for k, (word, choice) in enumerate(
            ((tr("y"), self.upright), (tr("x"), self.across), (tr("colour"), self.color))
        ):
            label = QLabel(word, objectName="quiet")
            label.setBuddy(choice)
            head.addWidget(label, 0, 2 * k)
            head.addWidget(choice, 0, 2 * k + 1)
        head.setColumnStretch(head.columnCount(), 1)
        column = QVBoxLayout(self, spacing=0)
        column.setContentsMargins(0, 0, 0, 0)
        column.addLayout(head)
        column.addWidget(self.view, 1)

    def refresh(self) -> None:
        """Offer the columns of the model, and draw them."""
        columns = self._model.numeric_columns
        asked = [column for column in columns if column.is_from_plan]
        found = [column for column in columns if not column.is_from_plan]
        volume, energy = ([c for c in found if c.name == name] for name in ("volume_error", "energy"))
        self.across.set_columns(columns, [*asked, *found])
        self.upright.set_columns(columns, [*volume, *found, *asked[1:], *asked])
        # The area is the same in all cases, as a rule; the energy is not.
        self.color.set_columns(columns, [*asked[1:2], *energy, *found[:1]])
        self.redraw()

    def mark_rows(self, rings: Mapping[int, str]) -> None:
        """Mark rows of the plan by rings of these colours."""
        self.view.rings = rings
        self.view.update()

    def redraw(self) -> None:
        """Draw anew."""
        self._drawn = None
        self.view.update()

    def _chart(self) -> Chart:
        if self._drawn is None:
            self._drawn = self._made()
        return self._drawn

    def _made(self) -> Chart:
        columns = {column.name: column for column in self._model.columns}
        x, y = columns.get(self.across.name), columns.get(self.upright.name)
        if x is None or y is None or not (x.is_numeric and y.is_numeric):
            return Chart("", empty_text=tr("Finished cases appear here."))
        (across, at_x), (upright, at_y) = axis_of(x), axis_of(y)
        color = columns.get(self.color.name)
        ramp, colors = None, uniform_colors(len(at_x))
        if color is not None and color.is_numeric:
            axis, places = axis_of(color)
            ramp, colors = ColorBar(axis, color_bar_colors()), dot_colors(axis, places)
        failed = np.array([row.status == FAILED for row in self._model.rows], dtype=bool)
        crosses = np.column_stack([at_x, np.where(np.isfinite(at_y), at_y, upright.low)])[failed]
        dots = Dots(
            at_x,
            np.where(failed, np.nan, at_y),
            colors,
            crosses[np.isfinite(crosses).all(axis=1)],
        )
        return Chart("", x=across, y=upright, dots=dots, color_bar=ramp)

    def _about(self, row: int) -> str:
        """Line of the plan and the values of the axes."""
        named = {self.upright.name, self.across.name, self.color.name}
        shown: list[ResultColumn] = [self._model.columns[0]]
        shown += [column for column in self._model.columns if column.name in named]
        return "\n".join(f"{column.title}: {column.texts[row]}" for column in shown)


# Okabe and Ito's, those first that stand out on light and dark.
_CHOSEN = ("#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8a63c9", "#8c8c1e")
MOST_CHOSEN = len(_CHOSEN)
# Where the largest value is so many times the least, and half of all values lie in this lower share of the
# range, a logarithmic axis parts them.
_MANY, _CROWDED = 50.0, 0.25
_FINEST = 0.01  # percent: two decimals are shown
_NOTHING = "#b8bcc4"
_SHADES = 100  # of dots: more cannot be told apart


class CaseColors:
    """Colours of chosen cases, each of which keeps its own while it is chosen."""

    def __init__(self) -> None:
        self._given: dict[int, str] = {}

    def colors_of(self, rows: Sequence[int]) -> dict[int, str]:
        """Colours of the first rows of the plan."""
        rows = rows[:MOST_CHOSEN]
        kept = {row: color for row, color in self._given.items() if row in rows}
        free = [color for color in _CHOSEN if color not in kept.values()]
        self._given = {row: kept[row] if row in kept else free.pop(0) for row in rows}
        return self._given


def axis_of(column: ResultColumn) -> tuple[Axis, np.ndarray]:
    """Axis of a column with numbers, and the places (n,) of its values on it."""
    known = column.values[np.isfinite(column.values)]
    low, high = float(known.min()), float(known.max())
    if column.suffix.strip() == "%" and high - low < _FINEST:
        # Apart by less than what is shown: an area that is kept, but for rounding.
        low, high = (round((low + high) / 2.0 + side * _FINEST, 2) for side in (-1.0, 1.0))
    crowded = float(np.median(known)) < low + _CROWDED * (high - low)
    if low > 0.0 and high > _MANY * low and crowded:
        with np.errstate(invalid="ignore"):
            return magnitude_axis(low, high, column.suffix), np.log10(column.values)
    return rounded_axis(low, high, column.suffix), column.values


def color_bar_colors() -> tuple[str, ...]:
    """Colours of the scale, from its lower end to its upper."""
    return tuple(_hex(color) for color in SEQUENTIAL.knots)


def dot_colors(axis: Axis, places: np.ndarray) -> tuple[str, ...]:
    """Colour of each of the places (n,) on an axis, grey where there is none."""
    share = np.clip((places - axis.low) / (axis.high - axis.low), 0.0, 1.0)
    shades = [*map(_hex, SEQUENTIAL.colors(np.linspace(0.0, 1.0, _SHADES)).tolist()), _NOTHING]
    chosen = np.where(np.isfinite(share), np.rint((_SHADES - 1) * np.nan_to_num(share)), _SHADES)
    return tuple(shades[k] for k in chosen.astype(int).tolist())


def uniform_colors(count: int) -> tuple[str, ...]:
    """One colour for all dots."""
    return (_hex(SEQUENTIAL.knots[3]),) * count


def _hex(color: Sequence[int]) -> str:
    red, green, blue = color
    return f"#{red:02x}{green:02x}{blue:02x}"
