"""Results of thousands of cases: nothing is quadratic in the rows, and nothing is read on the UI thread."""

import shutil
import threading
import time

import pytest
from driving import work_off
from finished_study import write_study
from PySide6.QtCore import Qt, QTimer

from apd_viewer.cases.results import read_results
from apd_viewer.ui.plots import scatter_view
from apd_viewer.ui.studies import case_study_controller
from apd_viewer.ui.studies.case_study_controller import FolderWatch, ResultsSnapshot
from apd_viewer.ui.studies.result_columns import shown_columns
from apd_viewer.ui.studies.results_panel import ResultsPanel

FEW, MANY = 500, 2000
# Four times the rows may take about four times as long; what is quadratic takes sixteen times.
MOST = 9.0


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """Studies of few and of many cases."""
    found = {}
    for count in (FEW, MANY):
        found[count] = tmp_path_factory.mktemp("many") / "study"
        write_study(found[count], count)
    return found


@pytest.fixture
def panels(qtbot, folders):
    """Panels on them, shown."""
    found = {}
    for count, folder in folders.items():
        panel = found[count] = ResultsPanel()
        qtbot.addWidget(panel)
        panel.resize(1200, 300)
        panel.show()
        qtbot.waitExposed(panel)
        table = read_results(folder)
        panel.show_study(folder)
        panel.show_results(ResultsSnapshot(table, shown_columns(table)))
    return found


def spent(act, times=3):
    """Least processor time of an act, s."""
    found = []
    for _ in range(times):
        begun = time.process_time()
        act()
        found.append(time.process_time() - begun)
    return min(found)


def draw(panel):
    for view in (panel.table.viewport(), panel.table.horizontalHeader().viewport(), panel.scatter.view):
        view.repaint()


def show_again(panel):
    table = read_results(panel.folder)
    found = ResultsSnapshot(table, shown_columns(table))
    panel.show_results(found)
    draw(panel)


def choose_scattered(panel):
    panel.table.choose_rows(list(range(0, len(panel.model.rows), 2)))
    draw(panel)


def sort_scattered(panel):
    way = Qt.SortOrder.DescendingOrder
    energy = next(k for k, column in enumerate(panel.model.columns) if column.name == "energy")
    choose_scattered(panel)
    panel.table.sortByColumn(energy, way)
    panel.table.sortByColumn(0, Qt.SortOrder.AscendingOrder)
    draw(panel)


def choose_all(panel):
    panel.table.selectAll()
    panel.scatter.view.dot_picked.emit(7, True)
    panel.scatter.view.dot_picked.emit(7, True)
    draw(panel)


def other_axis(panel):
    across = panel.scatter.across
    across.setCurrentIndex((across.currentIndex() + 1) % across.count())
    across.activated.emit(across.currentIndex())
    draw(panel)


@pytest.mark.night
def test_results_panel_reads_in_a_time_that_grows_no_faster_than_the_rows(panels):
    few, many = (spent(lambda panel=panel: show_again(panel)) for panel in panels.values())
    assert many < MOST * few


@pytest.mark.parametrize(
    "act",
    [
        choose_scattered,
        choose_all,
        *(pytest.param(act, marks=pytest.mark.night) for act in (sort_scattered, other_axis)),
    ],
)
def test_results_panel_takes_less_than_half_of_reading_for_what_a_hand_does(panels, act):
    """Reading is linear, and on a thread; an index for each chosen cell takes five times as long."""
    panel = panels[MANY]
    assert spent(lambda: act(panel)) < 0.5 * spent(lambda: show_again(panel))


def test_choose_takes_a_row_without_looking_at_the_others(panels, monkeypatch):
    """The picture of the plot is kept, and only its rings are drawn."""
    panel = panels[MANY]
    draw(panel)
    made, view = [], panel.scatter.view
    drawn = scatter_view.draw_chart
    monkeypatch.setattr(scatter_view, "draw_chart", lambda *given: made.append(1) or drawn(*given))
    panel.table.choose_rows([5])
    draw(panel)
    assert not made
    assert list(view.rings) == [5]


def test_results_view_keeps_rows_chosen_where_all_get_other_places(panels):
    panel = panels[FEW]
    chosen = [3, 4, 5, 90, 400]
    panel.table.choose_rows(chosen)
    heard = []
    panel.table.choice_changed.connect(lambda: heard.append(1))
    for column in range(0, panel.model.columnCount(), 3):
        panel.table.sortByColumn(column, Qt.SortOrder.DescendingOrder)
        assert sorted(panel.table.chosen_rows) == chosen
    assert not heard, "nobody has chosen anything"
    panel.table.toggle_row(4)
    assert sorted(panel.table.chosen_rows) == [3, 5, 90, 400]
    assert heard


def test_folder_watch_reads_the_database_elsewhere_than_on_the_ui_thread(qtbot, folders, monkeypatch):
    threads = []

    def read(folder):
        threads.append(threading.get_ident())
        return read_results(folder)

    monkeypatch.setattr(case_study_controller, "read_results", read)
    watch = FolderWatch(None)
    with qtbot.waitSignal(watch.results_read, timeout=60_000) as found:
        watch.watch_folder(folders[FEW])
    watch.close()
    assert len(found.args[0].table.rows) == FEW
    assert all(
        "longest_texts" in column.__dict__ and "sort_keys" in column.__dict__
        for column in found.args[0].columns
    )
    assert threading.get_ident() not in threads


def test_folder_watch_leaves_a_folder_alone_while_nobody_sees_its_results(qtbot, bar, tmp_path):
    """The dock is closed, or behind another one; shown again, it has what is new."""
    study, window = tmp_path / "study", bar
    write_study(study, 5)
    window.case_studies.open_study(study)
    panel, dock = window.case_studies.panel, window.docks["study"]
    qtbot.waitUntil(lambda: len(panel.model.rows) == 5)
    dock.hide()
    shutil.rmtree(study)
    write_study(study, 7)
    assert not any(timer.isActive() for timer in window.case_studies.folder_watch.findChildren(QTimer))
    work_off()
    assert len(panel.model.rows) == 5
    dock.show()
    qtbot.waitUntil(lambda: len(panel.model.rows) == 7)
