"""Curves and scatter plot of the cases of a study."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import QGridLayout, QLabel, QWidget

from apd_viewer.cases.case_file import DONE, FAILED, read_case
from apd_viewer.errors import InputError
from apd_viewer.language import tr
from apd_viewer.presentation.axis import Axis, linear_axis, magnitude_axis, rounded_axis
from apd_viewer.presentation.color_maps import SEQUENTIAL
from apd_viewer.ui.plots.chart_drawing import Chart, ColorBar, Curve, Dots
from apd_viewer.ui.plots.plots import ChartTexts, ChartView
from apd_viewer.ui.plots.scatter_view import ScatterView
from apd_viewer.ui.studies.result_columns import ResultColumn, reading_texts
from apd_viewer.ui.studies.result_table import ResultModel
from apd_viewer.ui.widgets.box_layouts import STRETCH, column_layout, row_layout
from apd_viewer.ui.widgets.fields import ComboBox

_NARROWEST, _AROUND = 72, 44  # px: smallest width of the box, and space around its title
_ABSCISSA = "part"
_OFFERED = (
    "volume_error",
    "area_error",
    "energy",
    "local_change",
    "largest_edge_strain",
    "mean_edge_strain",
    "handle_drift",
    "volume",
    "volume_capped",
    "area",
    "share_reached",
)
_LOWEST = QSize(200, 120)
_Curves = Mapping[str, list[float | None]]
# Okabe-Ito palette, starting with colours clearly visible on light and dark backgrounds.
_CHOSEN = ("#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8a63c9", "#8c8c1e")
MOST_CHOSEN = len(_CHOSEN)
# Use a logarithmic axis if the ratio of largest to smallest value exceeds ``_MANY`` and half of the
# values lie in the lowest fraction ``_CROWDED`` of the range.
_MANY, _CROWDED = 50.0, 0.25
_FINEST = 0.01  # smallest range in percent, as two decimals are shown
_NOTHING = "#b8bcc4"
_SHADES = 100  # colour levels of the dots; finer levels would be indistinguishable


class ColumnChoice(ComboBox):
    """Combo box of columns, keeping its choice while the column exists.

    Parameters
    ----------
    name : str
        Accessible name.
    may_be_none : bool
        Whether no column can be chosen, too.
    """

    chosen = Signal()

    def __init__(self, name: str, may_be_none: bool = False) -> None:
        super().__init__(accessibleName=name, toolTip=name)
        self._may_be_none = may_be_none
        self._own = False  # True once the user has chosen; until then the preferred column is selected
        self.activated.connect(self._choose)

    def _choose(self) -> None:
        self._own = True
        self.chosen.emit()
        self._show_full_title()

    def _show_full_title(self) -> None:
        """Show the full title in the tooltip, as the box may elide it."""
        self.setToolTip(f"{self.accessibleName()}: {self.currentText()}")
        self.updateGeometry()

    @property
    def name(self) -> str:
        """Name of the chosen column; empty if none is chosen."""
        return str(self.currentData() or "")

    def set_columns(self, columns: Sequence[ResultColumn], preferred: Sequence[ResultColumn]) -> None:
        """Set the columns; the first of ``preferred`` is selected until the user chooses."""
        names = [column.name for column in columns]
        before = self.currentData() if self._own else None
        offered = [self.itemData(k) for k in range(self.count())]
        if offered == [*([""] if self._may_be_none else []), *names]:
            return
        self.clear()
        if self._may_be_none:
            self.addItem(tr("none"), "")
        for column in columns:
            self.addItem(column.title, column.name)
            self.setItemData(self.count() - 1, column.tip, Qt.ItemDataRole.ToolTipRole)
        wanted = before if before in names or before == "" else preferred[0].name if preferred else ""
        self.setCurrentIndex(max(0, self.findData(wanted)))
        widest = self.view().sizeHintForColumn(0) if self.count() else 0
        self.view().setMinimumWidth(widest + 24)
        self._show_full_title()

    def sizeHint(self) -> QSize:
        """Size for the current title instead of the longest one."""
        text = self.fontMetrics().horizontalAdvance(self.currentText())
        return QSize(max(_NARROWEST, text + _AROUND), super().sizeHint().height())

    def minimumSizeHint(self) -> QSize:
        """Size for a few letters; the list shows full titles."""
        return QSize(_NARROWEST, self.sizeHint().height())


class CaseCurves(QWidget):
    """Chart of one reading along the motion, with a curve for each selected case."""

    def __init__(self, model: ResultModel) -> None:
        super().__init__()
        self._model = model
        self._folder: Path | None = None
        self._kept: dict[str, _Curves] = {}
        self._shown: Mapping[int, str] = {}
        self.reading = ColumnChoice(tr("Measurement along the motion"))
        nothing = np.empty(0)
        offered = [
            ResultColumn(name, reading_texts(name).title, reading_texts(name).tip, nothing, ())
            for name in _OFFERED
        ]
        self.reading.set_columns(offered, offered)
        self.view = ChartView(ChartTexts(tr("Curves of the chosen cases"), ""), self._chart)
        self.reading.chosen.connect(self.view.update)
        self.view.setMinimumSize(_LOWEST)
        abscissa = QLabel(tr("by motion"), objectName="quiet")
        head = row_layout(self.reading, abscissa, STRETCH, spacing=6, margins=(8, 4, 8, 0))
        column_layout(head, (self.view, 1), spacing=0, parent=self)

    def show_study(self, folder: Path) -> None:
        """Set the study folder and clear the cached curves."""
        self._folder, self._kept, self._shown = folder, {}, {}
        self.view.update()

    def show_cases(self, colors: Mapping[int, str]) -> None:
        """Show the curves of plan rows, given with their colours."""
        self._shown = dict(colors)
        self.view.update()

    def _curves(self, row: int) -> _Curves:
        """Curves of a case; empty if it is unfinished or its file unreadable."""
        found = self._model.rows[row]
        if found.status != DONE or self._folder is None:
            return {}
        if found.key not in self._kept:
            try:
                self._kept[found.key] = read_case(self._folder, found.key).curves
            except InputError:
                return {}
        return self._kept[found.key]

    def _chart(self) -> Chart:
        name = self.reading.name
        scale = 100.0 if reading_texts(name).percent else 1.0
        curves, legend = [], []
        for row, color in self._shown.items():
            found = self._curves(row)
            y = scale * np.array(found.get(name, []), dtype=float)
            if np.isfinite(y).any():
                curves.append(Curve(100.0 * np.array(found[_ABSCISSA], dtype=float), y, color))
                legend += [("━", color), (self._model.row_name(row, is_short=True), "quiet")]
        if not curves:
            return Chart("", empty_text=tr("Choose finished cases to see their curves; Ctrl adds one."))
        every = np.concatenate([curve.y for curve in curves])
        end = max(float(curve.x[-1]) for curve in curves)
        y_axis = rounded_axis(float(np.nanmin(every)), float(np.nanmax(every)), " %" if scale > 1.0 else "")
        return Chart("", tuple(legend), linear_axis(0.0, end, " %"), y_axis, tuple(curves))


class ScatterPlot(QWidget):
    """Scatter plot with the choice of its columns."""

    def __init__(self, model: ResultModel) -> None:
        super().__init__()
        self._model = model
        self._drawn: Chart | None = None
        self.upright = ColumnChoice(tr("Upright axis"))
        self.across = ColumnChoice(tr("Axis across"))
        self.color = ColumnChoice(tr("Colour"), may_be_none=True)
        self.view = ScatterView(self._chart, self._row_tooltip)
        for choice in (self.across, self.upright, self.color):
            choice.chosen.connect(self.redraw)
        self._lay_out()

    def _lay_out(self) -> None:
        head = QGridLayout(horizontalSpacing=6, verticalSpacing=0)
        head.setContentsMargins(8, 4, 8, 0)
        for k, (word, choice) in enumerate(
            ((tr("y"), self.upright), (tr("x"), self.across), (tr("colour"), self.color))
        ):
            label = QLabel(word, objectName="quiet", buddy=choice)
            head.addWidget(label, 0, 2 * k)
            head.addWidget(choice, 0, 2 * k + 1)
        head.setColumnStretch(head.columnCount(), 1)
        column_layout(head, (self.view, 1), spacing=0, parent=self)

    def refresh(self) -> None:
        """Offer the columns of the model, and redraw the plot."""
        columns = self._model.numeric_columns
        asked = [column for column in columns if column.is_from_plan]
        found = [column for column in columns if not column.is_from_plan]
        volume, energy = ([c for c in found if c.name == name] for name in ("volume_error", "energy"))
        self.across.set_columns(columns, [*asked, *found])
        self.upright.set_columns(columns, [*volume, *found, *asked[1:], *asked])
        # The area is usually equal in all cases; the energy is not.
        self.color.set_columns(columns, [*asked[1:2], *energy, *found[:1]])
        self.redraw()

    def mark_rows(self, rings: Mapping[int, str]) -> None:
        """Mark rows of the plan by rings of these colours."""
        self.view.rings = rings
        self.view.update()

    def redraw(self) -> None:
        """Discard the cached chart and schedule a repaint."""
        self._drawn = None
        self.view.update()

    def _chart(self) -> Chart:
        if self._drawn is None:
            self._drawn = self._new_chart()
        return self._drawn

    def _new_chart(self) -> Chart:
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
        dots = Dots(at_x, np.where(failed, np.nan, at_y), colors, crosses[np.isfinite(crosses).all(axis=1)])
        return Chart("", x=across, y=upright, dots=dots, color_bar=ramp)

    def _row_tooltip(self, row: int) -> str:
        """Tooltip text of a row: its name and the values of the chosen columns."""
        named = {self.upright.name, self.across.name, self.color.name}
        shown = [each for each in self._model.columns if each.name in named and not each.is_from_plan]
        return "\n".join([self._model.row_name(row), *(f"{each.title}: {each.texts[row]}" for each in shown)])


class CaseColors:
    """Assigns colours to selected cases, stable while a case is selected."""

    def __init__(self) -> None:
        self._given: dict[int, str] = {}

    def colors_of(self, rows: Sequence[int]) -> dict[int, str]:
        """Colours of plan rows by number, for as many as there are colours."""
        rows = rows[:MOST_CHOSEN]
        kept = {row: color for row, color in self._given.items() if row in rows}
        free = [color for color in _CHOSEN if color not in kept.values()]
        self._given = {row: kept[row] if row in kept else free.pop(0) for row in rows}
        return self._given


def axis_of(column: ResultColumn) -> tuple[Axis, np.ndarray]:
    """Axis for a numeric column, and positions (n,) of its values on it."""
    known = column.values[np.isfinite(column.values)]
    low, high = float(known.min()), float(known.max())
    if column.suffix.strip() == "%" and high - low < _FINEST:
        # The range is below the displayed precision, as with an area preserved up to rounding.
        low, high = (round((low + high) / 2.0 + side * _FINEST, 2) for side in (-1.0, 1.0))
    crowded = float(np.median(known)) < low + _CROWDED * (high - low)
    if low > 0.0 and high > _MANY * low and crowded:
        with np.errstate(invalid="ignore"):
            return magnitude_axis(low, high, column.suffix), np.log10(column.values)
    return rounded_axis(low, high, column.suffix), column.values


def color_bar_colors() -> tuple[str, ...]:
    """Colours of the sequential scale, from low to high."""
    return tuple(_hex(color) for color in SEQUENTIAL.knots)


def dot_colors(axis: Axis, places: np.ndarray) -> tuple[str, ...]:
    """Colours for positions (n,) on an axis; grey for NaN."""
    fraction = np.clip((places - axis.low) / (axis.high - axis.low), 0.0, 1.0)
    shades = [*map(_hex, SEQUENTIAL.colors(np.linspace(0.0, 1.0, _SHADES)).tolist()), _NOTHING]
    chosen = np.where(np.isfinite(fraction), np.rint((_SHADES - 1) * np.nan_to_num(fraction)), _SHADES)
    return tuple(shades[k] for k in chosen.astype(int).tolist())


def uniform_colors(count: int) -> tuple[str, ...]:
    """Equal colours for ``count`` dots."""
    return (_hex(SEQUENTIAL.knots[3]),) * count


def _hex(color: Sequence[int]) -> str:
    red, green, blue = color
    return f"#{red:02x}{green:02x}{blue:02x}"
