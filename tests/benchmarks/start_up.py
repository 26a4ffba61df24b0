"""How long it takes from the command to the first picture, against importing the libraries of a window alone.

    python tests/benchmarks/start_up.py [runs]

Needs a display. Every run is a process of its own, and the kinds of runs take turns. What is imported is
counted until the last import is done, the window until its viewport has brought a frame to the screen: the
first one at all, the first one with the sample bottle, and the first one in which the bottle can be worked
on. The gap is the longest between two turns of the event loop from the first picture on.
"""

import os
import subprocess
import sys
import tempfile
import time

import numpy as np

RUNS = 9
IMPORTS = "import PySide6.QtWidgets, pyvista, pyvistaqt, time; print('imports', time.time())"
COMMANDS = ("--version", "--help")

# Watches the viewport from outside: the program itself knows nothing of being measured.
WATCHED = """
import os, sys, time
from apd_viewer.__main__ import main
from apd_viewer.ui import application

at, gaps = {}, []

def swapped():
    now = time.time()
    at.setdefault("window", now)
    if "mesh" in at:
        at.setdefault("bottle", now)
    if "state" in at:
        for name in ("window", "bottle"):
            print(name, at[name])
        print("ready", now)
        print("gap", max(gaps), flush=True)
        os._exit(0)

def tick():
    now = time.time()
    if "window" in at and "tick" in at:
        gaps.append(now - at["tick"])
    at["tick"] = now

def made(argv, make=application.make_application):
    made = make(argv)
    from PySide6.QtCore import QTimer
    from apd_viewer.ui.tools.canvas import Canvas
    from apd_viewer.ui.scene.surface import Surface
    from apd_viewer.ui.scene.viewport import Viewport

    def begin(self, *args, begin=Viewport.__init__, **named):
        begin(self, *args, **named)
        self.frameSwapped.connect(swapped)
        QTimer(self, interval=1, timeout=tick).start()

    def show_mesh(self, *args, show=Surface.set_mesh):
        show(self, *args)
        at["mesh"] = True

    def show_state(self, *args, show=Canvas.show_state):
        show(self, *args)
        at["state"] = True

    Viewport.__init__, Surface.set_mesh, Canvas.show_state = begin, show_mesh, show_state
    return made

application.make_application = made
sys.argv = ["apd-viewer"]
main()
"""


def seconds(*words, **environment):
    """Seconds from the start of a Python process to the moments that it prints, and to its end."""
    started = time.time()
    done = subprocess.run(
        [sys.executable, *words],
        env=os.environ | {"QT_API": "pyside6"} | environment,
        stdout=subprocess.PIPE,
        text=True,
        check=True,
        timeout=60,
    )
    ended = time.time()
    lines = [line.split() for line in done.stdout.splitlines()]
    said = {words[0]: float(words[1]) for words in lines if len(words) == 2 and words[0] in KINDS}
    return {name: at if name == "gap" else at - started for name, at in said.items()} | {
        "end": ended - started
    }


KINDS = ("imports", "window", "bottle", "ready", "gap")


def main() -> None:
    """Print the medians, and those of the ratios to the imports alone."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else RUNS
    taken = {}
    with tempfile.TemporaryDirectory() as home:
        for _ in range(runs + 1):  # the first fills the caches
            found = seconds("-c", IMPORTS) | seconds("-c", WATCHED, XDG_CONFIG_HOME=home)
            for command in COMMANDS:
                found[command] = seconds("-m", "apd_viewer", command)["end"]
            for name, took in found.items():
                taken.setdefault(name, []).append(took)
    # Ratios within a round: what else the machine does changes from one to the next.
    base = np.array(taken["imports"][1:])
    for name in (*KINDS, *COMMANDS):
        times = np.array(taken[name][1:])
        print(f"{name:12} {1e3 * np.median(times):7.0f} ms   x {np.median(times / base):5.2f}")


if __name__ == "__main__":
    main()
