"""Dialog for re-running the paper's tables and comparing results."""

import csv
from pathlib import Path

from PySide6.QtCore import QSize, Qt
from PySide6.QtWidgets import QGridLayout, QLabel, QScrollArea, QWidget

from apd_viewer.files.storage.regular_files import read_bytes
from apd_viewer.language import tr
from apd_viewer.presentation.number_format import format_grouped, format_signed
from apd_viewer.ui.preferences.preferences import Preferences
from apd_viewer.ui.studies.run_dialog import RunBar, RunDialog
from apd_viewer.ui.widgets.box_layouts import column_layout, resize_on_screen
from apd_viewer.ui.widgets.figure_view import FigureView


def _introduction() -> str:
    return tr(
        "Reproduces Tables 1 and 2 of Li and Hui on the sample bottle and duck, with ARAP and "
        "with the paper's method (APD), and plots the area loss of ARAP by angle and the handle"
        " drift with Eq. 8. The authors' meshes are not published, so only percentages can be "
        "compared, not areas. This takes a minute or two; you can keep working in the window."
    )


def _figures() -> dict[str, str]:
    """File names of the figures, with their captions."""
    return {
        "bottle.png": tr("Table 1: the bottle at rest, and twisted by 60° and 120°."),
        "duck.png": tr("Table 2: the duck at rest, and its tail moved by 0.15 L and 0.3 L."),
        "loss-against-angle.png": tr(
            "Area change by ARAP against the angle. Stopped after a few iterations, the loss first "
            "grows and then falls, as in Table 1; at convergence, this bottle gains area."
        ),
        "handle.png": tr(
            "Effect of Eq. 8 on the handle: a twist makes it drift, and a pull is undone almost completely."
        ),
    }


class PaperDialog(RunDialog):
    """Dialog to recompute the paper's tables, shown with their figures."""

    def __init__(self, window: QWidget, preferences: Preferences) -> None:
        super().__init__(window, tr("The paper's tables"), RunBar(tr("Run"), "paper", preferences))
        self.run.start_requested.connect(
            lambda: self.run.begin(lambda _, results: ["paper", "-o", str(results)])
        )
        self.table: QGridLayout | None = None
        self.figures: list[FigureView] = []
        self._area: QScrollArea | None = None
        self._column.addWidget(QLabel(_introduction(), objectName="quiet", wordWrap=True))
        self._column.addWidget(self.run)
        self.run.start.setFocus()  # the help comes first
        resize_on_screen(self, QSize(640, self._column.totalHeightForWidth(640)))

    def _show_busy(self, _: bool) -> None:
        """Grow if the progress bar would cover text."""
        self._column.activate()
        needed = self._column.totalHeightForWidth(self.width())
        if needed > self.height():
            resize_on_screen(self, QSize(self.width(), needed))

    def _show(self, folder: Path, said: str) -> None:
        cells = list(csv.DictReader(read_bytes(folder / "tables.csv").decode().splitlines()))
        page = QWidget(objectName="page")
        self.table = _table(cells)
        lines = [line for line in said.splitlines() if line and line[0] not in "|T"]
        verdicts = QLabel("\n".join(lines), objectName="verdict", wordWrap=True)
        column = column_layout(self.table, verdicts, spacing=16, margins=(0, 0, 12, 0), parent=page)
        self.figures = []
        for name, words in _figures().items():
            if (folder / name).exists():
                is_drawn = name not in ("bottle.png", "duck.png")  # others are rendered, on white
                self.figures.append(FigureView(folder / name, words, is_drawn))
                column.addWidget(QLabel(words, wordWrap=True))
                column.addWidget(self.figures[-1])
        column.addStretch(1)
        if self._area is not None:
            self._column.removeWidget(self._area)
            self._area.deleteLater()
        self._area = QScrollArea(widgetResizable=True, objectName="pages")
        self._area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._area.setWidget(page)
        self._column.insertWidget(1, self._area, 1)
        resize_on_screen(self, self.size().expandedTo(QSize(940, 660)))


def _table(lines: list[dict[str, str]]) -> QGridLayout:
    """Grid with a row per motion: area changes by ARAP and APD, here and in the paper."""
    grid = QGridLayout(horizontalSpacing=24, verticalSpacing=6)
    grid.setColumnStretch(0, 1)
    over = (
        QLabel(tr("Area change by ARAP"), objectName="heading"),
        QLabel(tr("Area change by APD"), objectName="heading"),
    )
    grid.addWidget(over[0], 0, 1, 1, 2, Qt.AlignmentFlag.AlignRight)
    grid.addWidget(over[1], 0, 3, 1, 2, Qt.AlignmentFlag.AlignRight)
    titles = (
        tr("motion"),
        tr("this program"),
        tr("paper"),
        tr("this program"),
        tr("paper"),
        tr("handle drift"),
        tr("within 0.1 %"),
    )
    for column, title in enumerate(titles):
        _add_cell(grid, 1, column, QLabel(title, objectName="quiet"))
    by_case: dict[str, dict[str, dict[str, str]]] = {}
    for line in lines:
        by_case.setdefault(line["case"], {})[line["method"]] = line
    for row, case in enumerate(by_case.values(), start=2):
        arap, paper = case["arap"], case["paper"]
        passes = paper["within_tolerance"] == "1"
        cells = (
            paper["move"],
            _percent(arap["area_error"], 2),
            _percent(arap["said_area_error"], 2),
            _percent(paper["area_error"], 3),
            _percent(paper["said_area_error"], 3),
            f"{format_grouped(float(paper['handle_drift']), 2)} cm",
            tr("pass") if passes else tr("fail"),
        )
        for column, cell in enumerate(cells):
            _add_cell(grid, row, column, QLabel(cell))
    return grid


def _add_cell(grid: QGridLayout, row: int, column: int, label: QLabel) -> None:
    side = Qt.AlignmentFlag.AlignLeft if column == 0 else Qt.AlignmentFlag.AlignRight
    grid.addWidget(label, row, column, side)


def _percent(fraction: str, decimals: int) -> str:
    return f"{format_signed(100 * float(fraction), decimals)} %"
