"""The sample bottle pressed in the window: shapes a second on the screen, steps a second along the timeline.

    python tests/benchmarks/press_in_view.py [steps] [--command] [--cushion METHOD]

Needs a display. The bottle is pressed to 40 % of its width. A picture counts where the shape in it is a new
one. Then the knob of the timeline goes over 40 steps, and each is drawn. With --command the same press is
made by the command, for its time. With --cushion, a pillow of two sheets with 12,500 triangles is filled
with five litres, by the wall as a tension field, and pressed to half of its height by a method, with its
volume held. After a minute a press is stopped.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from PySide6.QtCore import QEventLoop, QSettings

from apd_viewer.files.samples import resource_path
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.solver.convergence import Convergence
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.view import View
from apd_viewer.session.storage.session_file import save_session
from apd_viewer.ui.application import make_application
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.workbench import Workbench
from apd_viewer.verification.case_meshes import grid, sewn_sheets

SCRUBBED = 40
MOST_SECONDS = 60.0  # of a press, which is stopped then
FILLED = 5000.0  # ml


def filled_cushion(method):
    """Session of a filled pillow of film, to be pressed by a method."""
    uv, F = grid(56, 56)
    V, F = sewn_sheets(40.0 * uv, F, 0.01)
    film = {"wall_thickness": 0.05, "poisson": 0.3, "tension_field": True}
    solver = Deformation(V, F, [0], method="wall", filled_volume=FILLED, **film)
    solver.convergence = Convergence(energy_tolerance=1e-4)
    while not solver.settled:
        solver.iterate()
    frame = solver.frame()
    print(f"{len(F):,} triangles filled in {frame.iteration:,} steps", flush=True)
    state = initial_state(Mesh(V, F))
    settings = {"method": method, "filled_volume": FILLED, **film}
    state = state.updated(state.document.with_settings(**settings), frame=frame)
    path = Path(tempfile.mkdtemp()) / "cushion.apd"
    save_session(path, state, View(unit="cm"), embed=True)
    return path


class Press:
    """The window with the bottle, or the mesh of a session, between two plates."""

    def __init__(self, application, session: Path | None = None) -> None:
        self.application = application
        store = QSettings(tempfile.mkdtemp() + "/none.ini", QSettings.Format.IniFormat)
        self.window = window = Workbench(Shell(store))
        window.shell.show()
        self.view, self.panel, self.player = window.canvas.viewport, window.press.panel, window.session.player
        if session is None:
            window.files.open_sample("bottle")
        else:
            window.files.open_path(session)
        self.until(lambda: window.session.store.state is not None and not self.view.is_stale)
        window.actions_.simulate.press_live.trigger()
        self.wait(2.0)

    def until(self, done) -> None:
        while not done():
            self.handle_events()

    def handle_events(self) -> None:
        """Sleep until there are events, as a window does, and handle them."""
        self.application.processEvents(QEventLoop.ProcessEventsFlag.WaitForMoreEvents)

    def wait(self, seconds: float) -> None:
        end = time.perf_counter() + seconds
        while time.perf_counter() < end:
            self.application.processEvents()

    def press(self, steps: int) -> None:
        drawn, last, store = 0, None, self.window.session.store
        self.panel.steps.setValue(steps)
        began, draws = time.perf_counter(), self.view.draw_count
        self.panel.press.click()
        while self.player.is_playing:
            self.handle_events()
            if time.perf_counter() - began > MOST_SECONDS:
                steps = self.player.done
                self.player.stop()
                break
            if self.view.draw_count != draws:
                drawn += store.state.frame.U is not last
                last, draws = store.state.frame.U, self.view.draw_count
        took = time.perf_counter() - began
        print(
            f"{steps} steps in {took:.1f} s, {drawn / took:.1f} new shapes a second on the screen", flush=True
        )

    def scrub(self) -> None:
        count, slider = len(self.player.timeline.steps), self.panel.slider
        slider.setSliderDown(True)
        began, spent = time.perf_counter(), time.thread_time()
        for k in range(SCRUBBED):
            slider.setValue((k + 1) % count)
            self.until(lambda: not self.view.is_stale)
        took, spent = time.perf_counter() - began, time.thread_time() - spent
        slider.setSliderDown(False)
        print(
            f"{SCRUBBED} steps scrubbed at {SCRUBBED / took:.1f} a second; the window's own thread took "
            f"{1000 * spent / SCRUBBED:.0f} ms each",
            flush=True,
        )


def command(steps: int) -> None:
    bottle, out = str(resource_path("bottle.obj")), str(Path(tempfile.mkdtemp()) / "pressed.obj")
    words = ["press", bottle, "--to", "40%", "--steps", str(steps), "--stiffness", "0.001", "-o", out]
    began = time.perf_counter()
    subprocess.run([sys.executable, "-m", "apd_viewer", *words], check=True, stdout=subprocess.DEVNULL)
    print(f"the command took {time.perf_counter() - began:.1f} s", flush=True)


if __name__ == "__main__":
    numbers = [int(word) for word in sys.argv[1:] if word.isdigit()]
    steps = numbers[0] if numbers else 16
    if "--command" in sys.argv:
        command(steps)
    session = None
    if "--cushion" in sys.argv:
        session = filled_cushion(sys.argv[sys.argv.index("--cushion") + 1])
    press = Press(make_application([]), session)
    if session:
        press.panel.end.setText("50")
        press.panel.direction_chosen.emit(2)
    press.press(steps)
    press.scrub()
    press.window.session.close()
    os._exit(0)  # the window would ask about unsaved work
