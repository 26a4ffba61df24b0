"""Opens the window, all sections of its panel and its dialogs in the language of the environment.

Run as ``python reading_dialogs.py FOLDER``, as reading.py is. Prints what is said, what is cut off, and the
entries of each menu as JSON.
"""

import json
import os
import sys
from pathlib import Path

import numpy as np
from PySide6.QtGui import QKeySequence
from reading import Driver
from walked_dialogs import dialogs

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.geometry.measuring.measurement import Plane
from apd_viewer.geometry.measuring.measurement_kind import MeasurementKind
from apd_viewer.geometry.measuring.surface_point import SurfacePoint
from apd_viewer.presentation.scales import Measure
from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.ui.tools.tool_modes import Tool
from apd_viewer.ui.workbench import Workbench


def begin(driver):
    """A bottle that is twisted, with a region, a pose, obstacles, measurements and a target shape."""
    window = driver.window = Workbench(driver.shell, driver.folder / "recovery")
    driver.wait()
    driver.scene("empty")
    window.recovery.later.click()
    window.files.open_sample("bottle")
    driver.idle()
    driver.scene("bottle")
    session = window.session
    session.obstacles.add_floor(np.eye(3)[1])
    session.handles.move_by(MOTIONS["TWIST"], "40", 0)
    driver.idle()
    driver.scene("twisted")
    session.poses.add()
    window.edits.add_region()
    driver.idle()


def panel(driver):
    """The panel from its top to its end, with something in every section."""
    window, session = driver.window, driver.window.session
    mesh = session.store.state.document.mesh
    session.measurements.add(
        MeasurementKind.SECTION, plane=Plane((0.0, 1.0, 0.0), float(mesh.V[:, 1].mean()))
    )
    ends = [SurfacePoint(face, (1.0, 0.0, 0.0)) for face in (0, len(mesh.F) // 2)]
    session.measurements.add(MeasurementKind.DISTANCE, tuple(ends))
    save_mesh(mesh, 1.01 * mesh.V, driver.folder / "target.obj")
    session.shapes.load_target(driver.folder / "target.obj")
    driver.idle()
    window.panel.folded_sections = []
    driver.shell.activateWindow()
    for name, page in (("deform", window.panel.deform), ("measurements", window.panel.measurements)):
        window.panel.pages.setCurrentWidget(page)
        for step in range(4):
            page.verticalScrollBar().setValue(step * page.viewport().height())
            driver.scene(f"{name} {step}")
    window.panel.pages.setCurrentWidget(window.panel.deform)
    for tool in (Tool.MOVE, Tool.MEASURE, Tool.BASE):
        window.tools.choose_tool(tool)
        driver.scene(f"tool {tool.name.lower()}")
    for measure in (Measure.AREA, Measure.CONTACT):
        window.actions_.display.measures[measure].trigger()
        driver.idle()
        driver.scene(f"overlay {measure.name.lower()}")
    for name in ("cut", "compare"):
        window.actions_.display.switches[name].trigger()
    driver.scene("cards")
    for name in ("history", "plots", "study", "timeline"):
        window.docks[name].show()
        driver.scene(f"dock {name}")
        window.docks[name].hide()
    window.findings.toggle_list()
    driver.scene("mesh check")


def menus(driver):
    """Entries of each menu, and what opens them: none may have the letter of another."""
    bar, found = driver.shell.menuBar(), {}
    left = [("menu bar", bar)]
    while left:
        title, menu = left.pop()
        entries = [action for action in menu.actions() if not action.isSeparator()]
        found[title] = [[a.text(), QKeySequence.mnemonic(a.text()).toString()] for a in entries]
        left += [(f"{title} > {a.text()}", a.menu()) for a in entries if a.menu() is not None]
    return found


def main():
    driver = Driver(Path(sys.argv[1]), map(int, os.environ.get("SIZE", "1280x720").split("x")))
    for act in (begin, panel, dialogs):
        act(driver)
    reader = driver.reader
    sys.stdout.write(json.dumps({"said": reader.said, "cut": reader.cut, "menus": menus(driver)}))
    sys.stdout.flush()
    driver.window.session.close()
    os._exit(0)  # what a window leaves behind is looked at elsewhere


if __name__ == "__main__":
    main()
