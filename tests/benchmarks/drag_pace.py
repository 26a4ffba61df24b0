"""Pictures a second while samples are dragged in the window, with its real worker.

    python tests/benchmarks/drag_pace.py [seconds]
    python tests/benchmarks/drag_pace.py --contact EDGE ...

Needs a display. The handle goes as by a hand: the cloth is folded by 40° a second, the cushion pressed by
1 cm a second, in steps of 20 ms. The bottle, a thin wall, is dented by a finger at 1 cm a second. A picture
counts where the shape in it is a new one: by more than a thousandth of a millimetre.

With ``--contact`` bottles with edges of some lengths, such as 0.62 cm for 34,000 vertices, are twisted by
16° a second up to 120°, where walls touch, with contact and without.
"""

import sys
import tempfile
import time
from dataclasses import replace
from functools import partial

import numpy as np
from event_loop_gaps import sample_bottle
from PySide6.QtCore import QSettings

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.transforms import rotation_about, translation
from apd_viewer.session.file_jobs import sample_state
from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.state_store import Activity
from apd_viewer.ui.application import make_application
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.tools.tool_modes import Tool
from apd_viewer.ui.workbench import Workbench

EVERY = 0.02  # s
TURN, SPEED = 40.0, 1.0  # degrees and cm a second
TWIST, MOST_TWIST = 16.0, 120.0  # degrees a second, and degrees
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


def twist(session, seconds: float) -> None:
    """Turn the bottle's handle about its axis."""
    angle = np.radians(min(TWIST * seconds, MOST_TWIST))
    session.handles.drag(rotation_about([0.0, 0.0, 0.0], [0.0, 1.0, 0.0], angle), 0)


def bottle_state(edge: float, contact: bool):
    """State of a painted bottle with edges of a length."""
    V, F, labels = sample_bottle(edge)
    state = initial_state(Mesh(V, F))
    return state.updated(replace(state.document, labels=labels).with_settings(contact=contact))


def put_finger(session) -> None:
    """Make the bottle a wall of 0.3 mm, with a finger beside it."""
    session.settings.change(method="wall", wall_thickness=0.03, poisson=0.38)
    session.obstacles.add(
        NamedObstacle("Finger", ObstacleKind.SPHERE, np.array([4.1, 11.0, 0.0]), radius=0.8)
    )


def measure(application, name: str, state, drag, seconds: float) -> None:
    """Drag what ``state`` makes for so long, and print a row."""
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
    session.files.open_result(name, state)
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
    began, asked, shown, pictures, drawn = time.perf_counter(), 0.0, None, [0.0], view.draw_count
    while (now := time.perf_counter() - began) < seconds:
        if now - asked >= EVERY:
            asked = now
            drag(session, now)
        application.processEvents()
        if view.draw_count != drawn:
            drawn, U = view.draw_count, session.store.state.frame.U
            if shown is None or np.abs(U - shown).max() > LEAST:
                shown = U
                pictures.append(now)
        time.sleep(0.001)
    session.gestures.end("Drag")
    late = np.percentile(np.diff([*pictures, now]), 95)
    print(f"| {name} | {seconds:.1f} s | {(len(pictures) - 1) / seconds:.1f} | {late:.2f} s |", flush=True)
    window.files.may_discard_work = lambda *_, **__: True
    window.shell.close()


def main() -> None:
    """Print a table, each sample three times."""
    application = make_application([])
    print("| sample | dragged | pictures a second | 95 % come within |\n|---|---|---|---|")
    if sys.argv[1:2] == ["--contact"]:
        for edge in map(float, sys.argv[2:]):
            for contact in (True, False):
                name = f"edges of {edge} cm, {'with contact' if contact else 'without'}"
                state = partial(bottle_state, edge, contact)
                measure(application, name, state, twist, MOST_TWIST / TWIST)
        return
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 4.0
    for _ in range(3):
        for name, drag in (("cloth", fold), ("cushion", press), ("bottle", dent)):
            measure(application, name, partial(sample_state, name), drag, seconds)


if __name__ == "__main__":
    main()
