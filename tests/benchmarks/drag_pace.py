"""Pictures a second while the samples of fabric are dragged in the window, with its real worker.

    python tests/benchmarks/drag_pace.py [seconds]

Needs a display. The handle goes as by a hand: the cloth is folded by 40° a second, the cushion pressed by
1 cm a second, in steps of 20 ms. A picture counts where the shape in it is a new one.
"""

import sys
import tempfile
import time

import numpy as np
from PySide6.QtCore import QSettings

from apd_viewer.geometry.pose.transforms import rotation_about, translation
from apd_viewer.session.file_jobs import sample_state
from apd_viewer.ui.application import make_application
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.tools.tool_modes import Tool
from apd_viewer.ui.workbench import Workbench

EVERY = 0.02  # s
TURN, SPEED = 40.0, 1.0  # degrees and cm a second


def fold(seconds: float) -> np.ndarray:
    """Pose of the cloth's handle, about the axis of its fold."""
    return rotation_about([0.0, 0.4, 0.0], [1.0, 0.0, 0.0], np.radians(TURN * seconds))


def press(seconds: float) -> np.ndarray:
    """Pose of the cushion's handle."""
    return translation(np.array([0.0, -SPEED * seconds, 0.0]))


def measure(application, name: str, pose, seconds: float) -> None:
    """Drag a sample for so long, and print a row."""
    store = QSettings(tempfile.mkdtemp() + "/none.ini", QSettings.Format.IniFormat)
    window = Workbench(Shell(store))
    window.shell.resize(1280, 800)
    window.shell.show()
    session, view = window.session, window.canvas.viewport

    def until(done, limit: float = 120.0) -> None:
        end = time.perf_counter() + limit
        while not done() and time.perf_counter() < end:
            application.processEvents()
            time.sleep(0.001)

    until(lambda: view.draw_count > 0)
    session.files.open_result(name, lambda: sample_state(name))
    until(lambda: session.store.state is not None and session.jobs.current is None and not view.is_stale)
    window.tools.choose_tool(Tool.MOVE)
    session.gestures.begin()
    # The first pose makes what is kept for all others.
    session.handles.drag(pose(EVERY), 0)
    first = session.store.state.frame
    until(lambda: session.store.state.frame is not first)
    began, asked, shown, pictures, drawn = time.perf_counter(), 0.0, None, 0, view.draw_count
    while (now := time.perf_counter() - began) < seconds:
        if now - asked >= EVERY:
            asked = now
            session.handles.drag(pose(now), 0)
        application.processEvents()
        if view.draw_count != drawn:
            drawn = view.draw_count
            pictures += session.store.state.frame.U is not shown
            shown = session.store.state.frame.U
        time.sleep(0.001)
    session.gestures.end("Move handle")
    print(f"| {name} | {seconds:.1f} s | {pictures / seconds:.1f} |", flush=True)
    window.files.may_discard_work = lambda *_, **__: True
    window.shell.close()


def main() -> None:
    """Print a table, each sample three times."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 4.0
    application = make_application([])
    print("| sample | dragged | pictures a second |\n|---|---|---|")
    for _ in range(3):
        for name, pose in (("cloth", fold), ("cushion", press)):
            measure(application, name, pose, seconds)


if __name__ == "__main__":
    main()
