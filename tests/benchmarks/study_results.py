"""How long the window takes to show the results of a study, and how long its event loop waits meanwhile.

    python tests/benchmarks/study_results.py [cases]

A folder of so many cases, 10,000 if nothing is said, is written and opened in a real window, which needs a
display. A timer of 5 ms runs: the largest gap between its ticks is what a user would feel. "until" is the
time until the table and the drawn plot are there; memory is what the process has in use.
"""

import gc
import os
import sys
import tempfile
import time
from functools import partial
from pathlib import Path

import numpy as np
from PySide6.QtCore import QSettings, Qt, QTimer

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from finished_study import write_study

from apd_viewer.ui.application import make_application
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.workbench import Workbench

PAGE = os.sysconf("SC_PAGE_SIZE")
SETTLED = 0.5  # s in which whatever follows an act may still make the loop wait


def memory():
    """Resident memory of this process, MiB."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * PAGE / 2**20


class Gaps:
    """Gaps of the event loop of an application."""

    def __init__(self, application):
        self._application = application
        self.ticks = []
        self._timer = QTimer(application, timerType=Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(lambda: self.ticks.append(time.perf_counter()))
        self._timer.start(5)

    def wait(self, seconds, until=lambda: True):
        """Let the loop run until something is so, then for some seconds; return when it was so, from now."""
        begun, found = time.perf_counter(), None
        while found is None or time.perf_counter() - begun - found < seconds:
            self._application.processEvents()
            if found is None and until():
                found = time.perf_counter() - begun
            time.sleep(0.0005)
        return found

    def measure(self, title, act, until=lambda: True):
        """Do something and print the time that it takes, and the largest gaps."""
        self.wait(0.3)
        self.ticks = [time.perf_counter()]
        own, begun = time.process_time(), time.perf_counter()
        act()
        acted = time.perf_counter() - begun
        done = acted + self.wait(SETTLED, until)
        gaps = 1e3 * np.diff(self.ticks)
        long = ", ".join(f"{gap:.0f}" for gap in sorted(gaps[gaps > 50.0], reverse=True)[:6])
        print(
            f"{title:34} until {done:5.2f} s  the call {1e3 * acted:6.1f} ms  largest gap {gaps.max():6.1f}"
            f" ms  processor {time.process_time() - own:5.2f} s  over 50 ms: {long or 'none'}",
            flush=True,
        )


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    application = make_application([])
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch) / "study"
        write_study(folder, count)
        window = Workbench(Shell(QSettings(str(Path(scratch) / "settings.ini"), QSettings.Format.IniFormat)))
        window.shell.show()
        cases = window.case_studies
        panel, gaps = cases.panel, Gaps(application)
        drawn = []
        paint = panel.scatter.view.paintEvent
        panel.scatter.view.paintEvent = lambda event: (paint(event), drawn.append(1))
        gaps.wait(3.0)
        gc.freeze()  # as the window does
        before = memory()
        gaps.measure(
            "open", lambda: cases.open_study(folder), lambda: len(panel.model.rows) == count and drawn
        )
        print(f"{count:,} cases: {memory() - before:.0f} MiB more", flush=True)
        table, order = panel.table, Qt.SortOrder
        names = [column.name for column in panel.model.columns]

        def sort(name, way=order.AscendingOrder):
            table.sortByColumn(names.index(name), way)

        for name in ("energy", "status", "line"):
            gaps.measure(f"sort by {name}", partial(sort, name))
        across, view = panel.scatter.across, panel.scatter.view

        def choose(name):
            drawn.clear()
            across.setCurrentIndex(across.findData(name))
            across.activated.emit(across.currentIndex())

        for name in ("energy", "seconds"):
            gaps.measure(f"plot over {name}", partial(choose, name), lambda: drawn)
        gaps.measure("choose a row", lambda: table.choose_rows([count // 2]))
        gaps.measure("choose another row", lambda: table.choose_rows([count // 3]))
        gaps.measure("choose all rows", table.selectAll)
        gaps.measure("sort with all of them chosen", partial(sort, "energy", order.DescendingOrder))
        gaps.measure("Ctrl and a click on a dot", lambda: view.dot_picked.emit(count // 2, True))
        some = [k for k in range(count) if k % 2]
        gaps.measure("choose every other row", lambda: table.choose(some))
        gaps.measure("sort with them chosen", partial(sort, "seconds"))
        gaps.measure("resize", lambda: window.shell.resize(1100, 760))
        gaps.measure("another theme", lambda: cases.set_theme(window.shell.theme))
        gaps.measure(
            "read again",
            lambda: cases.folder_watch.watch_folder(folder),
            lambda: not cases.folder_watch._task.is_busy,
        )
        print(f"{memory() - before:.0f} MiB more at the end", flush=True)
        window.shell.close()


if __name__ == "__main__":
    main()
