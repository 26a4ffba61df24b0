"""Pictures a second while samples are dragged in the window, with its real worker.

    python tests/benchmarks/drag_pace.py [seconds]

Needs a display. The handle goes as by a hand: the cloth is folded by 40° a second, the cushion pressed by
1 cm a second, in steps of 20 ms. The bottle, a thin wall, is dented by a finger at 1 cm a second. A picture
counts where the shape in it is a new one: by more than a thousandth of a millimetre.
"""

import sys
import tempfile
import time

import numpy as np
from PySide6.QtCore import QSettings

from apd_viewer.geometry.pose.transforms import rotation_about, translation
from apd_viewer.session.file_jobs import sample_state
from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind
from apd_viewer.session.state_store import Activity
from apd_viewer.ui.application import make_application
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.tools.tool_modes import Tool
from apd_viewer.ui.workbench import Workbench

EVERY = 0.02  # s
TURN, SPEED = 40.0, 1.0  # degrees and cm a second
LEAST = 1e-4  # cm


def fold(session, seconds: float) -> None:
    """Turn the cloth's handle about the axis of its fold."""
    session.handles.drag(rotation_about([0.0, 0.4, 0.0], [1.0, 0.0, 0.0], np.radians(TURN * seconds)), 0)


def press(session, seconds: float) -> None:
    """Lower the cushion's handle."""
    session.handles.drag(translation(np.array([0.0, -SPEED * seconds, 0.0])), 0)


def dent(session, seconds: float) -> None:
    """Push a finger into the middle of the bottle."""
    session.obstacles.drag(0, np.array([-SPEED * seconds, 0.0, 0.0]))


def put_finger(session) -> None:
    """Make the bottle a wall of 0.3 mm, with a finger beside it."""
    session.settings.change(method="wall", wall_thickness=0.03, poisson=0.38)
    session.obstacles.add(
        NamedObstacle("Finger", ObstacleKind.SPHERE, np.array([4.1, 11.0, 0.0]), radius=0.8)
    )


def measure(application, name: str, drag, seconds: float) -> None:
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
    if drag is dent:
        put_finger(session)
        until(lambda: session.store.activity is Activity.IDLE)
    session.gestures.begin()
    # The first pose makes what is kept for all others.
    drag(session, EVERY)
    first = session.store.state.frame
    until(lambda: session.store.state.frame is not first)
    began, asked, shown, pictures, drawn = time.perf_counter(), 0.0, None, 0, view.draw_count
    while (now := time.perf_counter() - began) < seconds:
        if now - asked >= EVERY:
            asked = now
            drag(session, now)
        application.processEvents()
        if view.draw_count != drawn:
            drawn, U = view.draw_count, session.store.state.frame.U
            if shown is None or np.abs(U - shown).max() > LEAST:
                pictures, shown = pictures + 1, U
        time.sleep(0.001)
    session.gestures.end("Drag")
    print(f"| {name} | {seconds:.1f} s | {pictures / seconds:.1f} |", flush=True)
    window.files.may_discard_work = lambda *_, **__: True
    window.shell.close()


def main() -> None:
    """Print a table, each sample three times."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 4.0
    application = make_application([])
    print("| sample | dragged | pictures a second |\n|---|---|---|")
    for _ in range(3):
        for name, drag in (("cloth", fold), ("cushion", press), ("bottle", dent)):
            measure(application, name, drag, seconds)


if __name__ == "__main__":
    main()
