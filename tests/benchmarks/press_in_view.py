"""The sample bottle pressed in the window: shapes a second on the screen, steps a second along the timeline.

    python tests/benchmarks/press_in_view.py [steps] [--command]

Needs a display. The bottle is pressed to 40 % of its width. A picture counts where the shape in it is a new
one. Then the knob of the timeline goes over 40 steps, and each is drawn. With --command the same press is
made by the command, for its time.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from PySide6.QtCore import QEventLoop, QSettings

from apd_viewer.files.samples import resource_path
from apd_viewer.ui.application import make_application
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.workbench import Workbench

SCRUBBED = 40


class Press:
    """The window with the bottle between two plates."""

    def __init__(self, application) -> None:
        self.application = application
        store = QSettings(tempfile.mkdtemp() + "/none.ini", QSettings.Format.IniFormat)
        self.window = window = Workbench(Shell(store))
        window.shell.show()
        self.view, self.panel, self.player = window.canvas.viewport, window.press.panel, window.session.player
        window.files.open_sample("bottle")
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
    press = Press(make_application([]))
    press.press(steps)
    press.scrub()
    press.window.session.close()
    os._exit(0)  # the window would ask about unsaved work
