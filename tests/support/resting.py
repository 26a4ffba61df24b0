"""A window taken into one state after the other, and what it does while it rests in each.

Nothing but a window is needed; a test counts the events of a second in each state, and a benchmark the
processor's time.
"""

import ctypes
import ctypes.util
import time
from collections import Counter

import numpy as np
from driving import Mouse, arrow_grip, centre, document
from finished_study import write_study
from PySide6.QtCore import QEventLoop, QObject, QTimer
from PySide6.QtWidgets import QApplication

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.presentation.scales import Measure
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.ui.sharing.picture_dialog import PictureDialog, PictureSettings
from apd_viewer.ui.tools.tool_modes import Tool

ALLOWED = 0.02  # of a core
HANDFUL = 6  # timers in a moment of rest: garbage, and a folder that is looked at


class Watch(QObject):
    """Counts the events that an application delivers, by their receiver and kind."""

    def __init__(self):
        super().__init__()
        self.counts = Counter()
        self._loop = QEventLoop(self)
        self._end = QTimer(self, singleShot=True)
        self._end.timeout.connect(self._loop.quit)

    def eventFilter(self, receiver, event):
        if receiver is not self._end and receiver is not self._loop:
            self.counts[type(receiver).__name__, event.type().name] += 1
        return False

    def count(self, seconds):
        """Events of so many seconds."""
        self.counts = Counter()
        QApplication.instance().installEventFilter(self)
        self.wait(seconds)
        QApplication.instance().removeEventFilter(self)
        return self.counts

    def restless(self, seconds=0.3, patience=15.0):
        """What goes on in a window that should rest; empty once nothing did for so many seconds."""
        end = time.monotonic() + patience
        while True:
            began = time.process_time()
            counts = self.count(seconds)
            busy = (time.process_time() - began) / seconds
            paints = sum(n for (_, kind), n in counts.items() if kind in ("Paint", "UpdateRequest"))
            timers = sum(n for (_, kind), n in counts.items() if kind == "Timer")
            if not paints and timers <= HANDFUL and busy < ALLOWED:
                return ""
            if time.monotonic() > end:
                most = counts.most_common(4)
                return f"{100 * busy:.1f} % of a core, {paints} paints, {timers} timers, most of {most}"

    def wait(self, seconds):
        self._end.start(round(1e3 * seconds))
        self._loop.exec()


def states(window, folder, gestures, state=None):
    """Take a window on the sample bottle into its states; gives the name of each while it is in it.

    After the tour, which is about the sample, it goes on with another state if one is given.
    """
    window.shell.activateWindow()  # or no text cursor would blink
    yield from _tour(window)
    if state is not None:
        window.session.files.open_result("bottle", lambda: state)
        settle(window)
    for part in (_twisted, _notices, _tools, _looks, _cards, _docks, _dialogs, _away):
        yield from part(window, folder)
    for k in range(gestures):
        gesture(window, k)
    settle(window)
    yield f"after {gestures} gestures"


def settle(window):
    """Let the event loop run until nothing is opened, written or refined any more."""
    end = time.monotonic() + 600.0  # kernels may have to be compiled
    session = window.session
    QApplication.processEvents()
    while session.jobs.current is not None or session.store.activity.value == "refining":
        assert time.monotonic() < end
        QApplication.processEvents()
        time.sleep(0.002)
    QApplication.processEvents()


def drawn(window):
    """Let the event loop run until a file that is being opened is on the screen."""
    settle(window)
    while window.canvas.viewport.is_stale:
        QApplication.processEvents()
        time.sleep(0.002)


def _tour(window):
    window.help.begin_tour()
    QApplication.processEvents()
    for number in range(5):
        assert window.help.tour.step_number == number
        yield f"tour, card {number + 1}"
        window.help.tour.card.next.click()
    assert not window.help.tour.is_active
    yield "bottle at rest, its invitation"


def _twisted(window, _):
    window.session.handles.move_by(MOTIONS["TWIST"], "40deg", 0)
    settle(window)
    yield "bottle twisted"


def _notices(window, _):
    window.notice.show_message("A message.")
    window.notice.timer.stop()  # it is in the way for longer
    yield "message"
    window.notice.show_failure("A failure.")
    yield "failure"
    window.notice.hide()
    window.recovery.offer([Leftover()])
    yield "offer of unsaved work"
    window.recovery.later.click()


class Leftover:
    """Work that was left, in no file."""

    name, taken, time = "duck.obj", False, 0.0

    def release(self):
        pass


def _tools(window, _):
    view = window.canvas.viewport
    for tool in Tool:
        window.tools.choose_tool(tool)
        Mouse(view).move(centre(view))
        yield f"tool {tool.name.lower()}"
    window.tools.choose_tool(Tool.MOVE)
    Mouse(view).move(arrow_grip(window, 1))
    yield "an arrow under the mouse"
    Mouse(view).move((5, 5))


def _looks(window, _):
    looks = window.actions_.display
    for name, switch in looks.switches.items():
        if not switch.isEnabled() or name == "turntable":
            continue
        before = switch.isChecked()
        switch.setChecked(True)
        yield f"look {name}"
        switch.setChecked(before)
    for measure in (Measure.AREA, Measure.CONTACT):
        looks.measures[measure].trigger()
        window.canvas.viewport.setFocus()
        yield f"overlay {measure.name.lower()}"
    for name in ("cut", "compare", "ghost", "ground"):
        looks.switches[name].setChecked(True)
    yield "all looks"
    looks.no_overlay.trigger()


def _cards(window, _):
    typed = window.edits.text_entries
    for name in ("vertices", "brush", "pivot"):
        typed.open_entry(getattr(typed, name))
        yield f"typing {name}"
        getattr(typed, name).close_card()
    window.help.toggle_search()
    yield "search for commands"
    window.help.close()
    window.help.toggle_sheet()
    yield "shortcut sheet"
    window.help.close()
    before, V = document(window).mesh, np.eye(4, 3)
    F = np.array([[0, 1, 2], [0, 1, 2], [0, 2, 3], [1, 1, 2]])
    window.session.files.open_mesh(Mesh(V, F))
    settle(window)
    yield "findings, badge"
    window.findings.toggle_list()
    window.findings.list.rows[0].chosen.emit()
    yield "findings, list and marks"
    window.findings.close()
    window.session.gestures.undo()
    settle(window)
    assert document(window).mesh is before


def _docks(window, folder):
    for name in ("history", "plots"):
        window.docks[name].show()
        yield f"dock {name}"
        window.docks[name].hide()
    for button in window.plots.choices.values():
        button.setChecked(True)
    write_study(folder / "study", 60, failed=0.1)
    (folder / "study" / "plan.csv").write_text("")
    window.case_studies.open_study(folder / "study")
    panel = window.case_studies.panel
    end = time.monotonic() + 30.0
    while not panel.model.rows and time.monotonic() < end:
        QApplication.processEvents()
        time.sleep(0.002)
    panel.table.choose_rows([1, 2])
    yield "dock study"
    for name in ("history", "plots"):
        window.docks[name].show()
    yield "all docks"
    for name in ("study", "history", "plots"):
        window.docks[name].hide()
    yield "docks closed again"
    panel_of = window.panel.deform.verticalScrollBar()
    panel_of.setValue(panel_of.maximum())
    yield "end of the panel"
    panel_of.setValue(0)


def _dialogs(window, _):
    window.settings_page.open()
    yield "settings"
    window.settings_page.close()
    runs = window.runs
    opened = {
        "sweep": runs.open_sweep,
        "animate": runs.open_animation,
        "press": runs.open_press,
        "paper": runs.open_paper,
        "verify": runs.open_verification,
    }
    for name, open_dialog in opened.items():
        open_dialog()
        yield f"dialog {name}"
        window.runs.dialogs[name].close()
    window.case_studies.design_study()
    yield "dialog study"
    window.case_studies.dialog.close()
    pictures = window.reports.pictures
    dialog = PictureDialog(window.shell, pictures, PictureSettings(pictures.view_size))
    dialog.show()
    yield "dialog picture"
    dialog.reject()
    dialog.deleteLater()
    window.comparison.open()
    side = window.comparison.window
    end = time.monotonic() + 120.0
    while side.comparison.current_method is not None and time.monotonic() < end:
        QApplication.processEvents()
        time.sleep(0.002)
    yield "comparison"
    side.close()
    window.actions_.display.no_overlay.trigger()


def _away(window, _):
    window.notice.show_failure("A failure.")
    window.docks["plots"].show()
    iconify(window.shell, True)
    yield "minimised"
    iconify(window.shell, False)
    window.shell.hide()
    yield "hidden"
    window.shell.show()
    window.docks["plots"].hide()
    yield "shown again"


def iconify(window, on):
    """Minimise a window as a window manager does: there is none on the display of the tests."""
    x11 = ctypes.CDLL(ctypes.util.find_library("X11"))
    x11.XOpenDisplay.restype = ctypes.c_void_p
    display = ctypes.c_void_p(x11.XOpenDisplay(None))
    (x11.XUnmapWindow if on else x11.XMapWindow)(display, ctypes.c_ulong(window.winId()))
    x11.XSync(display, 0)
    x11.XCloseDisplay(display)


def gesture(window, k):
    """One of the gestures of somebody who works fast; no two after one another are alike."""
    rng = np.random.default_rng(k)
    view = window.canvas.viewport
    mouse = Mouse(view)
    kind = k % 5
    if kind == 4:
        window.actions_.undo.trigger()
        QApplication.processEvents()
        return
    if kind == 1:
        window.tools.choose_tool(Tool.REGION)
        start, way = centre(view).toTuple(), rng.uniform(-60.0, 60.0, 2)
    elif kind == 3:
        window.tools.choose_tool(Tool.ORBIT)
        start, way = (20.0, 20.0), rng.uniform(-60.0, 60.0, 2)
    else:
        window.tools.choose_tool(Tool.MOVE)
        start, way = arrow_grip(window, rng.integers(3)), rng.uniform(-20.0, 20.0, 2)
    mouse.move(start)
    mouse.press(start)
    for t in np.linspace(0.25, 1.0, 4):
        mouse.move(np.add(start, t * way))
        QApplication.processEvents()
    mouse.release(np.add(start, way))
    QApplication.processEvents()
