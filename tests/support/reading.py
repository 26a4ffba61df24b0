"""Opens the window in the language of the environment and reads all that it says; prints it as JSON.

Run as ``python reading.py FOLDER [ACT ...]`` in a process of its own: the language is fixed at its
start. Without acts it goes through all. With ``SHOTS`` in the environment a picture of each scene is put
there; ``SIZE`` is that of the window.
"""

import json
import os
import re
import subprocess
import sys
import time
from functools import cache
from pathlib import Path

import numpy as np
from finished_study import write_study
from in_thread import InThread
from PySide6.QtCore import QEvent, QSettings, Qt
from PySide6.QtGui import QKeyEvent, QPainter
from PySide6.QtWidgets import (
    QAbstractButton,
    QApplication,
    QComboBox,
    QFileDialog,
    QLabel,
    QListWidget,
    QMessageBox,
)
from walked_dialogs import dialogs

from apd_viewer.files.known_file import FileState
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.samples import open_sample
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.presentation.report_page import ReportHeading
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.view import View
from apd_viewer.session.part_operations import PartOperation
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.processes import solver_process
from apd_viewer.session.state_store import Activity
from apd_viewer.session.storage.session_file import save_session
from apd_viewer.ui.application import make_application
from apd_viewer.ui.filing import file_controller, file_dialogs
from apd_viewer.ui.sharing.picture_dialog import PictureDialog, PictureSettings
from apd_viewer.ui.sharing.report_dialogs import ReportDialog
from apd_viewer.ui.tools.tool_modes import SelectionMode, Tool

PROPERTIES = (
    "text", "toolTip", "statusTip", "whatsThis", "accessibleName", "accessibleDescription", "windowTitle",
    "title", "placeholderText", "specialValueText", "prefix", "suffix", "iconText",
)  # fmt: skip


def is_cut(widget):
    """Whether a button, a box or a label of one line has no room for its words, or leaves the window."""
    if not widget.isVisible() or not widget.text() or getattr(widget, "wordWrap", lambda: False)():
        return False
    if type(widget).__name__ == "ElidedLabel":  # which ends in dots, and has a tip
        return False
    shown = widget.visibleRegion().boundingRect()
    aside = shown.width() < widget.width() and not shown.isEmpty()
    return widget.width() < widget.sizeHint().width() or aside


@cache
def told(kind):
    """The properties with words that a class of widgets or actions has."""
    return [name for name in PROPERTIES if hasattr(kind, name)]


class Reader:
    """Notes what is said, and where it was said first."""

    def __init__(self):
        self.said = {}
        self.cut = {}
        self.scene = ""
        draw = QPainter.drawText

        def drawn(painter, *given):
            self.note(given[-1] if isinstance(given[-1], str) else "", "drawn")
            return draw(painter, *given)

        QPainter.drawText = drawn

    def note(self, text, where):
        if text:
            self.said.setdefault(text, f"{self.scene}: {where}")

    def read(self, scene, things=()):
        """All texts of all widgets and actions, seen or not, for what is hidden now is shown some time."""
        self.scene = scene
        for thing in things or self._all_things():
            for name in told(type(thing)):
                value = getattr(thing, name)
                value = value() if callable(value) else value
                if isinstance(value, str):
                    self.note(value, f"{name} of a {type(thing).__name__}")

    def _all_things(self):
        widgets = QApplication.allWidgets()
        for widget in widgets:
            if isinstance(widget, QLabel | QAbstractButton) and is_cut(widget):
                self.cut[widget.text()] = self.scene
            if isinstance(widget, QComboBox):
                for k in range(widget.count()):
                    self.note(widget.itemText(k), "a choice")
            if isinstance(widget, QListWidget):
                for k in range(widget.count()):
                    self.note(widget.item(k).text(), "a row")
        actions = {action for widget in widgets for action in widget.actions()}
        return [*widgets, *actions]


def record_dialogs(reader, folder):
    """Have dialogs note their texts instead of being shown."""

    def files(parent, title, place, filters="", chosen=""):
        reader.note(title, "a dialog of files")
        for one in filters.split(";;"):
            reader.note(re.sub(r"\([^()]*\)$", "", one), "a filter of files")
        return str(folder / "there.obj"), filters.split(";;")[0]

    def question(parent, title, text, *_):
        reader.note(title, "a question")
        reader.note(text, "a question")
        return QMessageBox.StandardButton.Cancel

    def box(message):
        words = message.windowTitle(), message.text(), message.informativeText()
        for text in (*words, *(button.text() for button in message.buttons())):
            reader.note(text, "a question")

    QMessageBox.exec = box
    QFileDialog.getOpenFileName = QFileDialog.getSaveFileName = staticmethod(files)
    QMessageBox.question = staticmethod(question)


class Driver:
    """The window, and the time that it takes."""

    def __init__(self, folder, size):
        from apd_viewer.ui.shell import Shell

        solver_process.start_solver_process = InThread  # a process would compile at leisure, for nobody
        self.application = make_application([])
        self.reader = Reader()
        self.folder = folder
        self._pictured = set()
        record_dialogs(self.reader, folder)
        settings = QSettings(str(folder / "settings.ini"), QSettings.Format.IniFormat)
        self._leave(folder / "recovery")
        self.shell = Shell(settings)
        self.shell.resize(*size)
        self.shell.show()
        self.wait()

    @staticmethod
    def _leave(folder):
        folder.mkdir()
        mesh, labels = open_sample("duck")
        for name, written in (("1-1.apd", time.time() - 7300.0), ("2-1.apd", 0.0)):
            save_session(folder / name, initial_state(mesh, labels), View())
            os.utime(folder / name, (written,) * 2)

    def wait(self, until=lambda: True, seconds=60.0):
        end = time.monotonic() + seconds
        self.application.processEvents()
        while not until():
            assert time.monotonic() < end, f"it takes too long after “{self.reader.scene}”"
            self.application.processEvents()
            time.sleep(0.002)
        self.application.processEvents()

    def idle(self):
        session = self.window.session
        self.wait(lambda: session.jobs.current is None and session.store.activity is not Activity.REFINING)

    def scene(self, name, *things):
        """Read everything, or some things only, and take a picture if that is wanted."""
        for _ in range(3):  # a number that has just come has its room a round later
            self.application.processEvents()
        self.reader.read(name, things)
        if (shots := os.environ.get("SHOTS")) and name not in self._pictured:
            self._pictured.add(name)
            end = time.monotonic() + 0.5
            self.wait(lambda: time.monotonic() > end)
            shell = self.shell
            part = f"{shell.width()}x{shell.height()}+{shell.x()}+{shell.y()}"
            target = Path(shots) / f"{name}.png"  # the root window alone has the pixels of the viewport
            subprocess.run(["import", "-window", "root", "-crop", part, "+repage", str(target)], check=True)

    def press(self, widget, key, modifiers=Qt.KeyboardModifier.NoModifier):
        for kind in (QEvent.Type.KeyPress, QEvent.Type.KeyRelease):
            self.application.sendEvent(widget, QKeyEvent(kind, key, modifiers))


def start(driver):
    from apd_viewer.ui.workbench import Workbench

    driver.scene("before the start")
    window = driver.window = Workbench(driver.shell, driver.folder / "recovery")
    driver.wait()
    driver.scene("no mesh, and work that was left")
    window.recovery.next.click()
    driver.scene("work of an unknown time")
    window.recovery.later.click()
    window.files.open_sample("bottle")
    driver.scene("opening")
    driver.idle()
    driver.scene("the bottle")


def _write_bar(folder):
    """A tube of 6 rings of 8 vertices, closed at both ends, with its selection: solved in no time."""
    angles = np.arange(8) * np.pi / 4
    V = [(np.cos(a), 0.5 * k, np.sin(a)) for k in range(6) for a in angles] + [(0, 0, 0), (0, 2.5, 0)]
    F = [(8 * k + i, 8 * k + 8 + i, 8 * k + (i + 1) % 8) for k in range(5) for i in range(8)]
    F += [(8 * k + 8 + i, 8 * k + 8 + (i + 1) % 8, 8 * k + (i + 1) % 8) for k in range(5) for i in range(8)]
    F += [(48, i, (i + 1) % 8) for i in range(8)] + [(49, 40 + (i + 1) % 8, 40 + i) for i in range(8)]
    lines = [*(f"v {x} {y} {z}" for x, y, z in V), *(f"f {a + 1} {b + 1} {c + 1}" for a, b, c in F)]
    (folder / "bar.obj").write_text("\n".join(lines), encoding="utf-8")  # save_mesh would load trimesh
    (folder / "bar.sel").write_text("0\n" * 8 + "1\n" * 32 + "2\n" * 8 + "0\n2\n")


def settings(driver):
    session = driver.window.session
    _write_bar(driver.folder)
    driver.window.session.files.open(driver.folder / "bar.obj")
    driver.idle()
    session.files.load_selection(driver.folder / "bar.sel")
    driver.idle()
    session.handles.move_by(MOTIONS["TWIST"], "30", 0)
    driver.idle()
    for method in ("exact", "local", "paper", "arap"):
        session.settings.change(method=method)
        driver.idle()
        driver.scene(f"method {method}")
    session.settings.change(method="exact")
    session.settings.change(area=150.0)
    session.settings.change(volume=40.0)
    driver.idle()
    driver.scene("out of reach")
    session.gestures.undo()
    session.gestures.undo()
    driver.idle()
    driver.scene("undone")


def comparing(driver):
    driver.window.comparison.open()
    side = driver.window.comparison.window
    driver.scene("methods begin to be compared")
    driver.wait(lambda: any(view.status_texts[1] or view.values is not None for view in side.views.values()))
    driver.scene("methods being compared")
    driver.wait(lambda: side.comparison.current_method is None)
    driver.scene("methods compared")
    for k in range(side.table.columnCount()):
        head = side.table.horizontalHeaderItem(k)
        driver.reader.note(head.text(), "a column")
        driver.reader.note(head.toolTip(), "a column")
    for row in range(side.table.rowCount()):
        driver.reader.note(side.table.verticalHeaderItem(row).text(), "a line")
    side.write_picture(driver.folder / "methods.png")
    side.close()
    driver.wait()


def many_cases(driver):
    window, cases = driver.window, driver.window.case_studies
    cases.design_study()
    dialog = cases.dialog
    dialog.folder.setText(str(driver.folder / "there.obj"))
    driver.scene("a study")
    for row in dialog.varied.rows.values():
        row.check.setChecked(True)
        driver.scene("a study of another quantity")
    dialog.design.setCurrentIndex(dialog.design.findData("grid"))
    driver.scene("a study by a grid")
    for name, row in dialog.varied.rows.items():
        row.check.setChecked(name == "twist")  # or there would be 46,875 cases
    dialog.varied.rows["twist"].high.setText("?")
    dialog.begin()
    driver.scene("an end that is none", dialog.message)
    dialog.varied.rows["twist"].high.setText("90deg")
    for text in ("0", "?"):
        dialog.engine.limit.setText(text)
        dialog.begin()
        driver.scene("a limit that is none", dialog.message)
    dialog.engine.limit.setText("")
    dialog.engine.where.setCurrentIndex(1)
    for text in ("", "there.obj", "there.json", "127.0.0.1:9"):
        dialog.engine.address.setText(text)
        dialog.begin()
        driver.scene("the address of a scheduler", dialog.message)
    driver.wait(lambda: not dialog.engine.check.is_waiting)
    dialog.engine.check.failed.emit("")
    driver.scene("a study by a scheduler")
    dialog.close()
    results(driver, cases)
    window.docks["study"].hide()
    driver.wait()


def results(driver, cases):
    window, panel = driver.window, cases.panel
    window.docks["study"].show()
    driver.scene("no results")
    write_study(driver.folder / "many.obj", 60, failed=0.1)
    (driver.folder / "many.obj" / "plan.csv").write_text("")
    cases.open_study(driver.folder / "many.obj")
    driver.wait(lambda: panel.model.rows)
    for column in range(panel.model.columnCount()):
        for role in (Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.ToolTipRole):
            head = panel.model.headerData(column, Qt.Orientation.Horizontal, role)
            # Without the name that the column has in a plan.
            driver.reader.note((head or "").replace("“⟧stiffness⟦”", ""), "a column")
    for column in panel.model.columns:
        driver.reader.note(column.texts[0] if column.name == "status" else "", "a state")
    panel.table.choose_rows([1, 2])
    for button in panel.panes.buttons:
        button.click()
        driver.scene("results behind a tab")
    said = {"cases": 60, "finished": 20, "running": 2, "failed": 1, "rate": 1.0, "seconds_left": 40.0}
    for stopping in (False, True):
        panel.show_running(True, stopping)
        panel.show_progress(said)
        driver.scene("a study that runs")
    panel.show_running(False, sentence="")
    size = driver.shell.size()
    driver.shell.resize(1280, 800)
    driver.scene("results side by side")
    driver.shell.resize(size)


def parts(driver):
    window, session = driver.window, driver.window.session
    window.docks["history"].show()
    window.parts.add_handle()
    window.tools.choose_tool(Tool.HANDLE)
    window.panel.focus_motion_field()
    driver.scene("a second handle")
    for tool in Tool:
        window.tools.choose_tool(tool)
        for way in SelectionMode if tool.traits.is_brush else ():
            window.tools.choose_mode(way)
            driver.scene("a way to choose", window.status.hint)
    window.tools.choose_tool(Tool.BASE)
    window.parts.remove_handle(1)
    window.edits.add_region()
    driver.scene("an empty region")
    window.edits.open_vertex_entry()
    card = window.edits.text_entries.vertices
    for text in ("y > 90%", "y > ", "9-2", "3-", "999999", "q", "z"):
        card.text.setText(text)
        driver.scene("chosen by numbers", card, card.message_label)
    card.text.setText("y > 90%")
    driver.press(card.text, Qt.Key.Key_Return)
    card.close_card()
    session.settings.set_region_area(0, 100.0)
    driver.idle()
    driver.scene("a region that is kept")
    bar = window.panel.deform.verticalScrollBar()
    bar.setValue(bar.maximum())
    driver.scene("the end of the panel")
    for operation in list(PartOperation)[:5]:
        window.edits.edit_part(operation)
    driver.idle()
    driver.scene("the history")
    session.settings.change(method="paper")
    driver.idle()
    driver.scene("a region and the paper's method")
    session.settings.change(method="exact")


def mistakes(driver):
    field = driver.window.panel.handles.motion
    for motion, text in (
        ("TWIST", ""), ("TWIST", "12mm"), ("MOVE_X", "3deg"), ("MOVE_X", "1 +"), ("MOVE_X", "2 3"),
        ("MOVE_X", "5mm"), ("SCALE", "x + 1"), ("SCALE", "1/0"), ("SCALE", "sin"), ("SCALE", "sqrt(L)"),
        ("SCALE", "(2"), ("TWIST", "1+1deg"), ("SCALE", "1,234"), ("SCALE", "asin(2)"), ("SCALE", "9" * 400),
    ):  # fmt: skip
        driver.window.edits.move_by(MOTIONS[motion], text, False)
        driver.scene("a motion that is none", field.problem)
        field.problem.hide()
    for name in ("gone.obj", "odd.xyz", "broken.obj"):
        (driver.folder / "odd.xyz").write_text("?")
        (driver.folder / "broken.obj").write_text("v 0 0\nf 1 2 3\n")
        driver.window.session.files.open(driver.folder / name)
        driver.idle()
        driver.scene("a file that cannot be opened")


def help_(driver):
    window = driver.window
    window.help.toggle_sheet()
    driver.scene("the sheet of shortcuts")
    sheet = window.help.sheet
    sheet.search.setText("qqq")
    driver.scene("nothing found")
    sheet.search.setText("")
    frame, edges = sheet.rows["frame"], sheet.rows["edges"]
    frame.keys.set_recording(True)
    driver.scene("keys are waited for")
    frame.keys.set_recording(False)
    for keys in ("Esc", "Alt+F"):
        frame.keys.keys_chosen.emit(keys)
        driver.scene("keys that are refused")
    frame.keys.keys_chosen.emit(edges.entry.keys)
    driver.scene("keys of another action")
    sheet.swap.click()
    driver.scene("keys that were swapped")
    sheet.restore_all.click()
    driver.scene("default keys")
    window.help.close()
    window.session.files.open_sample("bottle")
    driver.idle()
    window.help.begin_tour()
    driver.wait(lambda: window.help.tour.is_active)
    for number in range(5):
        driver.scene(f"the tour {number}")
        window.help.tour.card.next.click()


def questions(driver):
    window, session, folder = driver.window, driver.window.session, driver.folder
    file_dialogs.show_about_box(window.shell)
    for closes in (True, False):
        file_controller.ask_before_leaving(window.shell, "mesh.obj", closes)
    for found in FileState:
        file_controller.ask_before_leaving(window.shell, "mesh.apd", True, found)
    file_controller.ask_before_leaving(window.shell, "mesh.apd", True, FileState.SAME, 3)
    file_controller.ask_about_changed_file(window.shell, "mesh.apd", {})
    driver.wait()
    file_dialogs.ask_for_mesh(window, folder)
    file_dialogs.ask_where_to_save_session(window, folder, session.store.state.document.mesh)
    file_dialogs.ask_for_selection(window, folder)
    file_dialogs.ask_where_to_save_selection(window, folder, session.store.state.document.mesh)
    file_dialogs.ask_where_to_save_mesh(window, folder, session.store.state.document.mesh)
    file_dialogs.ask_where_to_save_report(window, folder, session.store.state.document.mesh)
    file_dialogs.ask_where_to_save_picture(window, folder, session.store.state.document.mesh)
    (folder / "there.obj.apd").write_text("")
    file_dialogs.ask_where_to_save_session(window, folder, session.store.state.document.mesh)


def files(driver):
    window, session, folder = driver.window, driver.window.session, driver.folder
    for write in (
        lambda: session.files.export(folder / "out.obj"),
        lambda: session.files.save(folder / "out.apd", window.canvas.view.saved_view(""), True),
        lambda: session.files.save_selection(folder / "out.sel"),
        lambda: session.files.save_selection(folder / "out.json"),
        lambda: session.files.load_selection(folder / "out.json"),
        lambda: session.files.load_selection(folder / "out.obj"),
    ):
        write()
        driver.scene("writing")
        driver.idle()
        driver.scene("written")
    handouts(driver)
    V, F = np.eye(4, 3) + [9e4, 0, 0], np.array([[0, 1, 2], [0, 1, 2], [0, 2, 3], [1, 1, 2]])
    save_mesh(Mesh(V, F), V, folder / "bad.obj")
    window.session.files.open(folder / "bad.obj")
    driver.idle()
    driver.scene("findings")
    window.findings.toggle_list()
    driver.wait()
    window.findings.list.rows[0].chosen.emit()
    driver.scene("mesh check")


def handouts(driver):
    from page_parts import PageParts

    window, path = driver.window, driver.folder / "out.html"
    pictures = window.reports.pictures
    dialog = PictureDialog(window.shell, pictures, PictureSettings(pictures.view_size))
    dialog.show()
    driver.scene("a picture", dialog)
    dialog.width_.setValue(32_768)
    driver.scene("another picture", dialog)
    dialog.reject()
    dialog = ReportDialog(window.shell, ReportHeading(), "bottle.obj")
    dialog.show()
    driver.scene("a report", dialog)
    dialog.reject()
    for act in (
        pictures.copy,
        lambda: pictures.save(driver.folder / "out.png", PictureSettings(pictures.view_size)),
        lambda: window.reports.write_report(path),
    ):
        act()
        driver.scene("handing out")
        driver.idle()
        driver.scene("handed out")
    page = PageParts(path.read_text(encoding="utf-8"))
    names = [name for rows in page.rows.values() for name in rows if name not in ("APD Viewer", "Python")]
    for text in (*page.headings, *names, *(note for notes in page.notes.values() for note in notes)):
        if not text.startswith("apd-viewer "):
            driver.reader.note(text, "the report")


def main():
    folder = Path(sys.argv[1])
    driver = Driver(folder, map(int, os.environ.get("SIZE", "1280x720").split("x")))
    for act in (start, settings, comparing, many_cases, parts, dialogs, mistakes, help_, questions, files):
        if act.__name__ in sys.argv[2:] or not sys.argv[2:]:
            act(driver)
    keys = {
        key.toString(form)
        for entry in driver.window.actions_.entries
        for key in entry.action.shortcuts()
        for form in type(key).SequenceFormat
    }
    sys.stdout.write(json.dumps({"said": driver.reader.said, "cut": driver.reader.cut, "keys": sorted(keys)}))
    sys.stdout.flush()
    driver.window.session.close()
    os._exit(0)  # what a window leaves behind is looked at elsewhere


if __name__ == "__main__":
    main()
